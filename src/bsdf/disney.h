#pragma once
// What the two Disney models share. Source: Burley 2012, Physically-Based Shading at Disney (SIGGRAPH course
// Practical Physically Based Shading in Film and Game Production), and its public disney.brdf.

#include "bsdf/gtr1.h"
#include "bsdf/microfacet_reflection.h"
#include "bsdf/model.h"
#include "optics/microfacet.h"

namespace nacre::disney {

/// Schlick's (1 - cos)^5.
template <class R>
R schlick_weight(const R& cos_theta) {
  const R m = clamp(R(1) - cos_theta, 0.0f, 1.0f), m2 = m * m;
  return m2 * m2 * m;
}

template <class R>
R lerp(const R& a, const R& b, const std::type_identity_t<R>& t) {
  return a + t * (b - a);
}

/// Hue and saturation of a colour: the colour over its approximate luminance, white for black.
template <class R, int C>
Spectrum<R, C> tint(const Spectrum<R, C>& color) {
  R luminance = average(color);
  if constexpr (C == 3)
    luminance = constant<R>(0.3) * color[0] + constant<R>(0.6) * color[1] + constant<R>(0.1) * color[2];
  const auto some = luminance > R(0);
  const R inv = R(1) / select(some, luminance, R(1));
  return select(some, color * inv, Spectrum<R, C>(R(1)));
}
/// 1 + share (tint - 1)
template <class R, int C>
Spectrum<R, C> partly(const R& share, const Spectrum<R, C>& tint) {
  return tint.map([&](const R& t) { return R(R(1) + share * (t - R(1))); });
}

/// Burley 2012, section 5.4: aspect = sqrt(1 - 0.9 anisotropic), roughness squared and stretched by it. The
/// bound 0.001 is that of disney.brdf.
template <class R>
Ggx<R> facets(const R& roughness, const R& anisotropic) {
  const R aspect = sqrt(R(1) - constant<R>(0.9) * anisotropic), alpha = roughness * roughness;
  return {max(alpha / aspect, constant<R>(0.001)), max(alpha * aspect, constant<R>(0.001))};
}

/// The clearcoat: index 1.5, GTR1 facets, masking of GGX with alpha 0.25, scaled by 0.25 (section 5.5: fitted
/// to measured coats, not derived).
template <class R>
struct Clearcoat {
  R weight, gloss;

  R eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto [wm, valid] = UpperHalfVector<R>(wo, wi);
    const Vec3<R> up{R(0), R(0), R(1)};
    const Vec3<R> o = select(valid, wo, up), i = select(valid, wi, up);
    const R F = lerp(constant<R>(0.04), R(1), schlick_weight(dot(o, wm)));
    const R V = R(4) * visibility(Ggx<R>{R(0.25f), R(0.25f)}, o, i, R(1)) * R(0.25f);
    return select(valid, R(0.25f) * weight * F * normals().D(wm) * V, R(0));
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto [wm, valid] = UpperHalfVector<R>(wo, wi);
    const R twice_c = select(valid, length(wo + wi), R(2)); // 2 wo . wm, which may round below 0
    return select(valid, R(0.5f) * normals().D(wm) * wm.z / twice_c, R(0));
  }
  Vec3<R> sample(const Vec3<R>& wo, const Vec2<R>& u) const {
    return reflect(wo, normals().sample_normal(u));
  }
  /// Estimate for the choice of lobes.
  R albedo(const R& cos_o) const {
    return R(0.25f) * weight * lerp(constant<R>(0.04), R(1), schlick_weight(cos_o));
  }

private:
  Gtr1<R> normals() const { return {lerp(constant<R>(0.1), constant<R>(0.001), gloss)}; }
};

} // namespace nacre::disney
