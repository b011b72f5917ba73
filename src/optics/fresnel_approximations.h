#pragma once
// Other forms of Fresnel reflectance: Cook and Torrance's exact one, and approximations with the parameters
// that shading languages offer. Reflectances in [0, 1]; cos_i in [0, 1] from the normal.

#include "optics/fresnel.h"

namespace nacre {

/// Exact for dielectrics, in terms of g^2 = eta^2 + cos^2 - 1.
/// @param eta  index of the far side / index of the near side, > 0; 1 at total reflection
/// Source: Cook and Torrance 1982, A Reflectance Model for Computer Graphics, section on the Fresnel term.
template <class R>
R fresnel_cook_torrance(const R& cos_i, const R& eta) {
  const R c = clamp(cos_i, R(0), R(1));
  const R g2 = (eta - R(1)) * (eta + R(1)) + c * c;
  const auto total = (g2 <= R(0)) | (c <= R(0));
  const R g = safe_sqrt(g2), sum = select(total, R(1), g + c), difference = g - c;
  // c (g - c) + 1 is at least 1 - c^2 / 4 for a real g.
  const R p = (c * sum - R(1)) / (c * difference + R(1));
  return select(total, R(1), R(0.5f) * sqr(difference / sum) * (R(1) + p * p));
}

/// Schlick 1994, with reflectance f90 at grazing.
template <class R>
R fresnel_schlick(const R& cos_i, const R& f0, const R& f90) {
  const R m = clamp(R(1) - cos_i, R(0), R(1)), m2 = m * m;
  return f0 + (f90 - f0) * (m2 * m2 * m);
}
/// <F> = 2 int F mu dmu. Exact.
template <class R>
R fresnel_schlick_average(const R& f0, const R& f90 = R(1)) {
  return (R(20) * f0 + f90) * constant<R>(1.0 / 21);
}

/// Schlick with F90 = min(1, 50 F0), so that equal indices reflect nothing: below the 2 % of the rarest solid
/// the grazing reflectance fades. Source: Lagarde and de Rousiers 2014, Moving Frostbite to Physically Based
/// Rendering 3.0, course notes, after Schueler 2009, ShaderX7.
template <class R>
R fresnel_schlick_vanishing(const R& cos_i, const R& f0) {
  return fresnel_schlick(cos_i, f0, min(R(50) * f0, R(1)));
}
/// That for a dielectric from either side: Schlick with the cosine on the rarer side, 1 at total reflection.
/// @param eta  index of the far side / index of the near side, > 0
template <class R>
R fresnel_schlick_dielectric(const R& cos_i, const R& eta) {
  const R c = clamp(cos_i, R(0), R(1));
  const R cos2_t = ((eta - R(1)) * (eta + R(1)) + c * c) / (eta * eta);
  const auto total = (cos2_t <= R(0)) & (eta < R(1));
  const R schlick = fresnel_schlick_vanishing(R(select(eta < R(1), safe_sqrt(cos2_t), c)),
                                              sqr((eta - R(1)) / (eta + R(1))));
  return select(total, R(1), schlick);
}

/// Schlick's curve rescaled to a metal's eta and k, less an error term a cos (1 - cos)^alpha: the dip that
/// metals of high k show before grazing. May leave [0, 1] for a badly chosen a.
/// @param alpha  > 0, real; the dip is deepest at cos = 1 / (alpha + 1)
/// Source: Lazanyi and Szirmay-Kalos 2005, Fresnel Term Approximations for Metals.
template <class R>
R fresnel_lazanyi(const R& cos_i, const R& eta, const R& k, const R& a, const R& alpha) {
  const R c = clamp(cos_i, R(0), R(1)), m = R(1) - c, m2 = m * m, k2 = k * k;
  const R rescaled = (sqr(eta - R(1)) + R(4) * eta * (m2 * m2 * m) + k2) / (sqr(eta + R(1)) + k2);
  const auto off_normal = m > R(0);
  return rescaled - a * c * select(off_normal, pow(select(off_normal, m, R(1)), alpha), R(0));
}

// The angle at which the error term of exponent 6 is deepest, 81.8 degrees: mu = 1 / 7, mu (1 - mu)^6.
inline constexpr double f82_cosine = 1.0 / 7;
inline constexpr double f82_weight = f82_cosine * (46656.0 / 117649);

/// Schlick with its value at 82 degrees given: the error term of Lazanyi and Szirmay-Kalos with exponent 6.
/// May leave [0, 1] for colours no metal has. Source: Hoffman 2019, Fresnel Equations Considered Harmful.
template <class R>
R fresnel_hoffman(const R& cos_i, const R& f0, const R& f82) {
  const R c = clamp(cos_i, R(0), R(1)), m = R(1) - c, m2 = m * m, m5 = m2 * m2 * m;
  const R excess = fresnel_schlick(constant<R>(f82_cosine), f0) - f82;
  return f0 + (R(1) - f0) * m5 - excess * constant<R>(1 / f82_weight) * (c * m5 * m);
}
/// The same with the value at 82 degrees as a factor on Schlick's. In [0, 1] for f0 >= 0.1 and tint >= 0.25;
/// dark tints of dark colours fall below 0, to -0.127 for f0 = tint = 0. Source: Kutz, Hasan, Edmondson 2021,
/// Novel Aspects of the Adobe Standard Material; OpenPBR Surface 1.1, section on metal.
template <class R>
R fresnel_f82_tint(const R& cos_i, const R& f0, const R& tint) {
  return fresnel_hoffman(cos_i, f0, R(tint * fresnel_schlick(constant<R>(f82_cosine), f0)));
}
/// <F> = 2 int F mu dmu of fresnel_f82_tint. Exact: 2 int mu^2 (1 - mu)^6 dmu = 1 / 126.
template <class R>
R fresnel_f82_tint_average(const R& f0, const R& tint) {
  const R excess = fresnel_schlick(constant<R>(f82_cosine), f0) * (R(1) - tint);
  return fresnel_schlick_average(f0) - excess * constant<R>(1 / (126 * f82_weight));
}

/// Complex index of refraction relative to the outside.
template <class R>
struct ComplexIndex {
  R eta, k;
};
/// A metal by the reflectance r at normal incidence and a tint g at the edge, both in [0, 1]: eta runs from
/// the largest value of that reflectance (g = 0, no absorption) to the smallest (g = 1). r stops at 0.999,
/// beyond which eta diverges. Source: Gulbrandsen 2014, Artist Friendly Metallic Fresnel.
template <class R>
struct ArtisticMetal {
  R r, g;
};
template <class R>
ComplexIndex<R> complex_index(const ArtisticMetal<R>& metal) {
  const R r = clamp(metal.r, R(0), constant<R>(0.999)), root = safe_sqrt(r);
  const R low = (R(1) - r) / (R(1) + r), high = (R(1) + root) / (R(1) - root);
  const R eta = metal.g * low + (R(1) - metal.g) * high;
  // r (eta + 1)^2 - (eta - 1)^2 over 1 - r, as a product that is exact at g = 0
  const R k2 = (eta * (root - R(1)) + (root + R(1))) * (eta * (root + R(1)) + (root - R(1))) / (R(1) - r);
  return {eta, safe_sqrt(k2)};
}
/// The inverse; r = 0 has one index alone and gives g = 0.
template <class R>
ArtisticMetal<R> artistic_metal(const ComplexIndex<R>& index) {
  const R r = (sqr(index.eta - R(1)) + sqr(index.k)) / (sqr(index.eta + R(1)) + sqr(index.k));
  const R root = safe_sqrt(r);
  const R low = (R(1) - r) / (R(1) + r), high = (R(1) + root) / (R(1) - root), range = high - low;
  const auto open = range > R(0);
  return {r, select(open, (high - index.eta) / select(open, range, R(1)), R(0))};
}

/// <F> of a dielectric by a published fit, from either side, for any eta: unlike the exact average of
/// fresnel.h it has no cancellation near 1.
/// @param eta  index of the far side / index of the near side; error below 0.007 from
///             1.05 to 3, below 0.001 for their inverses
/// Source: Kulla and Conty 2017, Revisiting Physically Based Shading at Imageworks, course slides.
template <class R>
R fresnel_dielectric_average_fit(const R& eta) {
  const R inside = constant<R>(0.997118) +
                   eta * (constant<R>(0.1014) - eta * (constant<R>(0.965241) + eta * constant<R>(0.130607)));
  const R outside = (eta - R(1)) / (constant<R>(4.08567) + constant<R>(1.00071) * eta);
  return select(eta < R(1), inside, outside);
}

} // namespace nacre
