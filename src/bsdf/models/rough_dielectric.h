#pragma once
// Ground glass: reflection from and refraction through microfacets that are polished glass. Positive,
// reciprocal with the eta^2 factor of transmission, loses the energy of multiple bounces. Reflection masks
// and shadows with correlated heights; transmission with the product of both G1, as in the source. Source:
// Walter et al. 2007, eq. 20 and 21; visible normals: Heitz 2018, Dupuy and Benyoub 2023.

#include "bsdf/model.h"
#include "optics/fresnel.h"
#include "optics/microfacet.h"

namespace nacre {

template <class R, int C, template <class> class Distribution>
struct RoughDielectric : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  R eta, alpha_x, alpha_y;
  Color specular_reflectance, specular_transmittance;
  R separable;

  static constexpr bool is_ggx = std::is_same_v<Distribution<R>, Ggx<R>>;
  static constexpr std::string_view name = is_ggx ? "ggx_dielectric" : "beckmann_dielectric";
  static constexpr std::string_view source = "Walter et al. 2007, eq. 20, 21; Heitz 2014, eq. 99";
  static constexpr std::string_view summary =
      is_ggx ? "ground glass, GGX facets" : "ground glass, Beckmann facets";
  static constexpr Laws laws{.transmits = true};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&RoughDielectric::eta, "eta", "1", 0.25, 4, 1.5, "index inside / index outside"},
        Parameter{&RoughDielectric::alpha_x, "alpha_x", "1", 1e-3, 1, 0.2, "roughness along the tangent"},
        Parameter{&RoughDielectric::alpha_y, "alpha_y", "1", 1e-3, 1, 0.2, "roughness along the bitangent"},
        Parameter{&RoughDielectric::specular_reflectance, "specular_reflectance", "1", 0, 1, 1.0,
                  "factor on the reflection; 1 is physical", false},
        Parameter{&RoughDielectric::specular_transmittance, "specular_transmittance", "1", 0, 1, 1.0,
                  "factor on the transmission; 1 is physical", false},
        Parameter{&RoughDielectric::separable, "separable", "1", 0, 1, 0.0,
                  "reflection: 0 height-correlated masking-shadowing, 1 product of both", false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const Facet m = facet(wo, wi);
    // eq. 20 and 21 in one, with Smith's G / (cos_o cos_i) = 1 / masking and / eta^2 for radiance
    const Distribution<R> d = distribution();
    const R lo = d.lambda_cos(m.o), li = d.lambda_cos(m.i);
    const R both = select(m.reflected, separable, R(1));
    const R masking = m.o.z * m.i.z + lo * m.i.z + li * m.o.z + both * lo * li;
    const R f = select(m.valid, m.share * (d.D(m.wm) * m.jacobian * sqr(m.n_o) / masking), R(0));
    return select(m.reflected, specular_reflectance, specular_transmittance) * f;
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const Facet m = facet(wo, wi);
    const Distribution<R> d = distribution();
    const R visible = visible_density(d, m.o, R(d.D(m.wm)));
    return select(m.valid, m.share * visible * m.jacobian * sqr(m.n_i), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const R side = select(wo.z < R(0), R(-1), R(1));
    const Distribution<R> d = distribution();
    const Vec3<R> wm = d.sample_visible(wo * side, u) * side; // on wo's side
    const R c = dot(wo, wm);
    const auto fresnel = fresnel_dielectric(c * side, eta);
    const auto reflected = u_lobe < fresnel.reflectance;
    const R inv_eta = R(1) / fresnel.eta_ti;
    const Vec3<R> refracted = wm * (inv_eta * c - abs(fresnel.cos_t)) - wo * inv_eta;
    const Vec3<R> wi = select(reflected, reflect(wo, wm), normalize(refracted));
    // A facet may send light to the side that its lobe does not belong to: no sample.
    const auto right_side = (reflected & (wi.z * wo.z > R(0))) | ((!reflected) & (wi.z * wo.z < R(0)));
    const auto straight = no_interface(), crosses = wo.z != R(0);
    const Color through = specular_transmittance * (R(1) / select(crosses, abs(wo.z), R(1)));
    return {select(straight, -wo, wi),
            select(straight, select(crosses, through, Color()), select(right_side, eval(wo, wi), Color())),
            select(straight, select(crosses, R(1), R(0)), select(right_side, pdf(wo, wi), R(0))), straight};
  }

  /// The microsurface, for the validator and plots.
  Distribution<R> distribution() const { return {alpha_x, alpha_y}; }

private:
  /// Equal indices: there is no surface, light goes straight on as through a delta lobe. No half vector would
  /// be defined, and eval and pdf are 0.
  mask_t<R> no_interface() const { return abs(eta - R(1)) < R(1e-5f); }
  /// The facet that takes wi to wo, in the frame where wo is above the surface. Reflection is refraction
  /// between equal indices: dwm/dwi = n_i^2 |wi . wm| / (n_o wo . wm + n_i wi . wm)^2 (eq. 17) is then
  /// 1 / (4 wo . wm) (eq. 14).
  struct Facet {
    Vec3<R> o, i, wm; ///< wo, wi and the normal mirrored to the upper side
    R n_o, n_i;       ///< indices where wo and wi are
    R share;          ///< F or 1 - F
    R jacobian;       ///< |wo . wm| / n_i^2 dwm/dwi
    mask_t<R> reflected, valid;
  };
  Facet facet(const Vec3<R>& wo_any, const Vec3<R>& wi_any) const {
    const Vec3<R> up{R(0), R(0), R(1)}, down{R(0), R(0), R(-1)};
    const auto usable = (wo_any.z != R(0)) & (wi_any.z != R(0)) & !no_interface();
    const auto inside = wo_any.z < R(0);
    const auto reflected = wo_any.z * wi_any.z > R(0);
    const R side = select(inside, R(-1), R(1));
    const R n_o = select(inside, eta, R(1)), n_t = select(inside, R(1), eta);
    const R n_i = select(reflected, n_o, n_t);
    const Vec3<R> wo = select(usable, wo_any * side, up);
    const Vec3<R> wi = select(usable, wi_any * side, select(reflected, up, down));
    // eq. 13 and 16; the sum in the Jacobian is h . wm, the length of h.
    const Vec3<R> h = wo * n_o + wi * n_i;
    const R l2 = length_squared(h);
    const auto defined = l2 > R(1e-12f);
    const R inv = R(1) / sqrt(select(defined, l2, R(1)));
    const R c_o = dot(wo, h) * inv, c_i = dot(wi, h) * inv;
    // Facets are seen from the side their normal points to.
    const auto facing = (c_o * h.z > R(0)) & (c_i * h.z * wi.z > R(0));
    const R F = dielectric_amplitudes<R>(abs(c_o), n_o, n_t).reflectance();
    return {wo,
            {wi.x, wi.y, abs(wi.z)},
            Vec3<R>{h.x, h.y, abs(h.z)} * inv,
            n_o,
            n_i,
            select(reflected, F, R(1) - F),
            abs(c_o * c_i) * sqr(inv),
            reflected,
            mask_t<R>(usable & defined & facing)};
  }
};

template <class R, int C>
using GgxDielectric = RoughDielectric<R, C, Ggx>;
template <class R, int C>
using BeckmannDielectric = RoughDielectric<R, C, Beckmann>;

} // namespace nacre
