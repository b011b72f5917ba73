#pragma once
// Whatever distribution of half vectors, with one smooth term for masking and shadowing that has no kink as
// Ashikhmin and Shirley's max(cos_o, cos_i) has: the simplest model that is reciprocal, keeps energy and
// reproduces a measured highlight. Here with an analytic Gaussian distribution of slopes, so that the paper's
// constant c is known: 1/4 for a distribution whose projected area is 1. Positive, never gains, but loses
// light towards grazing angles: a narrow lobe has the albedo F cos / (2 - cos). Source: Ashikhmin and Premoze
// 2007, Distribution-based BRDFs; anisotropic Gaussian: Ashikhmin et al. 2000, A Microfacet-based BRDF
// Generator, section 5, with Beckmann's cos^-4, which makes its integral known.

#include "bsdf/half_sum.h"
#include "bsdf/microfacet_reflection.h"
#include "optics/fresnel.h"

namespace nacre {

template <class R, int C>
struct AshikhminDbrdf : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color f0;
  R alpha_x, alpha_y;

  static constexpr std::string_view name = "ashikhmin_dbrdf";
  static constexpr std::string_view source = "Ashikhmin and Premoze 2007";
  static constexpr std::string_view summary = "distribution of half vectors with one shadowing term for all";
  static constexpr auto parameters() {
    using M = AshikhminDbrdf;
    return std::tuple{
        Parameter{&M::f0, "f0", "1", 0, 1, 0.04, "reflectance of the facets at normal incidence"},
        Parameter{&M::alpha_x, "alpha_x", "1", 1e-3, 1, 0.2, "roughness along the tangent"},
        Parameter{&M::alpha_y, "alpha_y", "1", 1e-3, 1, 0.2, "roughness along the bitangent"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    const R l = sqrt(half.squared()), cos_om = R(0.5f) * l;
    const R masking = half.cos_o + half.cos_i - half.cos_o * half.cos_i;
    const R value = select(half.valid, R(0.25f) * distribution().D(half.H / l) / masking, R(0));
    return f0.map([&](const R& f) { return R(fresnel_schlick(cos_om, f) * value); });
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const { return facet_reflection_pdf(distribution(), wo, wi); }
  /// By Smith's visible normals: the weight f cos / pdf is F cos_i (cos_o + lambda_cos) over the denominator,
  /// at most F.
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = reflect(wo, distribution().sample_visible(wo, u));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  Beckmann<R> distribution() const { return {alpha_x, alpha_y}; }
};

} // namespace nacre
