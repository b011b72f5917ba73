#pragma once
// Joint masking and shadowing from the masking of one direction, as G2 / (4 cos_o cos_i): finite at grazing
// angles, where G2 and the cosines vanish together. Compared by Heitz 2014, section 5.3.
//
//   height-correlated        both depend on the facet's height alone: the default, `visibility`
//   separable                independent: `visibility` with separable = 1; too dark
//   direction-correlated     facets seen from above the light are also lit (retroreflection is not shadowed)
//   V-cavity                 grooves of one slope: exact for that surface, brightest at grazing angles

#include "optics/microfacet.h"

namespace nacre {

/// Difference of the azimuths of two directions, in [0, pi]; 0 where one is the normal.
template <class R>
R azimuth_difference(const Vec3<R>& a, const Vec3<R>& b) {
  const R along = a.x * b.x + a.y * b.y, across = abs(a.x * b.y - a.y * b.x);
  const auto defined = (abs(along) + across) > R(1e-30f);
  return atan2(select(defined, across, R(0)), select(defined, along, R(1)));
}

/// Height- and direction-correlated: G2 = 1 / (1 + max(L_o, L_i) + k min(L_o, L_i)) with
/// k = 4.41 phi / (4.41 phi + 1). Source: van Ginneken et al. 1998, Diffuse and Specular Reflectance from
/// Rough Surfaces, eq. 25; Heitz 2014, eq. 101 and 102.
/// @param lo, li  lambda_cos of both directions
/// @param phi     azimuth_difference
template <class R>
R visibility_van_ginneken(const R& lo, const R& li, const R& cos_o, const R& cos_i, const R& phi) {
  const R k = constant<R>(4.41) * phi / (constant<R>(4.41) * phi + R(1));
  const R a = lo * cos_i, b = li * cos_o;
  return R(0.25f) / (cos_o * cos_i + max(a, b) + k * min(a, b));
}

/// Direction-correlated without height: G2 = k G1 G1 + (1 - k) min(G1, G1), k = 1 - exp(-7.3 phi^2).
/// Source: Ashikhmin, Premoze and Shirley 2000, A Microfacet-Based BRDF Generator, section 3.2; constant and
/// form as in Heitz 2014, section 5.3.
template <class R>
R visibility_ashikhmin(const R& lo, const R& li, const R& cos_o, const R& cos_i, const R& phi) {
  const R k = R(1) - exp(constant<R>(-7.3) * phi * phi);
  const R o = R(1) / (cos_o + lo), i = R(1) / (cos_i + li); // G1 / cos
  return R(0.25f) * (k * o * i + (R(1) - k) * min(o / cos_i, i / cos_o));
}

/// Cook-Torrance's: G2 = min(1, 2 cos_m cos_o / (wo . wm), 2 cos_m cos_i / (wo . wm)).
/// Source: Torrance and Sparrow 1967; Cook and Torrance 1982.
/// @param cos_m  of the facet's normal; @param cos_d  wo . wm
template <class R>
R visibility_vcavity(const R& cos_o, const R& cos_i, const R& cos_m, const R& cos_d) {
  const R edge = R(2) * cos_m / max(cos_d, R(1e-12f));
  return R(0.25f) * min(R(1) / (cos_o * cos_i), edge / max(cos_o, cos_i));
}

} // namespace nacre
