#include "measured/plane_mesh.h"

#include "core/error.h"
#include "core/random.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace nacre {
namespace {

Vec2d minus(const Vec2d& a, const Vec2d& b) { return {a.x - b.x, a.y - b.y}; }
double dot(const Vec2d& a, const Vec2d& b) { return a.x * b.x + a.y * b.y; }
double cross(const Vec2d& a, const Vec2d& b) { return a.x * b.y - a.y * b.x; }
double distance(const Vec2d& a, const Vec2d& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// Twice the area of a, b, c; positive counter-clockwise.
double turn(const Vec2d& a, const Vec2d& b, const Vec2d& c) { return cross(minus(b, a), minus(c, a)); }

/// Positive where p lies inside the circle through a, b, c (counter-clockwise).
double in_circle(const Vec2d& a, const Vec2d& b, const Vec2d& c, const Vec2d& p) {
  const Vec2d u = minus(a, p), v = minus(b, p), w = minus(c, p);
  return dot(u, u) * cross(v, w) + dot(v, v) * cross(w, u) + dot(w, w) * cross(u, v);
}

/// Bits of a cell's two indices interleaved: near cells come near each other.
std::uint64_t interleaved(std::uint32_t x, std::uint32_t y) {
  std::uint64_t code = 0;
  for (int bit = 0; bit < 16; ++bit)
    code |= (std::uint64_t(x >> bit & 1) << (2 * bit)) | (std::uint64_t(y >> bit & 1) << (2 * bit + 1));
  return code;
}

} // namespace

PlaneMesh::PlaneMesh(const std::vector<Vec2d>& points) : points_(points) {
  if (points_.empty()) throw Error("a mesh of points needs at least one");
  if (points_.size() > std::size_t(1) << 28) throw Error("too many points for a mesh");
  low_ = high_ = points_[0];
  for (const Vec2d& p : points_) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) throw Error("a point of a mesh is not finite");
    low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
    high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y)};
  }
  if (points_.size() == 1) return;
  // The point farthest from the first, and the one farthest from the line through both.
  const auto farthest = [&](auto measure) {
    return *std::max_element(points_.begin(), points_.end(),
                             [&](const Vec2d& a, const Vec2d& b) { return measure(a) < measure(b); });
  };
  const Vec2d a = points_[0], b = farthest([&](const Vec2d&p) { return distance(p, a); });
  const double extent = distance(a, b);
  if (!(extent > 0)) throw Error("the points of a mesh coincide");
  const Vec2d c = farthest([&](const Vec2d& p) { return std::abs(turn(a, b, p)); });
  if (points_.size() == 2 || std::abs(turn(a, b, c)) < 1e-6 * extent * extent)
    sort_line(a, b);
  else
    triangulate(extent);
}

void PlaneMesh::sort_line(const Vec2d& a, const Vec2d& b) {
  const double length = distance(a, b);
  line_direction_ = {(b.x - a.x) / length, (b.y - a.y) / length};
  line_.resize(points_.size());
  std::iota(line_.begin(), line_.end(), 0u);
  std::sort(line_.begin(), line_.end(), [&](std::uint32_t i, std::uint32_t j) {
    return dot(points_[i], line_direction_) < dot(points_[j], line_direction_);
  });
}

