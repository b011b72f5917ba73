#include "measured/angle_grid.h"

#include "core/error.h"
#include "core/parallel.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace nacre {
namespace {

constexpr double degrees = 180 / pi;
constexpr float hole = std::numeric_limits<float>::quiet_NaN();
/// Angles nearer than this are one: directions come as floats.
constexpr double angle_tolerance = 1e-4;

double largest_gap(const std::vector<double>& nodes) {
  double gap = 0;
  for (std::size_t i = 1; i < nodes.size(); ++i)
    gap = std::max(gap, nodes[i] - nodes[i - 1]);
  return gap;
}

void check_nodes(const char* name, const std::vector<double>& nodes, double from, double to) {
  if (nodes.empty()) throw Error(fmt::format("{} has no nodes", name));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!(nodes[i] >= from - 1e-9 && nodes[i] <= to + 1e-9))
      throw Error(fmt::format("{} is {} degrees, expected {} to {}", name, nodes[i] * degrees, from * degrees,
                              to * degrees));
    if (i > 0 && !(nodes[i] > nodes[i - 1]))
      throw Error(fmt::format("{} must increase, found {} degrees after {}", name, nodes[i] * degrees,
                              nodes[i - 1] * degrees));
  }
}

std::string described(const std::vector<double>& nodes) {
  if (nodes.size() == 1) return fmt::format("1 ({:.4g})", nodes[0] * degrees);
  return fmt::format("{} ({:.4g} to {:.4g})", nodes.size(), nodes.front() * degrees, nodes.back() * degrees);
}

/// Half-way borders between nodes, and the ends of the range.
std::vector<double> borders(const std::vector<double>& nodes) {
  std::vector<double> b{nodes.front()};
  for (std::size_t i = 1; i < nodes.size(); ++i)
    b.push_back((nodes[i - 1] + nodes[i]) / 2);
  b.push_back(nodes.back());
  return b;
}

/// Solid angle of each node's band of polar angles, over 2 pi.
std::vector<double> band_weights(const std::vector<double>& thetas) {
  if (thetas.size() == 1) return {1};
  const auto b = borders(thetas);
  std::vector<double> w;
  for (std::size_t i = 0; i < thetas.size(); ++i)
    w.push_back(std::cos(b[i]) - std::cos(b[i + 1]));
  return w;
}

/// Share of the turn of each azimuth, not normalised.
std::vector<double> azimuth_weights(const std::vector<double>& azimuths, bool closed) {
  const std::size_t n = azimuths.size();
  if (n == 1) return {1};
  std::vector<double> w;
  for (std::size_t i = 0; i < n; ++i) {
    const double before = i > 0    ? azimuths[i] - azimuths[i - 1]
                          : closed ? azimuths[0] + 2 * pi - azimuths[n - 1]
                                   : 0;
    const double after = i + 1 < n ? azimuths[i + 1] - azimuths[i]
                         : closed  ? azimuths[0] + 2 * pi - azimuths[n - 1]
                                   : 0;
    w.push_back((before + after) / 2);
  }
  return w;
}

} // namespace

AngleGrid::AngleGrid(Nodes nodes, Channels channels, std::vector<float> values, std::string kind,
                     std::vector<std::pair<std::string, std::string>> facts)
    : nodes_(std::move(nodes)), channels_(std::move(channels)), values_(std::move(values)),
      kind_(std::move(kind)), facts_(std::move(facts)) {
  check();
  merge_full_turns();
  remove_partial_and_hidden_nodes();
  average_poles();
}

void AngleGrid::check() const {
  const bool about_specular = nodes_.axis == Axis::specular;
  check_nodes("theta_i", nodes_.theta_i, 0, pi / 2);
  check_nodes("phi_i", nodes_.phi_i, -2 * pi, 2 * pi);
  check_nodes("theta_o", nodes_.theta_o, 0, about_specular ? pi : pi / 2);
  if (nodes_.mirror == Mirror::none)
    check_nodes("phi_o", nodes_.phi_o, -2 * pi, 2 * pi);
  else
    check_nodes("phi_o of mirrored data", nodes_.phi_o, 0, pi);
  for (const auto* azimuths : {&nodes_.phi_i, &nodes_.phi_o})
    if (azimuths->back() - azimuths->front() > 2 * pi + 1e-9)
      throw Error(fmt::format("azimuths span {} degrees, more than a turn",
                              (azimuths->back() - azimuths->front()) * degrees));
  if (!nodes_.theta_specular.empty()) {
    if (nodes_.theta_specular.size() != nodes_.theta_i.size())
      throw Error(fmt::format("{} specular angles for {} angles of incidence", nodes_.theta_specular.size(),
                              nodes_.theta_i.size()));
    for (const double t : nodes_.theta_specular)
      if (!(std::abs(t) <= pi / 2 + 1e-9))
        throw Error(fmt::format("specular angle is {} degrees, expected -90 to 90", t * degrees));
  }
  std::size_t expected = std::size_t(channels_.count());
  for (const auto* axis : {&nodes_.theta_i, &nodes_.phi_i, &nodes_.theta_o, &nodes_.phi_o}) {
    if (axis->size() > max_nodes * std::size_t(channels_.count()) / expected)
      throw Error(fmt::format("a grid of angles has more than {} nodes", max_nodes));
    expected *= axis->size();
  }
  if (values_.size() != expected)
    throw Error(fmt::format("a grid of angles needs {} values, found {}", expected, values_.size()));
  for (const float x : values_)
    if (std::isinf(x)) throw Error("a grid of angles has an infinite value");
}

