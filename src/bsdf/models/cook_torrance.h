#pragma once
// Gaussian facets in V-shaped grooves: the first reflectance model from optics that computer graphics took
// up, with colours that shift towards the light's at grazing angles. Reciprocal, positive. As published in
// 1982 it reflects four times the light that there is, since D there lacks the 1/4 of the Jacobian and has 1
// as its projected area only after division by pi; `divisor` = 4 keeps energy (that is the 4 in D of the 1981
// version of the paper), pi is what Ngan et al. 2005 fitted. Energy of bounces between the facets is lost.
// Source: Cook and Torrance 1982, A Reflectance Model for Computer Graphics, ACM TOG 1(1), p. 10 (R_s), p. 11
// (D, G).

#include "bsdf/facet_fresnel.h"
#include "bsdf/half_sum.h"
#include "bsdf/v_cavity.h"
#include "optics/microfacet.h"

namespace nacre {

template <class R, int C, template <class> class Fresnel>
struct CookTorranceFacets : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color fresnel, specular_reflectance;
  R m, divisor;

  using Facet = Fresnel<R>;
  static constexpr std::string_view name = Facet::is_exact ? "cook_torrance" : "cook_torrance_schlick";
  static constexpr std::string_view source = Facet::is_exact
                                                 ? "Cook and Torrance 1982, p. 10"
                                                 : "Cook and Torrance 1982, p. 10; Schlick 1994, eq. 15";
  static constexpr std::string_view summary =
      Facet::is_exact ? "Beckmann facets in V-cavities, as published"
                      : "Beckmann facets in V-cavities with Schlick's Fresnel term";
  // 4 / divisor times what a surface of mirrors in V-cavities reflects, which tends to 1 for small m.
  static constexpr Laws laws{.energy_gain = 3};
  static constexpr auto parameters() {
    using M = CookTorranceFacets;
    return std::tuple{
        Parameter{&M::fresnel, Facet::parameter, "1", Facet::lo, Facet::hi, Facet::initial, Facet::meaning},
        Parameter{&M::m, "m", "1", 1e-3, 2.5, 0.2, "RMS slope of the facets"},
        Parameter{&M::specular_reflectance, "specular_reflectance", "1", 0, 1, 1.0,
                  "factor on the reflection; 1 is physical", false},
        Parameter{&M::divisor, "divisor", "1", 1, 4, 1.0,
                  "f = F D G / (divisor cos cos); 1: the paper's, pi: Ngan's fits, 4: keeps energy", false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    const R l = sqrt(half.squared()), cos_om = R(0.5f) * l;
    const Vec3<R> wm = half.H / l;
    const R value =
        distribution().D(wm) * v_cavity_visibility(half.cos_o, half.cos_i, cos_om, wm.z) / divisor;
    const R seen = select(half.valid, value, R(0));
    Color f;
    for (int c = 0; c < C; ++c)
      f[c] = specular_reflectance[c] * Facet::reflectance(cos_om, fresnel[c]) * seen;
    return f;
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    const R l = sqrt(half.squared()), cos_om = R(0.5f) * l;
    const Vec3<R> wm = half.H / l;
    return select(half.valid, v_cavity_pdf(R(distribution().D(wm) * wm.z), half.cos_o, cos_om, wm.z), R(0));
  }
  /// Normals of density D cos_m, then the facet of the groove that is seen.
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const R slope = m * safe_sqrt(R(-log(R(1) - u.y))), phi = constant<R>(2 * pi) * u.x;
    const Vec3<R> wm = normalize(Vec3<R>{slope * cos(phi), slope * sin(phi), R(1)});
    const Vec3<R> wi = reflect(wo, v_cavity_facet(wo, wm, u_lobe));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

  /// The microsurface, for the validator and plots.
  Beckmann<R> distribution() const { return {m, m}; }
  R masking(const Vec3<R>& w, const Vec3<R>& wm) const { return v_cavity_masking(w, wm); }
  R masking_shadowing(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    const R l = sqrt(half.squared());
    return half.cos_o * half.cos_i *
           v_cavity_visibility(half.cos_o, half.cos_i, R(R(0.5f) * l), R(half.H.z / l));
  }
};

template <class R, int C>
using CookTorrance = CookTorranceFacets<R, C, ExactFacet>;
template <class R, int C>
using CookTorranceSchlick = CookTorranceFacets<R, C, SchlickFacet>;

} // namespace nacre