void PlaneMesh::triangulate(double extent) {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    points_[i].x += 1e-9 * extent * (unit_double(hash(i, 0)) - 0.5);
    points_[i].y += 1e-9 * extent * (unit_double(hash(i, 1)) - 0.5);
  }
  // Rounds of doubling size, near points after each other within a round: short walks, small cavities
  // (Amenta, Choi and Rote 2003, Incremental Constructions con BRIO).
  std::vector<std::pair<std::uint64_t, std::int32_t>> order;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vec2d& p = points_[i];
    const auto cell = [&](double x, double low, double high) {
      return std::uint32_t(std::clamp(65535 * (x - low) / std::max(high - low, 1e-300), 0.0, 65535.0));
    };
    std::uint64_t round = 28;
    for (std::uint64_t bits = hash(i, 2); round > 0 && (bits & 1); bits >>= 1)
      --round;
    order.emplace_back(round << 32 | interleaved(cell(p.x, low_.x, high_.x), cell(p.y, low_.y, high_.y)),
                       std::int32_t(i));
  }
  std::sort(order.begin(), order.end());

  // A first triangle: far from degenerate, as the points are no line.
  const std::int32_t a = order[0].second;
  const auto widest = [&](auto measure) {
    return std::max_element(
               order.begin(), order.end(),
               [&](const auto& x, const auto& y) { return measure(x.second) < measure(y.second); })
        ->second;
  };
  std::int32_t b = widest([&](std::int32_t i) { return distance(points_[i], points_[a]); });
  std::int32_t c = widest([&](std::int32_t i) { return std::abs(turn(points_[a], points_[b], points_[i])); });
  if (turn(points_[a], points_[b], points_[c]) < 0) std::swap(b, c);
  triangles_ = {{{a, b, c}, {1, 2, 3}},
                {{c, b, infinity}, {3, 2, 0}},
                {{a, c, infinity}, {1, 3, 0}},
                {{b, a, infinity}, {2, 1, 0}}};
  std::int32_t hint = 0;
  for (const auto& [code, i] : order)
    if (i != a && i != b && i != c) insert(i, hint);
  make_starts();
}

bool PlaneMesh::conflicts(const Triangle& t, const Vec2d& p) const {
  for (int k = 0; k < 3; ++k)
    if (t.vertex[k] == infinity)
      return turn(points_[t.vertex[(k + 1) % 3]], points_[t.vertex[(k + 2) % 3]], p) > 0;
  return in_circle(points_[t.vertex[0]], points_[t.vertex[1]], points_[t.vertex[2]], p) > 0;
}

std::int32_t PlaneMesh::walk(const Vec2d& p, std::int32_t at) const {
  // Towards p across the first side that it lies beyond; in a Delaunay mesh this ends. The bound guards
  // against rounding in slivers.
  for (std::size_t steps = 0; steps < triangles_.size() + 4; ++steps) {
    const Triangle& t = triangles_[at];
    int ghost = -1, across = -1;
    for (int k = 0; k < 3; ++k)
      if (t.vertex[k] == infinity) ghost = k;
    if (ghost >= 0) {
      if (turn(points_[t.vertex[(ghost + 1) % 3]], points_[t.vertex[(ghost + 2) % 3]], p) > 0) return at;
      at = t.neighbour[ghost];
      continue;
    }
    for (int k = 0; k < 3 && across < 0; ++k)
      if (turn(points_[t.vertex[(k + 1) % 3]], points_[t.vertex[(k + 2) % 3]], p) < 0) across = k;
    if (across < 0) return at;
    at = t.neighbour[across];
  }
  return at;
}

