#pragma once
// Rough diffuse reflection that keeps all energy: Fujii's variant of Oren-Nayar, and what it loses spread
// over the hemisphere so that a white surface stays white at every roughness. Reciprocal; saturates in colour
// as roughness grows. The exact albedo is used, not its polynomial fit. Source: Portsmouth, Kutz and Hill
// 2024, EON: A Practical Energy-Preserving Rough Diffuse BRDF.

#include "bsdf/model.h"
#include "core/warp.h"

namespace nacre {

/// Clipped linearly transformed cosine: the lobe that samples `eon`, in the frame where wo has azimuth 0.
/// Source: Portsmouth et al. 2024, section 4, fitted coefficients of its listing.
template <class R>
struct ClippedTransformedCosine {
  R a, b, c, d; ///< M = (a 0 b; 0 c 0; d 0 1) takes a cosine lobe to the one wanted

  ClippedTransformedCosine(const R& mu, const R& r)
      : a(R(1) + r * (R(0.303392f) + (R(0.111709f) * mu - R(0.518982f)) * mu +
                      (R(0.335918f) * mu - R(0.276266f)) * r)),
        b(r * (R(1.15859f) * mu - R(1.16407f) + (R(0.150815f) - R(0.150105f) * mu) * r) /
          (mu * mu * mu - R(1.43545f))),
        c(R(1) + (R(0.20013f) + (R(0.261777f) * mu - R(0.506373f)) * mu) * r),
        d((R(0.540852f) + (R(0.475392f) * mu - R(1.01625f)) * mu) * r /
          (mu * (R(0.0725628f) + mu) - R(1.0743f))) {}

  /// The part of the unit disk under the cosine lobe whose image lies above the horizon: half of it, and half
  /// of it squeezed by this factor. Its area is pi times the value.
  R share() const { return R(0.5f) + R(0.5f) / sqrt(R(1) + d * d); }
  Vec3<R> sample(const Vec2<R>& u) const {
    const R radius = safe_sqrt(u.x), phi = constant<R>(2 * pi) * u.y, s = share();
    const R y = radius * sin(phi), edge = safe_sqrt(R(R(1) - y * y));
    const R x = -(edge + s * (radius * cos(phi) - edge));
    const R z = safe_sqrt(R(R(1) - x * x - y * y));
    return normalize(Vec3<R>{a * x + b * z, c * y, d * x + z});
  }
  R pdf(const Vec3<R>& w) const {
    const R minor = a - b * d, det = c * minor;
    const Vec3<R> h{c * (w.x - b * w.z), minor * w.y, c * (a * w.z - d * w.x)}; // adj(M) w
    return sqr(det / length_squared(h)) * max(h.z, R(0)) * constant<R>(inv_pi) / share();
  }
};

template <class R, int C>
struct Eon : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color reflectance;
  R roughness;

  static constexpr std::string_view name = "eon";
  static constexpr std::string_view source = "Portsmouth, Kutz and Hill 2024, EON";
  static constexpr std::string_view summary = "rough diffuse reflection that keeps all energy";
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&Eon::reflectance, "reflectance", "1", 0, 1, 0.5, "albedo of the facets"},
        Parameter{&Eon::roughness, "roughness", "1", 0, 1, 0.5, "0 is Lambert, 1 as rough as diffuse gets"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const R co = select(up, wo.z, R(1)), ci = select(up, wi.z, R(1));
    const R s = select(up, wo.x * wi.x + wo.y * wi.y, R(0));
    const R A = R(1) / (R(1) + constant<R>(c1) * roughness);
    const R once = A * (R(1) + roughness * select(s > R(0), s / max(co, ci), s));
    const R mean = A * (R(1) + constant<R>(c2) * roughness);
    // (1 - E(o)) (1 - E(i)) / (1 - mean), with the roughness that all three contain divided out
    const R rest = roughness * A * loss(co) * loss(ci) * constant<R>(1 / (c1 - c2));
    return select(up, reflectance.map([&](const R& rho) {
      const R twice = rho * rho * mean / (R(1) - rho * (R(1) - mean));
      return R(constant<R>(inv_pi) * (rho * once + twice * rest));
    }),
                  Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const R mu = clamp(wo.z, R(0), R(1)), p = flat_probability(mu);
    const Vec3<R> w = turned(wo, select(up, wi, Vec3<R>{R(0), R(0), R(1)}), R(-1));
    const R lobe = ClippedTransformedCosine<R>(mu, roughness).pdf(w);
    return select(up, p * constant<R>(0.5 * inv_pi) + (R(1) - p) * lobe, R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const R mu = clamp(wo.z, R(0), R(1));
    const Vec3<R> lobe = turned(wo, ClippedTransformedCosine<R>(mu, roughness).sample(u), R(1));
    const Vec3<R> wi = select(u_lobe < flat_probability(mu), square_to_hemisphere(u), lobe);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  static constexpr double c1 = 0.5 - 2 / (3 * pi), c2 = 2.0 / 3 - 28 / (15 * pi);

  /// c1 - G / pi; 1 - E = A r times it, E the albedo at facet albedo 1: exact, 0 at grazing.
  static R loss(const R& mu) {
    const R s = safe_sqrt(R(R(1) - mu * mu));
    const R over_mu = mu * (R(1) + s + s * s) / (R(1) + s); // (1 - s^3) / mu
    const R G = s * (atan2(s, mu) - s * mu) + constant<R>(2.0 / 3) * s * (over_mu - R(1));
    return max(constant<R>(c1) - constant<R>(inv_pi) * G, R(0)); // rounding alone takes it below 0
  }
  /// Share of samples spread evenly, which bounds the weights at grazing angles; fitted in the paper.
  R flat_probability(const R& mu) const {
    const auto rough = roughness > R(0);
    const R power = select(rough, pow(select(rough, roughness, R(1)), R(0.1f)), R(0));
    return power * (R(0.162925f) + mu * (R(-0.372058f) + (R(0.538233f) - R(0.290822f) * mu) * mu));
  }
  /// `w` turned about the normal by sign times wo's azimuth.
  static Vec3<R> turned(const Vec3<R>& wo, const Vec3<R>& w, const R& sign) {
    const R s2 = sin2_theta(wo);
    const auto tilted = s2 > R(1e-20f);
    const R inv = R(1) / sqrt(select(tilted, s2, R(1)));
    const R x = select(tilted, wo.x * inv, R(1)), y = sign * select(tilted, wo.y * inv, R(0));
    return {x * w.x - y * w.y, y * w.x + x * w.y, w.z};
  }
};

} // namespace nacre