std::size_t AngleGrid::index(std::size_t i, std::size_t j, std::size_t k, std::size_t l) const {
  return (((i * nodes_.phi_i.size() + j) * nodes_.theta_o.size() + k) * nodes_.phi_o.size() + l) *
         std::size_t(channels_.count());
}

std::size_t AngleGrid::node_count() const { return values_.size() / std::size_t(channels_.count()); }

std::span<const float> AngleGrid::at(std::size_t i, std::size_t j, std::size_t k, std::size_t l) const {
  return {&values_[index(i, j, k, l)], std::size_t(channels_.count())};
}

void AngleGrid::merge_full_turns() {
  const auto closes = [](const std::vector<double>& a) {
    return a.size() > 1 && a.back() - a.front() > 2 * pi - 1e-9;
  };
  const bool in = closes(nodes_.phi_i), out = closes(nodes_.phi_o);
  if (!in && !out) return;
  const std::size_t n_j = nodes_.phi_i.size(), n_l = nodes_.phi_o.size(), channels = channels_.count();
  std::vector<float> merged;
  merged.reserve(values_.size());
  for (std::size_t i = 0; i < nodes_.theta_i.size(); ++i)
    for (std::size_t j = 0; j < n_j - in; ++j)
      for (std::size_t k = 0; k < nodes_.theta_o.size(); ++k)
        for (std::size_t l = 0; l < n_l - out; ++l)
          for (std::size_t c = 0; c < channels; ++c) {
            double sum = 0;
            int found = 0;
            for (const std::size_t jj : {j, in && j == 0 ? n_j - 1 : j})
              for (const std::size_t ll : {l, out && l == 0 ? n_l - 1 : l})
                if (const float x = values_[index(i, jj, k, ll) + c]; !std::isnan(x)) {
                  sum += double(x);
                  ++found;
                }
            merged.push_back(found > 0 ? float(sum / found) : hole);
          }
  values_ = std::move(merged);
  if (in) nodes_.phi_i.pop_back();
  if (out) nodes_.phi_o.pop_back();
}

void AngleGrid::remove_partial_and_hidden_nodes() {
  const std::size_t channels = channels_.count();
  for (std::size_t n = 0; n < values_.size(); n += channels)
    if (std::any_of(&values_[n], &values_[n] + channels, [](float x) { return std::isnan(x); }))
      std::fill_n(&values_[n], channels, hole);
  if (nodes_.axis != Axis::specular) return;
  for (std::size_t i = 0; i < nodes_.theta_i.size(); ++i)
    for (std::size_t k = 0; k < nodes_.theta_o.size(); ++k)
      for (std::size_t l = 0; l < nodes_.phi_o.size(); ++l) {
        const double z = directions(i, 0, nodes_.theta_o[k], nodes_.phi_o[l]).first.z;
        if ((nodes_.transmits ? -z : z) < -1e-7)
          for (std::size_t j = 0; j < nodes_.phi_i.size(); ++j)
            std::fill_n(&values_[index(i, j, k, l)], channels, hole);
      }
}

void AngleGrid::average_ring(std::size_t i, std::size_t j, std::size_t k) {
  const bool mirrored = nodes_.mirror == Mirror::plane_of_incidence;
  const auto weights = azimuth_weights(nodes_.phi_o, !mirrored);
  std::vector<double> sum(channels_.count());
  double total = 0;
  for (std::size_t l = 0; l < weights.size(); ++l)
    if (const auto f = at(i, j, k, l); !std::isnan(f[0])) {
      total += weights[l];
      for (std::size_t c = 0; c < sum.size(); ++c)
        sum[c] += weights[l] * double(f[c]);
    }
  if (!(total > 0)) return;
  for (std::size_t l = 0; l < weights.size(); ++l)
    for (std::size_t c = 0; c < sum.size(); ++c)
      values_[index(i, j, k, l) + c] = float(sum[c] / total);
}

