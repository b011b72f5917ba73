#pragma once
// A rough clear coat over a diffuse base: satin paint, frosted plastic. Reflection from microfacets outside;
// below, all orders of bounces between the Lambertian base and the underside of the coat, each passage
// weighted by the coat's tabulated transmittance. Reciprocal, positive; the reflection loses the energy of
// multiple bounces. Source: Walter et al. 2007, eq. 20; Saunderson 1942.

#include "bsdf/microfacet_reflection.h"
#include "core/warp.h"
#include "optics/fresnel.h"
#include "optics/rough_transmittance.h"

namespace nacre {

template <class R, int C, template <class> class Distribution>
struct RoughPlastic : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color diffuse_reflectance, specular_reflectance;
  R eta, alpha, nonlinear, separable;

  static constexpr bool is_ggx = std::is_same_v<Distribution<R>, Ggx<R>>;
  static constexpr std::string_view name = is_ggx ? "ggx_plastic" : "beckmann_plastic";
  static constexpr std::string_view source = "Walter et al. 2007, eq. 20; Saunderson 1942";
  static constexpr std::string_view summary = is_ggx ? "rough clear coat over a diffuse base, GGX facets"
                                                     : "rough clear coat over a diffuse base, Beckmann";
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&RoughPlastic::diffuse_reflectance, "diffuse_reflectance", "1", 0, 1, 0.5,
                  "albedo of the base"},
        Parameter{&RoughPlastic::specular_reflectance, "specular_reflectance", "1", 0, 1, 1.0,
                  "factor on the coat's reflection; 1 is physical", false},
        Parameter{&RoughPlastic::eta, "eta", "1", 1.05, 2.5, 1.5, "index of the coat / index outside"},
        Parameter{&RoughPlastic::alpha, "alpha", "1", 1e-3, 1, 0.1, "roughness of the coat"},
        Parameter{&RoughPlastic::nonlinear, "nonlinear", "1", 0, 1, 1.0,
                  "1: base colour saturates by bounces below the coat, 0: their colour shift is left out",
                  false},
        Parameter{&RoughPlastic::separable, "separable", "1", 0, 1, 0.0,
                  "0: height-correlated masking-shadowing, 1: product of both", false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto facets = reflect_from_facets(distribution(), wo, wi, separable);
    const R specular = fresnel_dielectric(facets.cos_m, eta).reflectance * facets.value;
    const R passages = transmittance(wo) * transmittance(wi) * constant<R>(inv_pi);
    return select(facets.valid, specular_reflectance * specular + base() * passages, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R p = specular_probability(wo);
    const R diffuse = select(same_upper_side(wo, wi), wi.z * constant<R>(inv_pi), R(0));
    return p * facet_reflection_pdf(distribution(), wo, wi) + (R(1) - p) * diffuse;
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const Vec3<R> mirrored = reflect(wo, distribution().sample_visible(wo, u));
    const Vec3<R> wi = select(u_lobe < specular_probability(wo), mirrored, square_to_cosine_hemisphere(u));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

  /// The microsurface, for the validator and plots.
  Distribution<R> distribution() const { return {alpha, alpha}; }

private:
  R transmittance(const Vec3<R>& w) const {
    return RoughTransmittance::table<Distribution>().outside(max(w.z, R(0)), alpha, eta);
  }
  Color base() const {
    const R inside = RoughTransmittance::table<Distribution>().diffuse_reflectance_inside(alpha, eta);
    const R inv_eta2 = R(1) / (eta * eta);
    return diffuse_reflectance.map(
        [&](const R& d) { return R(d * inv_eta2 / (R(1) - inside * (R(1) + nonlinear * (d - R(1))))); });
  }
  R specular_probability(const Vec3<R>& wo) const {
    const R T = transmittance(wo), specular = (R(1) - T) * average(specular_reflectance);
    const R diffuse = T * average(diffuse_reflectance);
    return specular / max(specular + diffuse, R(1e-6f));
  }
};

template <class R, int C>
using GgxPlastic = RoughPlastic<R, C, Ggx>;
template <class R, int C>
using BeckmannPlastic = RoughPlastic<R, C, Beckmann>;

} // namespace nacre
