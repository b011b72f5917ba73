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

/// @param cos_i  cosine between the direction and the interface's normal; negative: from inside
/// @param eta    index inside (below the normal) / index outside, > 0
template <class R>
DielectricFresnel<R> fresnel_dielectric(const R& cos_i, const R& eta) {
  const auto outside = cos_i > R(0);
  const R eta_ti = select(outside, eta, R(1) / eta);
  const R ci = abs(cos_i);
  // Snell, as a sum that is exact for equal indices at any angle: there nothing is reflected.
  const R cos2_t = ((eta_ti - R(1)) * (eta_ti + R(1)) + ci * ci) / (eta_ti * eta_ti);
  const R ct = safe_sqrt(cos2_t);
  // Amplitudes perpendicular and parallel; the denominators vanish only at ci = ct = 0, where reflectance
  // is 1.
  const auto total = (cos2_t <= R(0)) | (ci <= R(0));
  const R s_denominator = select(total, R(1), ci + eta_ti * ct);
  const R p_denominator = select(total, R(1), eta_ti * ci + ct);
  const R r_s = (ci - eta_ti * ct) / s_denominator;
  const R r_p = (eta_ti * ci - ct) / p_denominator;
  const R reflectance = select(total, R(1), R(0.5f) * (r_s * r_s + r_p * r_p));
  return {reflectance, select(outside, R(-ct), ct), eta_ti};
}

/// Reflectance of a conductor in air or vacuum, exact.
/// @param cos_i  in [0, 1]
/// @param eta    real part of the complex index relative to the outside, > 0
/// @param k      imaginary part (absorption), >= 0
template <class R>
R fresnel_conductor(const R& cos_i, const R& eta, const R& k) {
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
  return R(0.5f) * (r_s + r_p);
}

/// Schlick 1994, eq. 15, with F90 = 1. Not 0 for F0 = 0: equal indices still reflect (1 - cos)^5.
template <class R>
R fresnel_schlick(const R& cos_i, const R& f0) {
  const R m = clamp(R(1) - cos_i, 0.0f, 1.0f), m2 = m * m;
  return f0 + (R(1) - f0) * (m2 * m2 * m);
}

/// Share of diffuse light that a dielectric sends back to the denser side, inside to outside: the
/// hemispherical average of Fresnel reflectance. Exact.
/// @param eta  index inside / index outside, at least 1.05: nearer to 1 the terms cancel in float
/// Source: Walsh 1926 for the outer side, as given by Duntley 1942, J. Opt. Soc. Am. 32(2), p. 64; the inner
/// side follows from reciprocity, 1 - F_in = (1 - F_out) / eta^2.
template <class R>
R fresnel_dielectric_average_inside(const R& eta) {
  const R n = eta, n2 = n * n, n4 = n2 * n2;
  const R outer = R(0.5f) + (n - 1) * (R(3) * n + 1) / (R(6) * sqr(n + 1)) +
                  n2 * sqr(n2 - 1) / (sqr(n2 + 1) * (n2 + 1)) * log((n - 1) / (n + 1)) -
                  R(2) * n2 * n * (n2 + R(2) * n - 1) / ((n2 + 1) * (n4 - 1)) +
                  R(8) * n4 * (n4 + 1) / ((n2 + 1) * sqr(n4 - 1)) * log(n);
  return R(1) - (R(1) - outer) / n2;
}

} // namespace nacre