void AngleGrid::average_poles() {
  const std::size_t n_k = nodes_.theta_o.size();
  for (std::size_t i = 0; i < nodes_.theta_i.size(); ++i) {
    const bool at_normal = is_isotropic() && nodes_.theta_i[i] < 1e-9 && std::abs(specular(0)) < 1e-9;
    for (std::size_t j = 0; j < nodes_.phi_i.size(); ++j)
      for (std::size_t k = 0; k < n_k; ++k)
        if (at_normal || nodes_.theta_o[k] < 1e-9) average_ring(i, j, k);
  }
}

double AngleGrid::specular(double theta_i) const {
  const auto& s = nodes_.theta_specular;
  if (s.empty()) return theta_i;
  const auto& t = nodes_.theta_i;
  if (theta_i <= t.front() || t.size() == 1) return s.front() + (theta_i - t.front());
  if (theta_i >= t.back()) return s.back() + (theta_i - t.back());
  const std::size_t i = std::size_t(std::upper_bound(t.begin(), t.end(), theta_i) - t.begin());
  const double x = (theta_i - t[i - 1]) / (t[i] - t[i - 1]);
  return (1 - x) * s[i - 1] + x * s[i];
}

std::pair<Vec3d, Vec3d> AngleGrid::directions(std::size_t i_theta_i, std::size_t i_phi_i, double theta_o,
                                              double phi_o) const {
  const double theta_i = nodes_.theta_i[i_theta_i], phi_i = nodes_.phi_i[i_phi_i];
  // In the plane of incidence, with wi at azimuth 0.
  Vec3d o{std::sin(theta_o) * std::cos(phi_o), std::sin(theta_o) * std::sin(phi_o), std::cos(theta_o)};
  if (nodes_.axis == Axis::specular) {
    const double s = std::sin(specular(theta_i)), c = std::cos(specular(theta_i));
    o = {c * o.x - s * o.z, o.y, s * o.x + c * o.z};
  }
  const double s = std::sin(phi_i), c = std::cos(phi_i);
  return {{c * o.x - s * o.y, s * o.x + c * o.y, nodes_.transmits ? -o.z : o.z},
          {std::sin(theta_i) * c, std::sin(theta_i) * s, std::cos(theta_i)}};
}

std::array<double, 4> AngleGrid::angles(const Vec3d& wo, const Vec3d& wi) const {
  const double sin_i = std::hypot(wi.x, wi.y);
  const double theta_i = std::atan2(sin_i, wi.z);
  const double c = sin_i > 0 ? wi.x / sin_i : 1, s = sin_i > 0 ? wi.y / sin_i : 0;
  Vec3d o{c * wo.x + s * wo.y, c * wo.y - s * wo.x, std::abs(wo.z)};
  if (nodes_.axis == Axis::specular) {
    const double sin_s = std::sin(specular(theta_i)), cos_s = std::cos(specular(theta_i));
    o = {cos_s * o.x + sin_s * o.z, o.y, cos_s * o.z - sin_s * o.x};
  }
  return {theta_i, std::atan2(s, c), std::atan2(std::hypot(o.x, o.y), o.z),
          o.x == 0 && o.y == 0 ? 0 : std::atan2(o.y, o.x)};
}

std::optional<AngleGrid::Between> AngleGrid::between_thetas(const std::vector<double>& nodes,
                                                            double angle) const {
  const std::size_t last = nodes.size() - 1;
  const bool inside = angle >= nodes.front() - angle_tolerance && angle <= nodes.back() + angle_tolerance;
  if (!inside && !nodes_.holds_beyond_ends) return {};
  if (angle <= nodes.front()) return Between{};
  if (angle >= nodes.back()) return Between{last, last, 0};
  const std::size_t i = std::size_t(std::upper_bound(nodes.begin(), nodes.end(), angle) - nodes.begin());
  return Between{i - 1, i, (angle - nodes[i - 1]) / (nodes[i] - nodes[i - 1])};
}

