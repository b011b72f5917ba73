#pragma once
// Facets in V-shaped grooves whose angles, not slopes, are Gaussian: the physics from which computer graphics
// took its facet models, made to explain that the peak lies beyond the mirror direction. Reciprocal,
// positive, loses the energy of bounces between facets, never gains. Source: Torrance and Sparrow 1967,
// Theory for Off-Specular Reflection from Roughened Surfaces, JOSA 57(9), specular term (c = 1 / m, and b
// such that the projected area of all facets is that of the surface).

#include "bsdf/half_sum.h"
#include "bsdf/v_cavity.h"
#include "core/quadrature.h"
#include "optics/fresnel.h"

namespace nacre {

template <class R, int C>
struct TorranceSparrow : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color eta, k, specular_reflectance;
  R m;

  static constexpr std::string_view name = "torrance_sparrow";
  static constexpr std::string_view source = "Torrance and Sparrow 1967";
  static constexpr std::string_view summary = "facets of Gaussian angle in V-cavities";
  static constexpr auto parameters() {
    using M = TorranceSparrow;
    return std::tuple{Parameter{&M::eta, "eta", "1", 0.01, 20, 1.5, "real part of the facets' index"},
                      Parameter{&M::k, "k", "1", 0, 30, 0.0, "imaginary part of the index, absorption"},
                      Parameter{&M::m, "m", "rad", 1e-3, 1.2, 0.2, "facet angle at which the density is 1/e"},
                      Parameter{&M::specular_reflectance, "specular_reflectance", "1", 0, 1, 1.0,
                                "factor on the reflection; 1 is physical", false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    const R l = sqrt(half.squared()), cos_om = R(0.5f) * l;
    const Vec3<R> wm = half.H / l;
    const R D = gaussian(facet_angle(wm)) / projected_area();
    const R value =
        select(half.valid, R(0.25f) * D * v_cavity_visibility(half.cos_o, half.cos_i, cos_om, wm.z), R(0));
    Color f;
    for (int c = 0; c < C; ++c)
      f[c] = specular_reflectance[c] * fresnel_conductor(cos_om, eta[c], k[c]) * value;
    return f;
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    const R l = sqrt(half.squared());
    const Vec3<R> wm = half.H / l;
    const R angle = facet_angle(wm), s = safe_sqrt(R(sqr(wm.x) + sqr(wm.y)));
    const auto tilted = s > R(1e-4f);
    const R per_sr = select(tilted, angle / select(tilted, s, R(1)), R(1)) * gaussian(angle) *
                     constant<R>(inv_pi) / (m * m * (R(1) - gaussian(constant<R>(pi / 2))));
    return select(half.valid, v_cavity_pdf(per_sr, half.cos_o, R(R(0.5f) * l), wm.z), R(0));
  }
  /// Facet angles of density proportional to angle times Gaussian, then the facet of the groove that is seen.
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const R inside = u.y * (R(1) - gaussian(constant<R>(pi / 2)));
    const R angle = m * safe_sqrt(R(-log(R(1) - inside))), phi = constant<R>(2 * pi) * u.x;
    const Vec3<R> wm{sin(angle) * cos(phi), sin(angle) * sin(phi), cos(angle)};
    const Vec3<R> wi = reflect(wo, v_cavity_facet(wo, wm, u_lobe));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  R gaussian(const R& angle) const { return exp(-sqr(angle / m)); }
  static R facet_angle(const Vec3<R>& wm) { return atan2(safe_sqrt(R(sqr(wm.x) + sqr(wm.y))), wm.z); }
  /// Integral of the Gaussian times cos over the hemisphere, pi m times that of exp(-t^2) sin(2 m t) over t
  /// from 0 to pi / (2 m), where beyond t = 5 nothing is left. 24 nodes: error below 1e-9.
  R projected_area() const {
    static const QuadratureRule rule = gauss_legendre(24, 0, 1);
    const R end = min(constant<R>(pi / 2) / m, R(5));
    R sum(0);
    for (std::size_t i = 0; i < rule.node.size(); ++i) {
      const R t = end * constant<R>(rule.node[i]);
      sum = sum + constant<R>(rule.weight[i]) * exp(-t * t) * sin(R(2) * m * t);
    }
    return constant<R>(pi) * m * end * sum;
  }
};

} // namespace nacre
