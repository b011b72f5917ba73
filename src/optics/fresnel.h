#pragma once
// Fresnel's equations: the share of unpolarised light that a smooth interface reflects.
// Source: Born and Wolf, Principles of Optics, 7th ed., section 1.5.2 (dielectrics) and 14.2 (conductors).

#include "core/number.h"

namespace nacre {

/// Reflectance of a dielectric and the refracted ray's geometry.
template <class R>
struct DielectricFresnel {
  R reflectance; ///< unpolarised, in [0, 1]; 1 at total internal reflection
  R cos_t;       ///< cosine of the refracted direction, on the other side: its sign is opposite to cos_i's
  R eta_ti;      ///< index on the refracted side / index on the incident side
};

/// Share reflected of light polarised perpendicular (s) and parallel (p) to the plane of incidence.
template <class R>
struct PolarizedReflectance {
  R s, p;
  R unpolarized() const { return R(0.5f) * (s + p); }
};

/// Amplitudes that a dielectric reflects, real below the angle of total reflection. Phases beyond it:
/// fresnel_amplitudes.h.
template <class R>
struct DielectricAmplitudes {
  R s, p;          ///< finite and without meaning where `total`; r_p = -r_s at normal incidence
  mask_t<R> total; ///< total internal reflection, or grazing by less than 1e-9
  R t;             ///< cosine of the refracted direction, >= 0, times its index
  R reflectance() const { return select(total, R(1), R(0.5f) * (s * s + p * p)); }
};

/// @param c_i       cosine between the direction and the interface's normal, >= 0
/// @param n_i, n_t  index on the side of the direction and on the other
/// Source: Born and Wolf, eq. 1.5.21, with one division for both.
template <class R>
inline DielectricAmplitudes<R> dielectric_amplitudes(const R& c_i, const R& n_i, const R& n_t) {
  // Snell, as a sum that is exact for equal indices at any angle: there nothing is reflected.
  const R i = n_i * c_i, t2 = (n_t - n_i) * (n_t + n_i) + i * i, t = safe_sqrt(t2);
  const mask_t<R> total((t2 <= R(0)) | (c_i < R(1e-9f)));
  // The parallel amplitude's terms are multiplied by n_t.
  const R i_p = n_t * n_t * c_i, t_p = n_i * t, s = i + t, p = i_p + t_p;
  const R inv = R(1) / select(total, R(1), s * p);
  return {(i - t) * p * inv, (i_p - t_p) * s * inv, total, t};
}

/// @param cos_i  cosine between the direction and the interface's normal; negative: from inside
/// @param eta    index inside (below the normal) / index outside, > 0
template <class R>
inline DielectricAmplitudes<R> dielectric_amplitudes(const R& cos_i, const R& eta) {
  const auto outside = cos_i > R(0);
  return dielectric_amplitudes<R>(abs(cos_i), select(outside, R(1), eta), select(outside, eta, R(1)));
}

/// @param cos_i, eta  as in dielectric_amplitudes
template <class R>
inline DielectricFresnel<R> fresnel_dielectric(const R& cos_i, const R& eta) {
  const auto outside = cos_i > R(0);
  const auto r = dielectric_amplitudes(cos_i, eta);
  return {r.reflectance(), select(outside, -r.t / eta, r.t), select(outside, eta, R(1) / eta)};
}
template <class R>
PolarizedReflectance<R> fresnel_dielectric_polarized(const R& cos_i, const R& eta) {
  const auto r = dielectric_amplitudes(cos_i, eta);
  return {select(r.total, R(1), r.s * r.s), select(r.total, R(1), r.p * r.p)};
}

/// Reflectance of a conductor, exact. Seen from inside a dielectric: divide eta and k by the dielectric's
/// index.
/// @param cos_i  in [0, 1]
/// @param eta    real part of the complex index relative to the outside, > 0
/// @param k      imaginary part (absorption) relative to the outside, >= 0
template <class R>
inline PolarizedReflectance<R> fresnel_conductor_polarized(const R& cos_i, const R& eta, const R& k) {
  const R c = clamp(cos_i, 0.0f, 1.0f), c2 = c * c, s2 = R(1) - c2;
  // a + ib is the complex cosine of refraction times the index: (a + ib)^2 = (eta + ik)^2 - s2 = t + 2i ab.
  // The larger of a and b from a sum of one sign, the other from their product: for a good metal a is much
  // the smaller, and its difference would leave no digits in float.
  const R t = (eta - R(1)) * (eta + R(1)) - k * k + c2, ab = eta * k;
  const R larger = safe_sqrt(R(0.5f) * (safe_sqrt(t * t + R(4) * ab * ab) + abs(t)));
  const R smaller = ab / select(larger > R(0), larger, R(1));
  const auto transparent = t > R(0);
  const R a = select(transparent, larger, smaller), b = select(transparent, smaller, larger);
  const R b2 = b * b, s_denominator = sqr(a + c) + b2; // 0 for equal indices at c = 0 alone
  const R r_s = (sqr(a - c) + b2) / select(s_denominator > R(0), s_denominator, R(1));
  const R r_p = r_s * (sqr(a * c - s2) + b2 * c2) / (sqr(a * c + s2) + b2 * c2);
  return {r_s, r_p};
}
template <class R>
inline R fresnel_conductor(const R& cos_i, const R& eta, const R& k) {
  return fresnel_conductor_polarized(cos_i, eta, k).unpolarized();
}

/// Schlick 1994, eq. 15, with F90 = 1. Not 0 for F0 = 0: equal indices still reflect (1 - cos)^5.
template <class R>
R fresnel_schlick(const R& cos_i, const R& f0) {
  const R m = clamp(R(1) - cos_i, 0.0f, 1.0f), m2 = m * m;
  return f0 + (R(1) - f0) * (m2 * m2 * m);
}

/// Share of diffuse light that a dielectric reflects when it comes from the rarer side: the hemispherical
/// average 2 int F(mu) mu dmu. Exact.
/// @param eta  index of the denser side / index of the rarer side, at least 1.05: nearer to 1 the terms
///             cancel in float
/// Source: Walsh 1926, as given by Duntley 1942, J. Opt. Soc. Am. 32(2), p. 64.
template <class R>
R fresnel_dielectric_average_outside(const R& eta) {
  const R n = eta, n2 = n * n, n4 = n2 * n2;
  return R(0.5f) + (n - 1) * (R(3) * n + 1) / (R(6) * sqr(n + 1)) +
         n2 * sqr(n2 - 1) / (sqr(n2 + 1) * (n2 + 1)) * log((n - 1) / (n + 1)) -
         R(2) * n2 * n * (n2 + R(2) * n - 1) / ((n2 + 1) * (n4 - 1)) +
         R(8) * n4 * (n4 + 1) / ((n2 + 1) * sqr(n4 - 1)) * log(n);
}
/// The same from the denser side, inside to outside; total internal reflection included. Exact: by
/// reciprocity 1 - F_in = (1 - F_out) / eta^2.
template <class R>
R fresnel_dielectric_average_inside(const R& eta) {
  return R(1) - (R(1) - fresnel_dielectric_average_outside(eta)) / (eta * eta);
}

/// Hemispherical average 2 int F(mu) mu dmu of any Fresnel function of mu by Gauss-Legendre in sqrt(mu),
/// which crowds nodes at grazing. Error below 1e-4 for metals of eta in [0.05, 5], k in [1, 10] and for
/// dielectrics of eta in [1.1, 3] from outside; do not use it across a critical angle.
/// Nodes: Abramowitz and Stegun 1964, table 25.4, n = 8.
template <class R, class F>
R fresnel_average(F&& fresnel) {
  constexpr double node[] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
  constexpr double weight[] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                               0.1012285362903763};
  R sum = R(0);
  for (int i = 0; i < 4; ++i)
    for (const double sign : {-1.0, 1.0}) {
      const double x = 0.5 + 0.5 * sign * node[i];
      sum = sum + constant<R>(2 * weight[i] * x * x * x) * fresnel(constant<R>(x * x));
    }
  return sum;
}
/// Of a metal; eta and k as in fresnel_conductor.
template <class R>
R fresnel_conductor_average(const R& eta, const R& k) {
  return fresnel_average<R>([&](const R& mu) { return fresnel_conductor(mu, eta, k); });
}

} // namespace nacre
