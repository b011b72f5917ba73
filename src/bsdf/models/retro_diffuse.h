#pragma once
// Diffuse reflection shaped by roughness at grazing angles: darkened there when smooth, brightened towards
// the light when rough, after slices of measured materials. Reciprocal and empirical. Burley's gains energy
// at grazing angles when rough; Frostbite's is rescaled to keep close to 1. Source: Burley 2012,
// Physically-Based Shading at Disney, section 5.3; Lagarde and de Rousiers 2014, Moving Frostbite to
// Physically Based Rendering, section 3.1.3.

#include "bsdf/model.h"
#include "core/warp.h"

namespace nacre {

template <class R, int C, bool renormalized>
struct RetroDiffuse : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color reflectance;
  R roughness;

  static constexpr std::string_view name = renormalized ? "frostbite_diffuse" : "burley_diffuse";
  static constexpr std::string_view source =
      renormalized ? "Lagarde and de Rousiers 2014, section 3.1.3" : "Burley 2012, section 5.3";
  static constexpr std::string_view summary =
      renormalized ? "diffuse with retro-reflection, rescaled" : "diffuse with retro-reflection";
  // white and fully rough, light and viewer at the horizon: measured 0.558 and 0.0315
  static constexpr Laws laws{.energy_gain = renormalized ? 0.032 : 0.56};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&RetroDiffuse::reflectance, "reflectance", "1", 0, 1, 0.5, "base colour"},
        Parameter{&RetroDiffuse::roughness, "roughness", "1", 0, 1, 0.5,
                  "0 darkens the rim, 1 brightens it towards the light; the square root of GGX's alpha"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const R co = select(up, wo.z, R(1)), ci = select(up, wi.z, R(1));
    const R cos2_d = R(0.5f) * (R(1) + dot(wo, wi)); // half the angle between wo and wi, squared
    const R bias = renormalized ? R(R(0.5f) * roughness) : R(0.5f);
    const R scale = renormalized ? R(R(1) + roughness * constant<R>(1 / 1.51 - 1)) : R(1);
    const R rise = bias + R(2) * roughness * cos2_d - R(1); // F_D90 - 1
    const R f = scale * (R(1) + rise * fifth_power(R(R(1) - co))) * (R(1) + rise * fifth_power(R(R(1) - ci)));
    return select(up, reflectance * (constant<R>(inv_pi) * f), Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return select(same_upper_side(wo, wi), wi.z * constant<R>(inv_pi), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = square_to_cosine_hemisphere(u);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  static R fifth_power(const R& x) { return sqr(x * x) * x; }
};

template <class R, int C>
using BurleyDiffuse = RetroDiffuse<R, C, false>;
template <class R, int C>
using FrostbiteDiffuse = RetroDiffuse<R, C, true>;

} // namespace nacre
