#pragma once
// A cosine power of the angle between normal and half vector, in the form of the fits of Ngan et al. The
// highlight stretches towards grazing angles as measured ones do. Reciprocal. Gains energy: the factor
// (n + 2) / (2 pi) normalises a lobe over directions, but the half vector turns half as fast as the
// direction, so a lobe of half vectors covers up to four times the solid angle (Walter 2005, Notes on the
// Ward BRDF, eq. 9: dwi = 4 (wi . h) dwh); the albedo tends to 4 specular_reflectance at normal incidence.
// Source: Blinn 1977, Models of Light Reflection for Computer Synthesized Pictures; Ngan et al. 2005.

#include "bsdf/half_sum.h"
#include "bsdf/power_lobe.h"

namespace nacre {

template <class R, int C>
struct BlinnPhong : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color specular_reflectance;
  R exponent;

  static constexpr std::string_view name = "blinn_phong";
  static constexpr std::string_view source = "Blinn 1977; Ngan et al. 2005";
  static constexpr std::string_view summary = "cosine power of the half vector, as in Ngan's fits";
  static constexpr Laws laws{.energy_gain = 3}; // the limit of large n at specular_reflectance = 1
  static constexpr auto parameters() {
    return std::tuple{Parameter{&BlinnPhong::specular_reflectance, "specular_reflectance", "1", 0, 1, 0.1,
                                "factor on the lobe; about a quarter of the albedo"},
                      Parameter{&BlinnPhong::exponent, "exponent", "1", 1, 2e5, 200, "sharpness n"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    const R f = (exponent + R(2)) * constant<R>(0.5 * inv_pi) * power(half);
    return select(half.valid, specular_reflectance * f, Color());
  }
  /// (n + 1) / (2 pi) cos^n over half vectors, by dwi = 4 (wo . h) dwh.
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    const R over_half_vectors = (exponent + R(1)) * constant<R>(0.5 * inv_pi) * power(half);
    return select(half.valid, over_half_vectors / (R(2) * sqrt(half.squared())), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const PowerLobe<R> normals{{R(0), R(0), R(1)}, exponent};
    const Vec3<R> wi = reflect(wo, normals.sample(u));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  R power(const HalfSum<R>& half) const { return power_of_cosine(half.one_minus_cos_h(), exponent); }
};

} // namespace nacre
