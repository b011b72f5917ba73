#pragma once
// Rough diffuse reflection, the complete fit to V-shaped Lambertian cavities: `oren_nayar` is the simplified
// form that its authors draw from it. Here also the opposite side of the light is darkened, and light bounces
// twice between facets, which saturates the colour. Reciprocal. At grazing angles the fit gains energy, and
// away from the light it turns negative for sigma above about 0.66 rad; there this returns 0. Source: Oren
// and Nayar 1994, Generalization of Lambert's Reflectance Model, section 4.4, "functional approximation".

#include "bsdf/model.h"
#include "core/warp.h"

namespace nacre {

template <class R, int C>
struct OrenNayarFull : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color reflectance;
  R sigma;

  static constexpr std::string_view name = "oren_nayar_full";
  static constexpr std::string_view source = "Oren and Nayar 1994, eq. 27-29";
  static constexpr std::string_view summary = "rough diffuse reflection, V-cavities with interreflection";
  static constexpr Laws laws{.energy_gain = 0.052}; // measured at sigma 0.31, light at the horizon
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&OrenNayarFull::reflectance, "reflectance", "1", 0, 1, 0.5, "albedo of the facets"},
        Parameter{&OrenNayarFull::sigma, "sigma", "rad", 0, 1.5, 0.3,
                  "standard deviation of facet slope angle"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const R co = select(up, wo.z, R(1)), ci = select(up, wi.z, R(1));
    const R so = safe_sqrt(R(R(1) - co * co)), si = safe_sqrt(R(R(1) - ci * ci));
    const R sines = so * si;
    const auto tilted = up & (sines > R(0)); // at the pole every term with the azimuth vanishes
    const R cos_phi =
        clamp(select(tilted, wo.x * wi.x + wo.y * wi.y, R(0)) / select(tilted, sines, R(1)), R(-1), R(1));
    // alpha is the angle nearer to the horizon, beta the other
    const R cos_a = min(co, ci), cos_b = max(co, ci), sin_a = max(so, si), sin_b = min(so, si);
    const R below_a = atan2(cos_a, sin_a), below_b = atan2(cos_b, sin_b); // pi/2 - alpha, pi/2 - beta
    const R a = R(1) - below_a * constant<R>(2 * inv_pi), t = below_b * constant<R>(2 * inv_pi), b = R(1) - t;

    const R s2 = sigma * sigma, rough = s2 / (s2 + R(0.09f));
    const R C1 = R(1) - R(0.5f) * s2 / (s2 + R(0.33f));
    // C2 tan(beta); sin(alpha) - (2 beta / pi)^3 as a difference that stays exact where both are 1
    const R towards = sin_a * sin_b / cos_b;
    const R away = sin_b * (t / cos_b * (R(3) - t * (R(3) - t)) - cos_a * (cos_a / cos_b) / (R(1) + sin_a));
    const R C2 = R(0.45f) * rough * select(cos_phi < R(0), away, towards);
    const R C3 = R(0.125f) * rough * sqr(a * b) * (sin_a + sin_b) / (cos_a + cos_b); // times tan((a + b) / 2)
    const R once = (C1 + cos_phi * C2 + (R(1) - abs(cos_phi)) * C3) * constant<R>(inv_pi);
    const R twice = constant<R>(0.17 * inv_pi) * s2 / (s2 + R(0.13f)) * (R(1) - cos_phi * b * b);
    return select(up,
                  reflectance.map([&](const R& rho) { return R(max(rho * once + rho * rho * twice, R(0))); }),
                  Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return select(same_upper_side(wo, wi), wi.z * constant<R>(inv_pi), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = square_to_cosine_hemisphere(u);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }
};

} // namespace nacre
