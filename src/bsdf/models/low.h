#pragma once
// Low et al.'s two fits of glossy paints, plastics and metals with an inverse power lobe (ABC), which falls
// off more slowly than any exponential. low_microfacet is Cook-Torrance's form with ABC facets; low_smooth
// follows the scattering of smooth surfaces, a lobe in the distance of projected directions without cosines
// below. Reciprocal and positive; the amplitude A is free, so neither conserves energy by itself. Source:
// Low, Kronander, Ynnerman and Unger 2012, BRDF Models for Accurate and Efficient Rendering of Glossy
// Surfaces, ACM TOG 31(1), eq. 15 (microfacet) and eq. 10, 12, 14 (smooth).

#include "bsdf/microfacet_reflection.h"
#include "bsdf/projected_disk_lobe.h"
#include "optics/fresnel.h"
#include "optics/masking.h"
#include "optics/ndf_abc.h"

namespace nacre {

/// A S(sqrt(1 - cos_h)) F G / (pi cos_o cos_i), with the pi that the published fits were made with.
template <class R, int C_>
struct LowMicrofacet : ModelBase<R, C_> {
  using typename ModelBase<R, C_>::Color;
  Color A;
  R B, C, eta;

  static constexpr std::string_view name = "low_microfacet", source = "Low et al. 2012, eq. 15",
                                    summary = "glossy reflection, ABC facets in Cook-Torrance's form";
  // A may exceed what the facets' area allows: 1e4 for a lobe as wide as a hemisphere.
  static constexpr Laws laws{.energy_gain = 1e5};
  static constexpr auto parameters() {
    return std::tuple{Parameter{&LowMicrofacet::A, "A", "1", 0, 1e4, 10.0, "amplitude of the lobe"},
                      Parameter{&LowMicrofacet::B, "B", "1", 1, 1e7, 1000.0, "inverse square of its width"},
                      Parameter{&LowMicrofacet::C, "C", "1", 0.01, 3, 1.3, "exponent of its fall"},
                      Parameter{&LowMicrofacet::eta, "eta", "1", 1.01, 100, 1.5, "index, real"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto [wm, valid] = UpperHalfVector<R>(wo, wi);
    const Vec3<R> up{R(0), R(0), R(1)}, o = select(valid, wo, up), i = select(valid, wi, up);
    const R cos_d = R(0.5f) * (dot(o, wm) + dot(i, wm)); // of both: reciprocal to the last digit
    const R F = fresnel_dielectric(cos_d, eta).reflectance;
    const R lobe = distribution().D(wm) * visibility_vcavity(o.z, i.z, wm.z, cos_d);
    return select(valid, A * (lobe * F * constant<R>(4 * inv_pi)), Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const { return facet_reflection_pdf(distribution(), wo, wi); }
  BsdfSample<R, C_> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = reflect(wo, distribution().sample_visible(wo, u));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  auto distribution() const { return abc(R(1), B, C); }
};

/// A S(|D_p|) F(theta_d'), with cos theta_d' from the projected directions as well.
template <class R, int C_>
struct LowSmooth : ModelBase<R, C_> {
  using typename ModelBase<R, C_>::Color;
  Color A;
  R B, C, eta;

  static constexpr std::string_view name = "low_smooth", source = "Low et al. 2012, eq. 12",
                                    summary = "glossy reflection as of a smooth surface, lobe in projection";
  // As for low_microfacet.
  static constexpr Laws laws{.energy_gain = 2e4};
  static constexpr auto parameters() {
    return std::tuple{Parameter{&LowSmooth::A, "A", "1/sr", 0, 5e3, 10.0, "amplitude of the lobe"},
                      Parameter{&LowSmooth::B, "B", "1", 1, 1e7, 1000.0, "inverse square of its width"},
                      Parameter{&LowSmooth::C, "C", "1", 0.01, 3, 1.3, "exponent of its fall"},
                      Parameter{&LowSmooth::eta, "eta", "1", 1.01, 100, 1.5, "index, real"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto valid = same_upper_side(wo, wi);
    const R difference2 = sqr(wo.x - wi.x) + sqr(wo.y - wi.y);
    const R F = fresnel_dielectric(R(safe_sqrt(R(1) - R(0.25f) * difference2)), eta).reflectance; // eq. 14
    return select(valid, A * (lobe().value(wo, wi) * F), Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const { return lobe().pdf(wo, wi); }
  BsdfSample<R, C_> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = lobe().sample(wo, u);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  ProjectedDiskLobe<R> lobe() const { return {B, C}; }
};

} // namespace nacre
