#include "measured/klems_basis.h"

#include "core/error.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

double cos_deg(double degrees) { return degrees >= 90 ? 0 : std::cos(degrees * pi / 180); }

} // namespace

KlemsBasis::KlemsBasis(std::string name, std::vector<Ring> rings)
    : name_(std::move(name)), rings_(std::move(rings)) {
  double from = 0;
  std::int64_t patches = 0;
  for (const Ring& r : rings_) {
    if (!(std::abs(r.lower_deg - from) < 1e-4 && r.upper_deg > r.lower_deg && r.upper_deg <= 90))
      throw Error(
          fmt::format("angle basis '{}': a ring from {} to {} degrees where one from {} on was expected",
                      name_, r.lower_deg, r.upper_deg, from));
    from = r.upper_deg;
    if (r.sectors < 1 || (patches += r.sectors) > max_patches)
      throw Error(fmt::format("angle basis '{}': a ring of {} sectors; expected 1 or more, {} in all", name_,
                              r.sectors, max_patches));
  }
  if (from != 90)
    throw Error(fmt::format("angle basis '{}': its rings end at {} degrees, expected 90", name_, from));
  for (std::size_t i = 0; i < rings_.size(); ++i) {
    const Ring& r = rings_[i];
    first_.push_back(size());
    lower_cos_.push_back(i == 0 ? 1 : cos_deg(r.lower_deg));
    ring_of_.insert(ring_of_.end(), std::size_t(r.sectors), int(i));
    const double c0 = lower_cos_.back(), c1 = cos_deg(r.upper_deg);
    projected_.insert(projected_.end(), std::size_t(r.sectors), pi * (c0 * c0 - c1 * c1) / r.sectors);
  }
  first_.push_back(size());
  lower_cos_.push_back(0);
}

std::span<const KlemsBasis> KlemsBasis::standard() {
  static const std::vector<KlemsBasis> bases = [] {
    const auto rings = [](const std::vector<std::pair<double, int>>& uppers) {
      std::vector<Ring> all;
      double lower = 0;
      for (const auto& [upper, sectors] : uppers) {
        all.push_back({lower, upper, sectors});
        lower = upper;
      }
      return all;
    };
    return std::vector<KlemsBasis>{
        {"LBNL/Klems Full",
         rings({{5, 1}, {15, 8}, {25, 16}, {35, 20}, {45, 24}, {55, 24}, {65, 24}, {75, 16}, {90, 12}})},
        {"LBNL/Klems Half",
         rings({{6.5, 1}, {19.5, 8}, {32.5, 12}, {45.5, 16}, {58.5, 20}, {71.5, 12}, {90, 8}})},
        {"LBNL/Klems Quarter", rings({{9, 1}, {27, 8}, {45, 12}, {63, 12}, {90, 8}})},
        // Radiance's until 2022, release 3.45.
        {"LBNL/Klems Half",
         rings({{6.5, 1}, {19.5, 8}, {32.5, 12}, {46.5, 16}, {61.5, 20}, {76.5, 12}, {90, 4}})}};
  }();
  return bases;
}

int KlemsBasis::patch(const Vec3d& w) const {
  // The last ring whose lower edge is at or above w.
  std::size_t ring = rings_.size() - 1;
  while (ring > 0 && w.z > lower_cos_[ring])
    --ring;
  const int n = rings_[ring].sectors;
  const double turn = std::atan2(w.y, w.x) / (2 * pi);
  const int sector = int(std::floor((turn < 0 ? turn + 1 : turn) * n + 0.5));
  return first_[ring] + (sector >= n || sector < 0 ? 0 : sector);
}

Vec3d KlemsBasis::direction(int patch, const Vec2d& u) const {
  const auto ring = std::size_t(ring_of_[std::size_t(patch)]);
  const double c0 = lower_cos_[ring], c1 = lower_cos_[ring + 1];
  const double cos2 = c0 * c0 + u.x * (c1 * c1 - c0 * c0), sin = std::sqrt(std::max(1 - cos2, 0.0));
  const double phi = 2 * pi * (patch - first_[ring] + u.y - 0.5) / rings_[ring].sectors;
  return {sin * std::cos(phi), sin * std::sin(phi), std::sqrt(cos2)};
}

double KlemsBasis::solid_angle(int patch) const {
  const auto ring = std::size_t(ring_of_[std::size_t(patch)]);
  return 2 * pi * (lower_cos_[ring] - lower_cos_[ring + 1]) / rings_[ring].sectors;
}

} // namespace nacre
