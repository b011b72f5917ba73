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
    const R reflection = m.F * m.D * visibility(m.d, m.o, m.i, separable);
    // eq. 21, with G1 / cos = 1 / (cos + lambda_cos), and / eta^2 for radiance
    const R transmission = (R(1) - m.F) * m.D * m.jacobian * m.cos_om /
                           ((m.o.z + m.d.lambda_cos(m.o)) * (m.i.z + m.d.lambda_cos(m.i)) * sqr(m.eta_ti));
    const Color f =
        select(m.reflected, specular_reflectance * reflection, specular_transmittance * transmission);
    return select(m.valid, f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const Facet m = facet(wo, wi);
    const R visible = visible_density(m.d, m.o, m.D);
    const R p = select(m.reflected, m.F * visible * R(0.25f), (R(1) - m.F) * visible * m.cos_om * m.jacobian);
    return select(m.valid, p, R(0));
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
  /// The facet that takes wi to wo, in the frame where wo is above the surface.
  struct Facet {
    Distribution<R> d;
    Vec3<R> o, i; ///< wo and wi mirrored to the upper side
    R D, F, eta_ti;
    R cos_om;   ///< |wo . wm|
    R jacobian; ///< |wi . wm| eta_ti^2 / (eta_ti wi . wm + wo . wm)^2: dwm/dwi of refraction, eq. 17
    mask_t<R> reflected, valid;
  };
  Facet facet(const Vec3<R>& wo_any, const Vec3<R>& wi_any) const {
    const Vec3<R> up{R(0), R(0), R(1)}, down{R(0), R(0), R(-1)};
    const auto usable = (wo_any.z != R(0)) & (wi_any.z != R(0)) & !no_interface();
    const R side = select(wo_any.z < R(0), R(-1), R(1));
    const R eta_ti = select(wo_any.z < R(0), R(1) / eta, eta);
    const auto reflected = wo_any.z * wi_any.z > R(0);
    const Vec3<R> wo = select(usable, wo_any * side, up);
    const Vec3<R> wi = select(usable, wi_any * side, select(reflected, up, down));
    // eq. 13 and 16
    const Vec3<R> h = select(reflected, wo + wi, wo + wi * eta_ti);
    const R l2 = length_squared(h);
    const auto defined = l2 > R(1e-12f);
    Vec3<R> wm = select(defined, h, up) / sqrt(select(defined, l2, R(1)));
    wm = wm * select(wm.z < R(0), R(-1), R(1));
    const R c_o = dot(wo, wm), c_i = dot(wi, wm);
    const auto fresnel = fresnel_dielectric(c_o * side, eta);
    // Facets are seen from the side their normal points to.
    const auto facing = (c_o > R(0)) & (c_i * wi.z > R(0));
    const R denominator = c_o + eta_ti * c_i;
    const R safe = select(abs(denominator) > R(1e-9f), denominator, R(1));
    const Distribution<R> d = distribution();
    return {d,      wo,       {wi.x, wi.y, abs(wi.z)},       d.D(wm),   fresnel.reflectance,
            eta_ti, abs(c_o), abs(c_i) * sqr(eta_ti / safe), reflected, mask_t<R>(usable & defined & facing)};
  }
};

template <class R, int C>
using GgxDielectric = RoughDielectric<R, C, Ggx>;
template <class R, int C>
using BeckmannDielectric = RoughDielectric<R, C, Beckmann>;

} // namespace nacre
