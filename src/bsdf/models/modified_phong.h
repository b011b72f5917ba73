#pragma once
// Phong's lobe made plausible: a BRDF itself, not a shade, and normalised so that the albedo at normal
// incidence is specular_reflectance. Reciprocal, conserves energy; loses light towards grazing angles, where
// half of the lobe lies below the horizon. Its round highlight does not stretch there as real ones do.
// Source: Lafortune and Willems 1994, Using the Modified Phong Reflectance Model for Physically Based
// Rendering, CW 197, section 2.

#include "bsdf/power_lobe.h"

namespace nacre {

template <class R, int C>
struct ModifiedPhong : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color specular_reflectance;
  R exponent;

  static constexpr std::string_view name = "modified_phong";
  static constexpr std::string_view source = "Lafortune and Willems 1994";
  static constexpr std::string_view summary = "normalised cosine power about the mirror direction";
  static constexpr auto parameters() {
    return std::tuple{Parameter{&ModifiedPhong::specular_reflectance, "specular_reflectance", "1", 0, 1, 0.5,
                                "albedo at normal incidence"},
                      Parameter{&ModifiedPhong::exponent, "exponent", "1", 1, 2e5, 50, "sharpness n"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R f = (exponent + R(2)) * constant<R>(0.5 * inv_pi) * lobe(wo).value(wi);
    return select(same_upper_side(wo, wi), specular_reflectance * f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return select(same_upper_side(wo, wi), lobe(wo).density(wi), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = lobe(wo).sample(u);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  PowerLobe<R> lobe(const Vec3<R>& wo) const { return {mirrored(wo), exponent}; }
};

} // namespace nacre