std::optional<AngleGrid::Between> AngleGrid::between_azimuths(const std::vector<double>& nodes, double angle,
                                                              bool mirrored) const {
  const std::size_t last = nodes.size() - 1;
  if (last == 0) return Between{};
  if (!mirrored) angle -= 2 * pi * std::floor((angle - nodes.front()) / (2 * pi));
  if (angle > nodes.front() && angle < nodes.back()) {
    const std::size_t i = std::size_t(std::upper_bound(nodes.begin(), nodes.end(), angle) - nodes.begin());
    return Between{i - 1, i, (angle - nodes[i - 1]) / (nodes[i] - nodes[i - 1])};
  }
  if (mirrored) {
    // The node's own mirror image is the other neighbour.
    const double off = angle <= nodes.front() ? nodes.front() - angle : angle - nodes.back();
    const double gap = 2 * (angle <= nodes.front() ? nodes.front() : pi - nodes.back());
    if (off > angle_tolerance && gap > 2 * largest_gap(nodes)) return {};
    return angle <= nodes.front() ? Between{} : Between{last, last, 0};
  }
  const double gap = nodes.front() + 2 * pi - nodes.back(), off = angle - nodes.back();
  if (angle <= nodes.front()) return Between{};
  if (gap > 2 * largest_gap(nodes)) {
    if (off <= angle_tolerance) return Between{last, last, 0};
    if (gap - off <= angle_tolerance) return Between{};
    return {};
  }
  return Between{last, 0, off / gap};
}

MeasuredSides AngleGrid::sides() const {
  MeasuredSides s;
  s.reflects_front = !nodes_.transmits;
  s.transmits_to_back = nodes_.transmits;
  return s;
}

bool AngleGrid::evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const {
  const std::size_t channels = channels_.count();
  std::fill_n(f.begin(), channels, 0.0f);
  if (!sides().contain(wo, wi)) return false;
  auto [theta_i, phi_i, theta_o, phi_o] = angles(wo, wi);
  if (nodes_.mirror != Mirror::none && phi_o < 0) {
    phi_o = -phi_o;
    if (nodes_.mirror == Mirror::sample) phi_i = -phi_i;
  }
  const std::array<std::optional<Between>, 4> b{
      between_thetas(nodes_.theta_i, theta_i), between_azimuths(nodes_.phi_i, phi_i, false),
      between_thetas(nodes_.theta_o, theta_o),
      between_azimuths(nodes_.phi_o, phi_o, nodes_.mirror != Mirror::none)};
  if (!b[0] || !b[1] || !b[2] || !b[3]) return false;
  std::array<double, Channels::max_count> sum;
  std::fill_n(sum.begin(), channels, 0.0);
  double total = 0;
  for (int corner = 0; corner < 16; ++corner) {
    double w = 1;
    std::array<std::size_t, 4> n;
    for (int d = 0; d < 4; ++d) {
      const bool above = corner >> d & 1;
      w *= above ? b[d]->t : 1 - b[d]->t;
      n[d] = above ? b[d]->above : b[d]->below;
    }
    if (!(w > 0)) continue;
    const float* x = &values_[index(n[0], n[1], n[2], n[3])];
    if (std::isnan(x[0])) continue;
    total += w;
    for (std::size_t c = 0; c < channels; ++c)
      sum[c] += w * double(x[c]);
  }
  if (!(total > 0)) return false;
  for (std::size_t c = 0; c < channels; ++c)
    f[c] = float(sum[c] / total);
  return true;
}

MeasuredSamples AngleGrid::samples() const {
  MeasuredSamples s;
  const auto w_i = band_weights(nodes_.theta_i), w_o = band_weights(nodes_.theta_o),
             v_i = azimuth_weights(nodes_.phi_i, true),
             v_o = azimuth_weights(nodes_.phi_o, nodes_.mirror == Mirror::none);
  double turn = 0;
  for (const double v : v_o)
    turn += v;
  const auto single = [](const Vec3d& w) { return Vec3f{float(w.x), float(w.y), float(w.z)}; };
  for (std::size_t i = 0; i < w_i.size(); ++i)
    for (std::size_t j = 0; j < v_i.size(); ++j)
      for (std::size_t k = 0; k < w_o.size(); ++k) {
        const bool pole = nodes_.theta_o[k] < 1e-9;
        for (std::size_t l = 0; l < (pole ? 1 : v_o.size()); ++l) {
          const auto f = at(i, j, k, l);
          if (std::isnan(f[0])) continue;
          const auto [wo, wi] = directions(i, j, nodes_.theta_o[k], nodes_.phi_o[l]);
          // A node at the horizon has a cosine of rounding errors.
          if (std::abs(wo.z) < 1e-9 || wi.z < 1e-9 || !sides().contain(wo, wi)) continue;
          s.wo.push_back(single(wo));
          s.wi.push_back(single(wi));
          s.f.insert(s.f.end(), f.begin(), f.end());
          s.weight.push_back(w_i[i] * v_i[j] * w_o[k] * (pole ? turn : v_o[l]));
        }
      }
  return s;
}

