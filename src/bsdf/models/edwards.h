#pragma once
// Half vectors drawn from a disk: the half vector, scaled to end at the height of the view, is projected on
// the surface; there it fills exactly the unit disk about the view's own projection, whatever the view, and
// any density on that disk gives a BRDF that returns all light. Here one round lump (1 - r^2 / R^2)^n about
// the mirror's point. Directional albedo of every view: specular_reflectance, less what the lump holds
// outside the disk; with `confined` the lump shrinks to R <= 1 - sin(theta_o), which sharpens it to a mirror
// at grazing, and nothing is lost. Not reciprocal: view and light are not exchangeable in its construction.
// Source: Edwards et al. 2006, The Halfway Vector Disk for BRDF Modeling, ACM TOG 25(1), scaling projection;
// the lump as in Disney's BRDF Explorer (edwards06).

#include "bsdf/half_sum.h"
#include "bsdf/power_lobe.h"

namespace nacre {

template <class R, int C>
struct Edwards : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color specular_reflectance;
  R exponent, radius, confined;

  static constexpr std::string_view name = "edwards";
  static constexpr std::string_view source = "Edwards et al. 2006";
  static constexpr std::string_view summary = "lump on the disk of half vectors, conserves energy by design";
  static constexpr Laws laws{.reciprocal = false};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&Edwards::specular_reflectance, "specular_reflectance", "1", 0, 1, 0.5,
                  "directional albedo"},
        Parameter{&Edwards::exponent, "exponent", "1", 1, 1e5, 10, "sharpness n of the lump"},
        Parameter{&Edwards::radius, "radius", "1", 0.05, 1, 1.0, "radius R of the lump on the disk"},
        Parameter{&Edwards::confined, "confined", "1", 0, 1, 0.0,
                  "1: the lump stays within the disk and loses nothing, 0: its radius is that of the normal",
                  false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    return select(half.valid, specular_reflectance * (density(half) * (R(1) / half.cos_i)), Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    return select(half.valid, density(half), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const R r = safe_sqrt(one_minus_exp(R(-log(R(1) - u.x) / (exponent + R(1)))));
    const R phi = constant<R>(2 * pi) * u.y, slope = r / slope_scale(max(wo.z, R(1e-9f)));
    const Vec3<R> wi = reflect(wo, normalize(Vec3<R>{slope * cos(phi), slope * sin(phi), R(1)}));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  /// cos_o / R: a half vector of slope s falls at s cos_o / R from the lump's middle, in units of its radius.
  R slope_scale(const R& cos_o) const {
    const R sin_o = safe_sqrt(R((R(1) - cos_o) * (R(1) + cos_o)));
    // cos_o / (1 - sin_o), up to 89.99 degrees; then a lump still sharper would leave the range of float
    const R narrowest = min((R(1) + sin_o) / cos_o, R(1e4f));
    return confined * max(narrowest, cos_o / radius) + (R(1) - confined) * cos_o / radius;
  }
  /// Of wi, 1/sr: the lump's density over slopes, divided by cos^3(theta_h) and by dwi/dwh = 4 (wo . h).
  R density(const HalfSum<R>& half) const {
    const Vec2<R> s = half.slope();
    const R scale = slope_scale(half.cos_o), x = sqr(scale) * (sqr(s.x) + sqr(s.y));
    const R lump = (exponent + R(1)) * constant<R>(inv_pi) * power_of_cosine(x, exponent);
    return R(0.5f) * lump * sqr(scale) * half.squared() / (half.H.z * sqr(half.H.z));
  }
};

} // namespace nacre
