#include "measured/material_as_measurement.h"

#include "core/error.h"
#include "core/random.h"
#include "measured/rusinkiewicz.h"

#include <algorithm>

namespace nacre {
namespace {

constexpr int n_theta_h = 36, n_theta_d = 18, n_phi_d = 18, n_azimuths = 16;

Vec3d turned(const Vec3d& w, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
}

/// Pairs about the mirror direction as well as anywhere, so that narrow lobes are met.
DirectionPair<double> trial(int n) {
  const auto u = [n](int d) { return unit_double(hash(17, n, d)); };
  const HalfDifference<double> a{pi / 2 * std::pow(u(0), 4.0), pi / 2 * u(1), 2 * pi * u(2)};
  const auto pair = directions(a);
  const double azimuth = 2 * pi * u(3);
  return {turned(pair.wo, azimuth), turned(pair.wi, azimuth)};
}

} // namespace

MaterialAsMeasurement::MaterialAsMeasurement(MaterialSpec material)
    : material_(std::move(material)), bsdf_(make_bsdf<double>(material_)) {
  const auto value = [&](const Vec3d& wo, const Vec3d& wi) {
    const auto f = bsdf_.eval(wo, wi);
    return std::max({f[0], f[1], f[2]});
  };
  bool stochastic = false;
  for (const LobeSpec& lobe : material_.lobes)
    stochastic |= !lobe.measured && model_info(lobe).laws.stochastic;
  for (int n = 0; n < 400; ++n) {
    const auto [o, i] = trial(n);
    if (!(o.z > 0 && i.z > 0)) continue;
    const Vec3d below_o{o.x, o.y, -o.z}, below_i{i.x, i.y, -i.z};
    sides_.reflects_front |= value(o, i) > 0;
    sides_.reflects_back |= value(below_o, below_i) > 0;
    sides_.transmits_to_front |= value(o, below_i) > 0;
    sides_.transmits_to_back |= value(below_o, i) > 0;
    // An estimate differs from itself in other directions: there the claim of isotropy has to be trusted.
    if (stochastic) continue;
    for (const bool through : {false, true}) {
      const Vec3d there = through ? below_i : i;
      const double before = value(o, there), after = value(turned(o, 1 + n), turned(there, 1 + n));
      isotropic_ &= std::abs(after - before) <= 1e-6 * std::max(before, after);
    }
  }
  if (!(sides_.reflects_front || sides_.reflects_back || sides_.transmits()))
    throw Error(material_.name + ": scatters nothing but, perhaps, mirror directions, which no table holds");
}

std::vector<std::pair<std::string, std::string>> MaterialAsMeasurement::facts() const {
  std::vector<std::pair<std::string, std::string>> facts{{"material", material_.name}};
  for (const LobeSpec& lobe : material_.lobes)
    facts.emplace_back("lobe", lobe.is_table() ? lobe.measured->kind() : model_info(lobe).name);
  return facts;
}

const Channels& MaterialAsMeasurement::channels() const {
  static const Channels rgb = Channels::rgb();
  return rgb;
}

bool MaterialAsMeasurement::evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const {
  std::fill_n(f.begin(), 3, 0.0f);
  if (!sides_.contain(wo, wi)) return false;
  const auto value = bsdf_.eval(wo, wi);
  for (int c = 0; c < 3; ++c) {
    if (!std::isfinite(value[c])) {
      std::fill_n(f.begin(), 3, 0.0f);
      return false;
    }
    f[std::size_t(c)] = float(value[c]);
  }
  return true;
}

MeasuredSamples MaterialAsMeasurement::samples() const {
  MeasuredSamples s;
  std::array<float, 3> f;
  const auto add = [&](const Vec3d& wo, const Vec3d& wi, double weight) {
    if (!evaluate(wo, wi, f)) return;
    s.wo.push_back(vec3<float>(wo)), s.wi.push_back(vec3<float>(wi));
    s.f.insert(s.f.end(), f.begin(), f.end());
    s.weight.push_back(weight);
  };
  for (int i = 0; i < n_theta_h; ++i) {
    const auto theta_h = [](double x) { return pi / 2 * sqr(x / n_theta_h); };
    for (int j = 0; j < n_theta_d; ++j) {
      const auto theta_d = [](double x) { return pi / 2 * x / n_theta_d; };
      // dwo dwi = 4 cos theta_d dwh dwd, between the edges of the cell that the sample is the middle of.
      const double weight = (std::cos(theta_h(i)) - std::cos(theta_h(i + 1))) *
                            (sqr(std::sin(theta_d(j + 1))) - sqr(std::sin(theta_d(j))));
      for (int k = 0; k < n_phi_d; ++k)
        for (int t = 0; t < (isotropic_ ? 1 : n_azimuths); ++t) {
          const HalfDifference<double> a{theta_h(i + 0.5), theta_d(j + 0.5), 2 * pi * k / n_phi_d};
          const auto pair = directions(a);
          if (!(pair.wo.z > 0 && pair.wi.z > 0)) continue;
          const Vec3d o = turned(pair.wo, 2 * pi * t / n_azimuths),
                      in = turned(pair.wi, 2 * pi * t / n_azimuths);
          const Vec3d below_o{o.x, o.y, -o.z}, below_i{in.x, in.y, -in.z};
          add(o, in, weight);
          add(below_o, below_i, weight);
          add(o, below_i, weight);
          add(below_o, in, weight);
        }
    }
  }
  return s;
}

std::shared_ptr<const MeasuredBsdf> as_measurement(const MaterialSpec& material) {
  if (material.lobes.size() == 1 && material.lobes[0].is_table() && material.lobes[0].weight == 1)
    return material.lobes[0].measured;
  return std::make_shared<const MaterialAsMeasurement>(material);
}

} // namespace nacre
