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

// Five-point Gauss-Legendre rule on [-1, 1] (Abramowitz and Stegun, table 25.4).
constexpr std::array<double, 5> nodes{-0.906179845938664, -0.538469310105683, 0, 0.538469310105683,
                                      0.906179845938664};
constexpr std::array<double, 5> weights{0.236926885056189, 0.478628670499366, 0.568888888888889,
                                        0.478628670499366, 0.236926885056189};

double gauss(const DirectionCell& c, const std::function<double(const Vec3d&)>& f) {
  const double mz = 0.5 * (c.z0 + c.z1), hz = 0.5 * (c.z1 - c.z0);
  const double mp = 0.5 * (c.phi0 + c.phi1), hp = 0.5 * (c.phi1 - c.phi0);
  double sum = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double z = mz + hz * nodes[i], s = std::sqrt(std::max(0.0, 1 - z * z));
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      const double phi = mp + hp * nodes[j];
      sum += weights[i] * weights[j] * f({s * std::cos(phi), s * std::sin(phi), z});
    }
  }
  return sum * hz * hp;
}

std::array<DirectionCell, 4> quarters(const DirectionCell& c) {
  const double z = 0.5 * (c.z0 + c.z1), p = 0.5 * (c.phi0 + c.phi1);
  return {{{c.z0, z, c.phi0, p}, {c.z0, z, p, c.phi1}, {z, c.z1, c.phi0, p}, {z, c.z1, p, c.phi1}}};
}

Integral refine(const DirectionCell& c, double coarse, const std::function<double(const Vec3d&)>& f,
                double tolerance, int depth) {
  const auto parts = quarters(c);
  std::array<double, 4> fine;
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i)
    sum += fine[i] = gauss(parts[i], f);
  const double error = std::abs(sum - coarse);
  if (error <= tolerance || depth == 0) return {sum, error};
  Integral total;
  for (std::size_t i = 0; i < 4; ++i) {
    const Integral part = refine(parts[i], fine[i], f, 0.5 * tolerance, depth - 1);
    total.value += part.value;
    total.error += part.error;
  }
  return total;
}

} // namespace

SpherePartition::SpherePartition(std::vector<Vec3d> samples, int depth) {
  // The horizon is where models begin and end: no cell crosses it.
  const auto lower_end =
      std::partition(samples.begin(), samples.end(), [](const Vec3d& w) { return w.z < 0; });
  nodes_.push_back({true, 0, 0, 0});
  root_ = 0;
  const int below = build({samples.begin(), lower_end}, {-1, 0, 0, 2 * pi}, depth - 1);
  const int above = build({lower_end, samples.end()}, {0, 1, 0, 2 * pi}, depth - 1);
  nodes_[0].below = below;
  nodes_[0].above = above;
}

int SpherePartition::build(std::span<Vec3d> samples, const DirectionCell& cell, int depth) {
  const auto leaf = [&] {
    cells_.push_back(cell);
    return ~int(cells_.size() - 1);
  };
  if (depth <= 0 || samples.size() < 16) return leaf();
  // Halve the longer side as seen on the sphere.
  const double z = 0.5 * (cell.z0 + cell.z1), sin_theta = std::sqrt(std::max(1e-12, 1 - z * z));
  const bool split_z = (cell.z1 - cell.z0) / sin_theta > (cell.phi1 - cell.phi0) * sin_theta;
  const std::size_t middle = samples.size() / 2;
  std::nth_element(
      samples.begin(), samples.begin() + std::ptrdiff_t(middle), samples.end(),
      [&](const Vec3d& a, const Vec3d& b) { return coordinate(a, split_z) < coordinate(b, split_z); });
  const double at = coordinate(samples[middle], split_z);
  DirectionCell low = cell, high = cell;
  (split_z ? low.z1 : low.phi1) = at;
  (split_z ? high.z0 : high.phi0) = at;
  if (!(at > (split_z ? cell.z0 : cell.phi0)) || !(at < (split_z ? cell.z1 : cell.phi1))) return leaf();
  const int self = int(nodes_.size());
  nodes_.push_back({split_z, at, 0, 0});
  const int below = build(samples.subspan(0, middle), low, depth - 1);
  const int above = build(samples.subspan(middle), high, depth - 1);
  nodes_[std::size_t(self)].below = below;
  nodes_[std::size_t(self)].above = above;
  return self;
}

std::size_t SpherePartition::find(const Vec3d& w) const {
  int n = root_;
  while (n >= 0) {
    const Node& node = nodes_[std::size_t(n)];
    n = coordinate(w, node.split_z) < node.at ? node.below : node.above;
  }
  return std::size_t(~n);
}

Integral SpherePartition::integrate(const DirectionCell& cell, const std::function<double(const Vec3d&)>& f,
                                    double tolerance) {
  return refine(cell, gauss(cell, f), f, tolerance, 7);
}

Integral SpherePartition::integrate(const std::function<double(const Vec3d&)>& f,
                                    double tolerance_per_cell) const {
  Integral total;
  for (const DirectionCell& cell : cells_) {
    const Integral part = integrate(cell, f, tolerance_per_cell);
    total.value += part.value;
    total.error += part.error;
  }
  return total;
}

} // namespace nacre
