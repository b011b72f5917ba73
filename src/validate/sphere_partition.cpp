#include "validate/sphere_partition.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nacre {
namespace {

double azimuth(const Vec3d& w) {
  const double phi = std::atan2(w.y, w.x);
  return phi < 0 ? phi + 2 * pi : phi;
}
double coordinate(const Vec3d& w, bool z) { return z ? w.z : azimuth(w); }

/// The shortest interval of a coordinate that holds `count` of the samples.
std::pair<double, double> crowd(std::span<const Vec3d> samples, bool along_z, std::size_t count) {
  std::vector<double> x;
  for (const Vec3d& w : samples)
    x.push_back(coordinate(w, along_z));
  if (count == x.size()) {
    const auto [first, last] = std::minmax_element(x.begin(), x.end());
    return {*first, *last};
  }
  std::sort(x.begin(), x.end());
  std::size_t best = 0;
  for (std::size_t i = 0; i + count <= x.size(); ++i)
    if (x[i + count - 1] - x[i] < x[best + count - 1] - x[best]) best = i;
  return {x[best], x[best + count - 1]};
}

// Five-point Gauss-Legendre rule on [-1, 1] (Abramowitz and Stegun, table 25.4).
constexpr std::array<double, 5> nodes{-0.906179845938664, -0.538469310105683, 0, 0.538469310105683,
                                      0.906179845938664};
constexpr std::array<double, 5> weights{0.236926885056189, 0.478628670499366, 0.568888888888889,
                                        0.478628670499366, 0.236926885056189};

Values gauss(const DirectionCell& c, const DirectionFunction& f) {
  const double mz = 0.5 * (c.z0 + c.z1), hz = 0.5 * (c.z1 - c.z0);
  const double mp = 0.5 * (c.phi0 + c.phi1), hp = 0.5 * (c.phi1 - c.phi0);
  Values sum{};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double z = mz + hz * nodes[i], s = std::sqrt(std::max(0.0, 1 - z * z));
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      const double phi = mp + hp * nodes[j], weight = weights[i] * weights[j] * hz * hp;
      const Values at = f({s * std::cos(phi), s * std::sin(phi), z});
      for (std::size_t k = 0; k < at.size(); ++k)
        sum[k] += weight * at[k];
    }
  }
  return sum;
}

std::array<DirectionCell, 4> quarters(const DirectionCell& c) {
  const double z = 0.5 * (c.z0 + c.z1), p = 0.5 * (c.phi0 + c.phi1);
  return {{{c.z0, z, c.phi0, p}, {c.z0, z, p, c.phi1}, {z, c.z1, c.phi0, p}, {z, c.z1, p, c.phi1}}};
}

Integral refine(const DirectionCell& c, const Values& coarse, const DirectionFunction& f, double tolerance,
                std::size_t judged, int depth) {
  const auto parts = quarters(c);
  std::array<Values, 4> fine;
  Integral total;
  bool good = true;
  for (std::size_t i = 0; i < 4; ++i) {
    fine[i] = gauss(parts[i], f);
    for (std::size_t k = 0; k < coarse.size(); ++k)
      total.value[k] += fine[i][k];
  }
  for (std::size_t k = 0; k < coarse.size(); ++k) {
    total.error[k] = std::abs(total.value[k] - coarse[k]);
    good = good && (k >= judged || !(total.error[k] > tolerance));
  }
  if (good || depth == 0) return total;
  total = {};
  for (std::size_t i = 0; i < 4; ++i) {
    const Integral part = refine(parts[i], fine[i], f, 0.5 * tolerance, judged, depth - 1);
    for (std::size_t k = 0; k < coarse.size(); ++k) {
      total.value[k] += part.value[k];
      total.error[k] += part.error[k];
    }
  }
  return total;
}

} // namespace

SpherePartition::SpherePartition(std::vector<Vec3d> samples, int depth) {
  // The horizon is where models begin and end: no cell crosses it.
  split(samples, {-1, 1, 0, 2 * pi}, true, 0, depth - 1);
}

int SpherePartition::split(std::span<Vec3d> samples, const DirectionCell& cell, bool split_z, double at,
                           int depth) {
  DirectionCell low = cell, high = cell;
  (split_z ? low.z1 : low.phi1) = at;
  (split_z ? high.z0 : high.phi0) = at;
  const auto middle = std::partition(samples.begin(), samples.end(),
                                     [&](const Vec3d& w) { return coordinate(w, split_z) < at; });
  const int self = int(nodes_.size());
  nodes_.push_back({split_z, at, 0, 0});
  if (depth == 0) low.group = group_count_++, high.group = group_count_++; // from here on, cells of one group
  const int below = build({samples.begin(), middle}, low, depth);
  const int above = build({middle, samples.end()}, high, depth);
  nodes_[std::size_t(self)].below = below;
  nodes_[std::size_t(self)].above = above;
  return self;
}

int SpherePartition::build(std::span<Vec3d> samples, const DirectionCell& cell, int depth) {
  const auto leaf = [&] {
    cells_.push_back(cell);
    if (depth > 0) cells_.back().group = group_count_++;
    return ~int(cells_.size() - 1);
  };
  if (samples.size() < 4) return leaf();
  // First cut off what the samples leave empty: a rule with few nodes would miss a lobe in the corner of a
  // large cell. Sixteen samples of a Gaussian leave an eighth of it outside their range; with half that range
  // more on either side 5e-4 remains. Fewer are trusted less, and may be the edge of a lobe and some strays.
  const bool few = samples.size() < 16;
  for (const std::size_t count : {samples.size(), few ? (2 * samples.size() + 2) / 3 : samples.size()})
    for (const bool along_z : {true, false}) {
      const double lo = along_z ? cell.z0 : cell.phi0, hi = along_z ? cell.z1 : cell.phi1;
      const auto [from, to] = crowd(samples, along_z, count);
      const double margin = (few ? 1 : 0.5) * (to - from);
      if (!(to > from)) continue;
      if (from - margin - lo > 0.4 * (hi - lo)) return split(samples, cell, along_z, from - margin, depth);
      if (hi - to - margin > 0.4 * (hi - lo)) return split(samples, cell, along_z, to + margin, depth);
    }
  if (few) return leaf();
  // Then halve the longer side as seen on the sphere, at the median.
  const double z = 0.5 * (cell.z0 + cell.z1), sin_theta = std::sqrt(std::max(1e-12, 1 - z * z));
  const bool along_z = (cell.z1 - cell.z0) / sin_theta > (cell.phi1 - cell.phi0) * sin_theta;
  const auto middle = samples.begin() + std::ptrdiff_t(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end(), [&](const Vec3d& a, const Vec3d& b) {
    return coordinate(a, along_z) < coordinate(b, along_z);
  });
  const double at = coordinate(*middle, along_z);
  if (!(at > (along_z ? cell.z0 : cell.phi0)) || !(at < (along_z ? cell.z1 : cell.phi1))) return leaf();
  return split(samples, cell, along_z, at, depth - 1);
}

const DirectionCell& SpherePartition::find(const Vec3d& w) const {
  int n = 0;
  while (n >= 0) {
    const Node& node = nodes_[std::size_t(n)];
    n = coordinate(w, node.split_z) < node.at ? node.below : node.above;
  }
  return cells_[std::size_t(~n)];
}

Integral SpherePartition::integrate(const DirectionCell& cell, const DirectionFunction& f, double tolerance,
                                    std::size_t judged) {
  return refine(cell, gauss(cell, f), f, tolerance, judged, 7);
}

} // namespace nacre
