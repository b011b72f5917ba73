#include "measured/inspection.h"

#include "core/random.h"
#include "core/warp.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nacre {
namespace {

Vec3d at_angles(double theta, double phi, bool front) {
  const Vec3d w = spherical_direction(theta, phi);
  return {w.x, w.y, front ? w.z : -w.z};
}

} // namespace

std::vector<SidePair> side_pairs(const MeasuredSides& sides) {
  std::vector<SidePair> list;
  if (sides.reflects_front) list.push_back({"reflection, front", true, true});
  if (sides.reflects_back) list.push_back({"reflection, back", false, false});
  if (sides.transmits_to_front) list.push_back({"transmission to the front", true, false});
  if (sides.transmits_to_back) list.push_back({"transmission to the back", false, true});
  return list;
}

std::vector<CoverageMap> coverage(const MeasuredBsdf& measured) {
  constexpr int differences = 36;
  const int azimuths = measured.is_isotropic() ? 1 : 8;
  std::vector<float> f(std::size_t(measured.channels().count()));
  std::vector<CoverageMap> maps;
  for (const SidePair& sides : side_pairs(measured.sides())) {
    CoverageMap map{sides, {}, 0};
    double weights = 0;
    for (int o = 0; o < CoverageMap::bins; ++o)
      for (int i = 0; i < CoverageMap::bins; ++i) {
        const double theta_o = pi / 2 * (o + 0.5) / CoverageMap::bins;
        const double theta_i = pi / 2 * (i + 0.5) / CoverageMap::bins;
        int found = 0;
        for (int a = 0; a < azimuths; ++a)
          for (int d = 0; d < differences; ++d) {
            const double phi = 2 * pi * (a + 0.5) / azimuths;
            found += measured.evaluate(
                at_angles(theta_o, phi, sides.wo_front),
                at_angles(theta_i, phi + 2 * pi * (d + 0.5) / differences, sides.wi_front), f);
          }
        const double share = found / double(azimuths * differences);
        map.share[std::size_t(o)][std::size_t(i)] = share;
        const double weight = std::sin(theta_o) * std::sin(theta_i);
        map.whole += weight * share;
        weights += weight;
      }
    map.whole /= weights;
    maps.push_back(map);
  }
  return maps;
}

SampleStatistics sample_statistics(const MeasuredBsdf& measured) {
  const MeasuredSamples samples = measured.samples();
  const std::size_t n = std::size_t(measured.channels().count());
  SampleStatistics s{samples.size(), {}};
  if (s.count == 0) return s;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  s.channels.assign(n, {infinite, -infinite, 0});
  for (std::size_t at = 0; at < s.count; ++at)
    for (std::size_t c = 0; c < n; ++c) {
      const double x = double(samples.f[at * n + c]);
      ChannelRange& range = s.channels[c];
      range.lo = std::min(range.lo, x), range.hi = std::max(range.hi, x), range.mean += x;
    }
  for (ChannelRange& range : s.channels)
    range.mean /= double(s.count);
  return s;
}

ReciprocityError reciprocity_error(const MeasuredBsdf& measured, int pairs) {
  ReciprocityError error;
  const std::vector<SidePair> sides = side_pairs(measured.sides());
  std::vector<float> f(std::size_t(measured.channels().count()));
  const auto value = [&](const Vec3d& wo, const Vec3d& wi) {
    if (!measured.evaluate(wo, wi, f)) return -1.0;
    double sum = 0;
    for (const float x : f)
      sum += double(x);
    return std::max(sum / double(f.size()), 0.0);
  };
  for (int n = 0; n < pairs && !sides.empty(); ++n) {
    const auto u = [n](int d) { return unit_double(hash(23, n, d)); };
    const SidePair& pair = sides[std::size_t(n) % sides.size()];
    Vec3d wo = square_to_hemisphere(Vec2d{u(0), u(1)}), wi = square_to_hemisphere(Vec2d{u(2), u(3)});
    if (!pair.wo_front) wo.z = -wo.z;
    if (!pair.wi_front) wi.z = -wi.z;
    const double there = value(wo, wi), back = value(wi, wo);
    if (there < 0 || back < 0 || !(there + back > 0)) continue;
    const double e = std::abs(there - back) / (0.5 * (there + back));
    ++error.pairs;
    error.mean += e;
    if (e > error.worst || error.pairs == 1) error.worst = e, error.wo = wo, error.wi = wi;
  }
  if (error.pairs > 0) error.mean /= double(error.pairs);
  return error;
}

} // namespace nacre
