#pragma once
// A rough metal with all bounces among its facets, without noise and at the cost of a table: the light after
// the first bounce comes from the solution of Ambartsumian's invariance equation for GGX facets. Reciprocal;
// white facets lose nothing. The one approximation, ours: what a facet reflects at later bounces. The second
// is taken to turn the light by as much as the first on smooth surfaces, and to meet facets at all angles on
// rough ones, as the further bounces do on all; albedos of metals are within 0.01 of the random walk's.
// Source: Bitterli and d'Eon 2022; Cui et al. 2023 (see optics/smith_invariance.h).

#include "bsdf/microfacet_reflection.h"
#include "core/warp.h"
#include "optics/fresnel.h"
#include "optics/ggx_albedo.h"
#include "optics/smith_invariance.h"

namespace nacre {

template <class R, int C>
struct InvarianceConductor : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color eta, k;
  R alpha;

  static constexpr std::string_view name = "invariance_conductor";
  static constexpr std::string_view source = "Bitterli and d'Eon 2022; Cui et al. 2023";
  static constexpr std::string_view summary = "rough metal, all bounces without noise, GGX facets";
  /// The gain is the error of the table at alpha = 0.002 and 89.9 degrees; below 1e-3 for alpha > 0.015.
  static constexpr Laws laws{.energy_gain = 0.006};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&InvarianceConductor::eta, "eta", "1", 0.01, 20, 1.0, "real part of the complex index"},
        Parameter{&InvarianceConductor::k, "k", "1", 0, 30, 6.0, "imaginary part of the index, absorption"},
        Parameter{&InvarianceConductor::alpha, "alpha", "1", 1e-3, 1, 0.5, "roughness"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto valid = same_upper_side(wo, wi);
    const Vec3<R> up{R(0), R(0), R(1)};
    const Vec3<R> o = select(valid, wo, up), i = select(valid, wi, up);
    const auto facets = reflect_from_facets(distribution(), wo, wi, R(0));
    const auto later = SmithInvariance::table().later_bounces(o, i, alpha);
    const R scale = R(4) * visibility(distribution(), o, i, R(0));
    // Two equal deflections add up to that of wi to wo if their facets are met at 45 degrees and half the
    // difference angle.
    const R sin_d = safe_sqrt(R(1) - min(sqr(facets.cos_m), R(1)));
    const R cos_half = safe_sqrt(R(0.5f) * (R(1) - min(sin_d, R(1))));
    const Color f = zip(eta, k, [&](const R& n, const R& kappa) {
      const R mean = fresnel_conductor_average(n, kappa), even = fresnel_conductor(cos_half, n, kappa);
      const R twice = even * even + alpha * (mean * mean - even * even);
      return R(fresnel_conductor(facets.cos_m, n, kappa) * facets.value +
               later.with_reflectance(twice, mean) * scale);
    });
    return select(valid, f, Color());
  }
  /// A first bounce; for later ones a wider lobe about it and diffuse light, half each.
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R p = single_share(wo), diffuse = select(same_upper_side(wo, wi), wi.z * constant<R>(inv_pi), R(0));
    return p * facet_reflection_pdf(distribution(), wo, wi) +
           R(0.5f) * (R(1) - p) * (facet_reflection_pdf(wider(), wo, wi) + diffuse);
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const R p = single_share(wo);
    const R a = select(u_lobe < p, alpha, wider().alpha_x);
    const Vec3<R> mirrored = reflect(wo, Ggx<R>{a, a}.sample_visible(wo, u));
    const Vec3<R> wi = select(u_lobe < R(0.5f) * (R(1) + p), mirrored, square_to_cosine_hemisphere(u));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

  /// The microsurface, for the validator and plots.
  Ggx<R> distribution() const { return {alpha, alpha}; }

private:
  /// No narrower than the cells of the table of later bounces.
  Ggx<R> wider() const { return {max(alpha, R(0.2f)), max(alpha, R(0.2f))}; }
  R single_share(const Vec3<R>& wo) const { return GgxAlbedo::table().perfect(R(max(wo.z, R(0))), alpha); }
};

} // namespace nacre
