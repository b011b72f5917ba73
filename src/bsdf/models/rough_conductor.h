#pragma once
// A rough metal: single reflection from microfacets that are polished metal. Reciprocal, positive, loses the
// energy of multiple bounces (up to half at alpha = 1), never gains. Source: Walter et al. 2007, Microfacet
// Models for Refraction through Rough Surfaces, eq. 20; masking: Heitz 2014.

#include "bsdf/microfacet_reflection.h"
#include "optics/fresnel.h"

namespace nacre {

template <class R, int C, template <class> class Distribution>
struct RoughConductor : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color eta, k;
  R alpha_x, alpha_y;
  Color specular_reflectance;
  R separable;

  static constexpr bool is_ggx = std::is_same_v<Distribution<R>, Ggx<R>>;
  static constexpr std::string_view name = is_ggx ? "ggx_conductor" : "beckmann_conductor";
  static constexpr std::string_view source = "Walter et al. 2007, eq. 20; Heitz 2014, eq. 99";
  static constexpr std::string_view summary =
      is_ggx ? "rough metal, GGX facets" : "rough metal, Beckmann facets";
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&RoughConductor::eta, "eta", "1", 0.01, 20, 1.0, "real part of the complex index"},
        Parameter{&RoughConductor::k, "k", "1", 0, 30, 6.0, "imaginary part of the index, absorption"},
        Parameter{&RoughConductor::alpha_x, "alpha_x", "1", 1e-3, 1, 0.2, "roughness along the tangent"},
        Parameter{&RoughConductor::alpha_y, "alpha_y", "1", 1e-3, 1, 0.2, "roughness along the bitangent"},
        Parameter{&RoughConductor::specular_reflectance, "specular_reflectance", "1", 0, 1, 1.0,
                  "factor on the reflection; 1 is physical", false},
        Parameter{&RoughConductor::separable, "separable", "1", 0, 1, 0.0,
                  "0: height-correlated masking-shadowing, 1: product of both", false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto facets = reflect_from_facets(distribution(), wo, wi, separable);
    Color f;
    for (int i = 0; i < C; ++i)
      f[i] = specular_reflectance[i] * fresnel_conductor(facets.cos_m, eta[i], k[i]) * facets.value;
    return f;
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const { return facet_reflection_pdf(distribution(), wo, wi); }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = reflect(wo, distribution().sample_visible(wo, u));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

  /// The microsurface, for the validator and plots.
  Distribution<R> distribution() const { return {alpha_x, alpha_y}; }
};

template <class R, int C>
using GgxConductor = RoughConductor<R, C, Ggx>;
template <class R, int C>
using BeckmannConductor = RoughConductor<R, C, Beckmann>;

} // namespace nacre