std::size_t AngleGrid::hole_count() const {
  std::size_t holes = 0;
  for (std::size_t n = 0; n < values_.size(); n += std::size_t(channels_.count()))
    holes += std::isnan(values_[n]);
  return holes;
}

std::vector<std::pair<std::string, std::string>> AngleGrid::facts() const {
  std::vector<std::pair<std::string, std::string>> all{
      {"nodes (degrees)",
       fmt::format("theta_i {}, phi_i {}, theta_o {}, phi_o {}", described(nodes_.theta_i),
                   described(nodes_.phi_i), described(nodes_.theta_o), described(nodes_.phi_o))},
      {"scattering angles", nodes_.axis == Axis::normal ? "about the normal, azimuth from that of incidence"
                                                        : "about the specular direction"},
  };
  if (nodes_.mirror == Mirror::plane_of_incidence)
    all.emplace_back("symmetry", "mirrored at the plane of incidence");
  if (nodes_.mirror == Mirror::sample) all.emplace_back("symmetry", "mirrored with the sample");
  if (nodes_.holds_beyond_ends) all.emplace_back("beyond the nodes", "the last values hold to the horizon");
  all.emplace_back("holes", fmt::format("{} of {} nodes", hole_count(), node_count()));
  all.insert(all.end(), facts_.begin(), facts_.end());
  return all;
}

std::vector<double> AngleGrid::albedo(std::size_t i_theta_i, std::size_t i_phi_i) const {
  constexpr int points = 8;
  std::vector<double> sum(channels_.count()), azimuths = nodes_.phi_o;
  std::array<float, Channels::max_count> f;
  // With one azimuth, or the closing one of a turn, the cells go all the way around.
  if (azimuths.size() == 1) azimuths = {0, 2 * pi / 3, 4 * pi / 3};
  if (nodes_.mirror == Mirror::none) azimuths.push_back(azimuths.front() + 2 * pi);
  auto thetas = nodes_.theta_o;
  if (nodes_.holds_beyond_ends || thetas.size() == 1) {
    thetas.front() = 0;
    if (thetas.back() < pi / 2) thetas.push_back(pi / 2);
  }
  const bool mirrored = nodes_.mirror == Mirror::plane_of_incidence;
  for (std::size_t k = 1; k < thetas.size(); ++k)
    for (std::size_t l = 1; l < azimuths.size(); ++l)
      for (int a = 0; a < points; ++a)
        for (int b = 0; b < points; ++b) {
          const double d_theta = (thetas[k] - thetas[k - 1]) / points,
                       d_phi = (azimuths[l] - azimuths[l - 1]) / points;
          const double theta = thetas[k - 1] + (a + 0.5) * d_theta;
          const auto [wo, wi] = directions(i_theta_i, i_phi_i, theta, azimuths[l - 1] + (b + 0.5) * d_phi);
          if (!evaluate(wo, wi, {f.data(), sum.size()})) continue;
          const double w = std::abs(wo.z) * std::sin(theta) * d_theta * d_phi * (mirrored ? 2 : 1);
          for (std::size_t c = 0; c < sum.size(); ++c)
            sum[c] += w * double(f[c]);
        }
  return sum;
}

void AngleGrid::scale(std::size_t i_theta_i, std::size_t i_phi_i, std::size_t channel, double factor) {
  for (std::size_t k = 0; k < nodes_.theta_o.size(); ++k)
    for (std::size_t l = 0; l < nodes_.phi_o.size(); ++l) {
      float& x = values_[index(i_theta_i, i_phi_i, k, l) + channel];
      x = float(double(x) * factor);
    }
}

void AngleGrid::divide_by_cosines() {
  for (std::size_t i = 0; i < nodes_.theta_i.size(); ++i)
    for (std::size_t k = 0; k < nodes_.theta_o.size(); ++k)
      for (std::size_t l = 0; l < nodes_.phi_o.size(); ++l) {
        const double z = std::abs(directions(i, 0, nodes_.theta_o[k], nodes_.phi_o[l]).first.z);
        for (std::size_t j = 0; j < nodes_.phi_i.size(); ++j)
          for (std::size_t c = 0; c < std::size_t(channels_.count()); ++c) {
            float& x = values_[index(i, j, k, l) + c];
            x = z > 1e-7 ? float(double(x) / z) : hole;
          }
      }
}

} // namespace nacre
