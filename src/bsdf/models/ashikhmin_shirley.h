#pragma once
// An anisotropic Phong lobe of half vectors with Fresnel's rise towards grazing angles, built to be
// reciprocal, to keep energy and to be sampled exactly. Its denominator with max(cos_o, cos_i) has a kink
// where both are equal, and loses energy towards grazing angles. Positive, reciprocal, never gains. With
// ashikhmin_shirley_diffuse of the same f0 it is the whole model of the paper. Source: Ashikhmin and Shirley
// 2000, An Anisotropic Phong BRDF Model, J. Graphics Tools 5(2), eq. 4 (specular), 6, 9, 10 (sampling).

#include "bsdf/facet_fresnel.h"
#include "bsdf/half_sum.h"
#include "bsdf/power_lobe.h"
#include "bsdf/v_cavity.h"

namespace nacre {

template <class R, int C, template <class> class Fresnel>
struct AshikhminShirleyLobe : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color fresnel, specular_reflectance;
  R n_u, n_v;

  using Facet = Fresnel<R>;
  static constexpr std::string_view name = Facet::is_exact ? "ashikhmin_shirley_exact" : "ashikhmin_shirley";
  static constexpr std::string_view source = Facet::is_exact
                                                 ? "Ashikhmin and Shirley 2000, eq. 4; Loew et al. 2012"
                                                 : "Ashikhmin and Shirley 2000, eq. 4";
  static constexpr std::string_view summary =
      Facet::is_exact ? "anisotropic Phong lobe of half vectors with Fresnel's equations"
                      : "anisotropic Phong lobe of half vectors, Schlick's Fresnel term";
  // At specular_reflectance = 2, which published fits reach; at 1 the albedo is at most 1.
  static constexpr Laws laws{.energy_gain = 1};
  static constexpr auto parameters() {
    using M = AshikhminShirleyLobe;
    return std::tuple{
        Parameter{&M::fresnel, Facet::parameter, "1", Facet::lo, Facet::hi, Facet::initial, Facet::meaning},
        Parameter{&M::n_u, "n_u", "1", 1e-3, 1e6, 100, "sharpness along the tangent"},
        Parameter{&M::n_v, "n_v", "1", 1e-3, 1e6, 100, "sharpness along the bitangent"},
        Parameter{&M::specular_reflectance, "specular_reflectance", "1", 0, 2, 1.0,
                  "factor on the reflection; 1 is the paper's", false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    const R l = sqrt(half.squared()), cos_om = R(0.5f) * l;
    const R value = density(half.H / l) / (R(4) * cos_om * max(half.cos_o, half.cos_i)); // eq. 4
    Color f;
    for (int c = 0; c < C; ++c)
      f[c] = specular_reflectance[c] * Facet::reflectance(cos_om, fresnel[c]) * value;
    return select(half.valid, f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    const R l = sqrt(half.squared());
    const Vec3<R> wm = half.H / l;
    return select(half.valid, v_cavity_pdf(density(wm), half.cos_o, R(R(0.5f) * l), wm.z), R(0));
  }
  /// Half vectors by eq. 9 and 10, which give each azimuth its own exponent. The density is the same at wm
  /// and at its mirror image about the normal, so the one turned away from wo, from which the paper's sampler
  /// gets no light, is exchanged for the other. The weight f cos / pdf is at most F.
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const R phi = constant<R>(2 * pi) * u.x;
    const R x = cos(phi) * sqrt(n_v + R(1)), y = sin(phi) * sqrt(n_u + R(1)), inv = R(1) / (x * x + y * y);
    const R n = (n_u * x * x + n_v * y * y) * inv;
    const R log_cos = log(R(1) - u.y) / (n + R(1));
    const R s = safe_sqrt(R(one_minus_exp(R(R(-2) * log_cos)) * inv));
    const Vec3<R> wi = reflect(wo, v_cavity_facet(wo, {s * x, s * y, exp(log_cos)}, u_lobe));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  /// Of half vectors, 1/sr, eq. 6: cos theta to the power (n_u x^2 + n_v y^2) / sin^2 theta, normalised.
  R density(const Vec3<R>& wm) const {
    const R sin2 = sqr(wm.x) + sqr(wm.y), drop = sin2 / (R(1) + wm.z);
    const auto tilted = sin2 > R(1e-12f);
    const R slope = select(tilted, log_one_minus(drop) / select(tilted, sin2, R(1)), R(-0.5f));
    const R norm = sqrt((n_u + R(1)) * (n_v + R(1))) * constant<R>(0.5 * inv_pi);
    return norm * exp(slope * (n_u * sqr(wm.x) + n_v * sqr(wm.y)));
  }
};

template <class R, int C>
using AshikhminShirley = AshikhminShirleyLobe<R, C, SchlickFacet>;
template <class R, int C>
using AshikhminShirleyExact = AshikhminShirleyLobe<R, C, ExactFacet>;

} // namespace nacre
