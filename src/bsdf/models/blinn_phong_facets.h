#pragma once
// A rough metal whose facets follow Blinn-Phong's cosine power: the distribution alone, in the microfacet
// equation with Fresnel and Smith masking; not Blinn's shading formula. Close to beckmann_conductor.
// Reciprocal, positive, loses the energy of multiple bounces. Source: Walter et al. 2007, eq. 20, 30.

#include "bsdf/microfacet_reflection.h"
#include "optics/fresnel.h"
#include "optics/ndf_blinn_phong.h"

namespace nacre {

template <class R, int C>
struct BlinnPhongConductor : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color eta, k;
  R alpha_x, alpha_y;
  Color specular_reflectance;
  R separable;
  const MaskingTable<R>* prepared = nullptr;

  static constexpr std::string_view name = "blinn_phong_facets", source = "Walter et al. 2007, eq. 20, 30",
                                    summary = "rough metal, cosine-power facets";
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&BlinnPhongConductor::eta, "eta", "1", 0.01, 20, 1.0, "real part of the complex index"},
        Parameter{&BlinnPhongConductor::k, "k", "1", 0, 30, 6.0, "imaginary part of the index, absorption"},
        Parameter{&BlinnPhongConductor::alpha_x, "alpha_x", "1", 1e-3, 1, 0.2,
                  "roughness along the tangent; exponent n = 2 / (alpha_x alpha_y) - 2"},
        Parameter{&BlinnPhongConductor::alpha_y, "alpha_y", "1", 1e-3, 1, 0.2,
                  "roughness along the bitangent"},
        Parameter{&BlinnPhongConductor::specular_reflectance, "specular_reflectance", "1", 0, 1, 1.0,
                  "factor on the reflection; 1 is physical", false},
        Parameter{&BlinnPhongConductor::separable, "separable", "1", 0, 1, 0.0,
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
  auto distribution() const {
    auto d = blinn_phong_facets(alpha_x, alpha_y);
    d.masking = prepared;
    return d;
  }
  MaskingTable<R> prepare() const { return MaskingTable<R>(distribution().shape); }
};

} // namespace nacre