void PlaneMesh::insert(std::int32_t vertex, std::int32_t& hint) {
  const Vec2d p = points_[vertex];
  std::int32_t start = walk(p, hint);
  if (!conflicts(triangles_[start], p)) {
    start = 0;
    while (start < std::int32_t(triangles_.size()) && !conflicts(triangles_[start], p))
      ++start;
    if (start == std::int32_t(triangles_.size())) throw Error("points of a mesh coincide");
  }
  // The cavity: all triangles whose circle holds p, connected.
  std::vector<std::int32_t> cavity{start};
  struct Side {
    std::int32_t from, to, outer;
  };
  std::vector<Side> border;
  const auto in_cavity = [&](std::int32_t t) {
    return std::find(cavity.begin(), cavity.end(), t) != cavity.end();
  };
  for (std::size_t n = 0; n < cavity.size(); ++n) {
    const Triangle t = triangles_[cavity[n]];
    for (int k = 0; k < 3; ++k) {
      const std::int32_t next = t.neighbour[k];
      if (in_cavity(next)) continue;
      if (conflicts(triangles_[next], p))
        cavity.push_back(next);
      else
        border.push_back({t.vertex[(k + 1) % 3], t.vertex[(k + 2) % 3], next});
    }
  }
  // A triangle may have been met from outside the cavity before it was found to belong to it.
  std::erase_if(border, [&](const Side& s) { return in_cavity(s.outer); });
  // New triangles take the places of the cavity's, then the end of the list.
  std::vector<std::pair<std::int32_t, std::int32_t>> starting_at, ending_at;
  for (std::size_t n = 0; n < border.size(); ++n) {
    const std::int32_t place = n < cavity.size() ? cavity[n] : std::int32_t(triangles_.size());
    if (n >= cavity.size()) triangles_.emplace_back();
    triangles_[place] = {{border[n].from, border[n].to, vertex}, {-1, -1, border[n].outer}};
    Triangle& outer = triangles_[border[n].outer];
    for (int k = 0; k < 3; ++k)
      if (outer.vertex[(k + 1) % 3] == border[n].to && outer.vertex[(k + 2) % 3] == border[n].from)
        outer.neighbour[k] = place;
    starting_at.emplace_back(border[n].from, place);
    ending_at.emplace_back(border[n].to, place);
  }
  std::sort(starting_at.begin(), starting_at.end());
  std::sort(ending_at.begin(), ending_at.end());
  for (std::size_t n = 0; n < border.size(); ++n) {
    if (starting_at[n].first != ending_at[n].first) throw Error("points of a mesh nearly coincide");
    triangles_[ending_at[n].second].neighbour[0] = starting_at[n].second;
    triangles_[starting_at[n].second].neighbour[1] = ending_at[n].second;
  }
  if (border.size() < cavity.size()) throw Error("points of a mesh nearly coincide");
  hint = cavity[0];
}

std::size_t PlaneMesh::cell_of(const Vec2d& p) const {
  const auto cell = [&](double x, double low, double high) {
    const double n = double(cells_);
    return std::size_t(std::clamp(n * (x - low) / std::max(high - low, 1e-300), 0.0, n - 1));
  };
  return cell(p.y, low_.y, high_.y) * cells_ + cell(p.x, low_.x, high_.x);
}

void PlaneMesh::make_starts() {
  cells_ = std::max<std::size_t>(1, std::size_t(std::sqrt(double(points_.size())) / 2));
  starts_.assign(cells_ * cells_, 0);
  std::int32_t at = 0;
  for (std::size_t y = 0; y < cells_; ++y)
    for (std::size_t n = 0; n < cells_; ++n) {
      const std::size_t x = y % 2 == 0 ? n : cells_ - 1 - n; // back and forth
      const Vec2d middle{low_.x + (double(x) + 0.5) / double(cells_) * (high_.x - low_.x),
                         low_.y + (double(y) + 0.5) / double(cells_) * (high_.y - low_.y)};
      at = walk(middle, at);
      starts_[y * cells_ + x] = at;
    }
}

PlaneMesh::Place PlaneMesh::on_segment(std::uint32_t a, std::uint32_t b, const Vec2d& p) const {
  const Vec2d along = minus(points_[b], points_[a]);
  const double squared = dot(along, along);
  const double t = squared > 0 ? std::clamp(dot(minus(p, points_[a]), along) / squared, 0.0, 1.0) : 0;
  const Vec2d q{points_[a].x + t * along.x, points_[a].y + t * along.y};
  return {{a, b, a},
          {1 - t, t, 0},
          distance(p, q),
          std::sqrt(squared),
          std::min(distance(p, points_[a]), distance(p, points_[b]))};
}

