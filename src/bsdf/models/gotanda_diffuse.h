#pragma once
// The diffuse part of a rough dielectric surface: light that a GGX interface lets in, scattered below and let
// out again, fitted to simulation for an index of 1.5. Dark at the rim when smooth, retro-reflective when
// rough. The fit treats light and viewer unequally: not reciprocal. It states the radiance reflected, which
// already contains the cosine of the light; f is that over the cosine.
// Source: Gotanda 2014, Designing Reflectance Models for New Consoles, the improved diffuse fit. Programs
// differ in its last sum: Fr Lm + Vd Bp here; as "Fr Lm + Vd + Bp" a smooth surface would not be isotropic.

#include "bsdf/model.h"
#include "core/warp.h"

namespace nacre {

template <class R, int C>
struct GotandaDiffuse : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color reflectance;
  R alpha, f0;

  static constexpr std::string_view name = "gotanda_diffuse";
  static constexpr std::string_view source = "Gotanda 2014, Designing Reflectance Models for New Consoles";
  static constexpr std::string_view summary = "diffuse light from below a rough dielectric interface";
  static constexpr Laws laws{.reciprocal = false};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&GotandaDiffuse::reflectance, "reflectance", "1", 0, 1, 0.5, "colour below the interface"},
        Parameter{&GotandaDiffuse::alpha, "alpha", "1", 0, 1, 0.3, "GGX roughness of the interface"},
        Parameter{&GotandaDiffuse::f0, "f0", "1", 0, 0.2, 0.04,
                  "reflectance of the interface at normal incidence; the fit was made for 0.04", false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const R co = select(up, wo.z, R(1)), ci = select(up, wi.z, R(1));
    const R a = alpha, a2 = a * a, divisor = a2 + R(1.36053f);
    const R rim_o = max(R(1) - co, R(1e-7f)), rim_i = max(R(1) - ci, R(1e-7f)); // pow wants more than 0
    const R Fr = (R(1) - (R(0.542026f) * a2 + R(0.303573f) * a) / divisor) *
                 (R(1) - pow(rim_o, R(R(5) - R(4) * a2)) / divisor) *
                 (R(1) + a * (R(-1.16402f) + a * (R(1.50912f) - R(0.733996f) * a)) *
                             pow(rim_o, R(R(1) + R(1) / (R(39) * a2 * a2 + R(1)))));
    // Lm and Vd come divided by cos(theta_i)
    const R smooth = max(R(1) - R(2) * a, R(0)) * (R(1) - sqr(rim_i * rim_i) * rim_i);
    const R Lm = (smooth + min(R(2) * a, R(1))) * (R(1) + R(0.5f) * a * (R(1) - ci));
    const R p = (R(1) - R(0.3726732f) * co * co) / (R(0.188566f) + R(0.38841f) * co);
    const auto grazing = ci < R(1e-3f); // the difference has no digits left there
    const R retro = select(grazing, p * (R(1) - R(0.5f) * (p - R(1)) * ci),
                           (R(1) - pow(rim_i, p)) / select(grazing, R(1), ci));
    const R Vd = a2 / ((a2 + R(0.09f)) * (R(1.31072f) + R(0.995584f) * co)) * retro;
    const R c = select(up, wo.x * wi.x + wo.y * wi.y, R(0));
    const R Bp = select(c < R(0), R(1.4f) * co * ci * c, c);
    const R f = constant<R>(21.0 / 20 * inv_pi) * (R(1) - f0) * (Fr * Lm + Vd * Bp);
    return select(up, reflectance * f, Color());
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
