#pragma once
// An empirical law of planetary photometry: the limb is darker than Lambert's for k > 1 and brighter for k <
// 1 (the full Moon: about 0.5). Reciprocal. For k < 1 the albedo cos(theta_o)^(k - 1) has no bound at grazing
// angles. Source: Minnaert 1941, The Reciprocity Principle in Lunar Photometry.

#include "bsdf/hemisphere_lobes.h"
#include "bsdf/model.h"

namespace nacre {

template <class R, int C>
struct Minnaert : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color reflectance;
  R k;

  /// Below this cosine the law is held constant, so that what has no bound stays finite.
  static constexpr double least_cosine = 1e-4;

  static constexpr std::string_view name = "minnaert";
  static constexpr std::string_view source = "Minnaert 1941, The Reciprocity Principle in Lunar Photometry";
  static constexpr std::string_view summary = "diffuse reflection with a dark or bright limb";
  static constexpr Laws laws{.energy_gain = 99}; // k = 0.5 at the least cosine: 1e-4^-0.5 - 1
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&Minnaert::reflectance, "reflectance", "1", 0, 1, 0.5, "albedo at the normal"},
        Parameter{&Minnaert::k, "k", "1", 0.5, 3, 1.5, "darkening of the limb; 1 is Lambert"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const R least = constant<R>(least_cosine);
    const R cosines = max(select(up, wo.z, R(1)), least) * max(select(up, wi.z, R(1)), least);
    const R f = (k + R(1)) * constant<R>(0.5 * inv_pi) * pow(cosines, R(k - R(1)));
    return select(up, reflectance * f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return select(same_upper_side(wo, wi), PowerCosine<R>{k}.pdf(wi), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = PowerCosine<R>{k}.sample(u); // in proportion to f cos(theta_i)
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }
};

} // namespace nacre