PlaneMesh::Place PlaneMesh::on_hull(std::int32_t ghost, const Vec2d& p) const {
  // Along the hull to the side whose projection of p lies within it; where the way would turn back, the
  // corner between is nearest.
  int before = 0;
  for (std::size_t steps = 0;; ++steps) {
    const Triangle& t = triangles_[ghost];
    int k = 0;
    while (t.vertex[k] != infinity)
      ++k;
    const std::int32_t a = t.vertex[(k + 1) % 3], b = t.vertex[(k + 2) % 3];
    const Vec2d along = minus(points_[b], points_[a]), off = minus(p, points_[a]);
    const double x = dot(off, along), length = dot(along, along);
    const int way = x < 0 ? -1 : x > length ? 1 : 0;
    if (way == 0 || way == -before || steps > triangles_.size()) {
      const double u = std::clamp(x / length, 0.0, 1.0);
      const Vec2d nearest{points_[a].x + u * along.x, points_[a].y + u * along.y};
      Place place = in_triangle(t.neighbour[k], nearest);
      place.outside = distance(p, nearest);
      place.nearest = std::hypot(place.nearest, place.outside);
      return place;
    }
    before = way;
    // The ghost across the side from infinity to a lies opposite b.
    ghost = t.neighbour[way < 0 ? (k + 2) % 3 : (k + 1) % 3];
  }
}

PlaneMesh::Place PlaneMesh::locate(const Vec2d& p) const {
  if (points_.size() == 1) return {{0, 0, 0}, {1, 0, 0}, distance(p, points_[0]), 0, distance(p, points_[0])};
  if (!line_.empty()) {
    const double x = dot(p, line_direction_);
    auto above = std::upper_bound(line_.begin(), line_.end(), x, [&](double v, std::uint32_t i) {
      return v < dot(points_[i], line_direction_);
    });
    above = std::clamp(above, line_.begin() + 1, line_.end() - 1);
    return on_segment(*(above - 1), *above, p);
  }
  const std::int32_t found = walk(p, starts_[cell_of(p)]);
  const Triangle& t = triangles_[found];
  for (int k = 0; k < 3; ++k)
    if (t.vertex[k] == infinity) return on_hull(found, p);
  return in_triangle(found, p);
}

PlaneMesh::Place PlaneMesh::in_triangle(std::int32_t at, const Vec2d& p) const {
  // Points of a straight border, moved, leave slivers without width between them: from a sliver on across the
  // short side that p lies at.
  for (std::size_t steps = 0;; ++steps) {
    const Triangle& t = triangles_[at];
    const Vec2d corner[3] = {points_[t.vertex[0]], points_[t.vertex[1]], points_[t.vertex[2]]};
    Place place;
    double total = 0;
    int widest = 0; // the corner opposite the longest side
    for (int k = 0; k < 3; ++k) {
      place.point[k] = std::uint32_t(t.vertex[k]);
      place.weight[k] = std::max(0.0, turn(corner[(k + 1) % 3], corner[(k + 2) % 3], p));
      total += place.weight[k];
      if (const double side = distance(corner[(k + 1) % 3], corner[(k + 2) % 3]); side > place.edge) {
        place.edge = side;
        widest = k;
      }
    }
    const bool sliver = turn(corner[0], corner[1], corner[2]) < 1e-6 * place.edge * place.edge;
    if (!sliver && total > 0) {
      place.nearest = std::min({distance(p, corner[0]), distance(p, corner[1]), distance(p, corner[2])});
      for (double& w : place.weight)
        w /= total;
      return place;
    }
    const int from = (widest + 1) % 3, to = (widest + 2) % 3;
    const Vec2d along = minus(corner[to], corner[from]);
    const bool before = dot(minus(p, corner[widest]), along) < 0; // on the side of `from`
    const std::int32_t next = t.neighbour[before ? to : from];
    const bool ends = std::find(triangles_[next].vertex.begin(), triangles_[next].vertex.end(), infinity) !=
                      triangles_[next].vertex.end();
    if (ends || steps > triangles_.size())
      return on_segment(place.point[widest], place.point[before ? from : to], p);
    at = next;
  }
}

} // namespace nacre
