#pragma once
// Visible normals of V-cavities: they need only a sampler of normals, whatever the distribution.
//
// Facets come in pairs of opposite slope, and of a pair the view sees each in proportion to its projected
// area: a normal wm drawn with a density q(wm) that is the same for its opposite wm' = (-x, -y, z) is kept
// with probability max(0, wo . wm) / (max(0, wo . wm) + max(0, wo . wm')), else exchanged for wm'. The result
// has the density 2 q (wo . wm) / max(wo . wm, 2 cos_o cos_m), which for q = D cos_m is D (wo . wm) G1 /
// cos_o with the masking of V-cavities. Source: Heitz and d'Eon 2014, Importance Sampling Microfacet-Based
// BSDFs using the Distribution of Visible Normals, section 3.3; masking: Torrance and Sparrow 1967.

#include "core/vec.h"

namespace nacre {

/// The density above divided by wo . wm.
/// @param density  q(wm), per sr
template <class R>
R vcavity_visible_density(const R& density, const Vec3<R>& wo, const Vec3<R>& wm) {
  const R seen = max(dot(wo, wm), R(2) * wo.z * wm.z);
  return select(seen > R(0), R(2) * density / select(seen > R(0), seen, R(1)), R(0));
}

/// Azimuth of the kept slope, in [-pi, pi] about the view's, without a second random number: the choice
/// within the pair makes its density proportional to 1 + tilt cos(phi) where both facets are seen, to 2 where
/// this alone is, to 0 where the other alone is.
/// @param tilt  slope times the tangent of the view's angle, >= 0
template <class R>
R vcavity_visible_azimuth(const R& tilt, const R& u) {
  const auto one_sided = tilt > R(1);
  const R edge = select(one_sided, acos(R(1) / select(one_sided, tilt, R(2))), R(0));
  const R tau = constant<R>(pi) * abs(R(2) * u - R(1)); // distribution function times pi, of |phi|
  const R e = min(tilt, R(1e6f));
  // Kepler's equation phi + e sin(phi) = target beyond the edge, by Newton steps kept within brackets.
  const R target = tau - edge + select(one_sided, safe_sqrt(e * e - R(1)), R(0));
  R lo = edge, hi = constant<R>(pi) - edge, phi = clamp(R(tau / (R(1) + min(e, R(1)))), lo, hi);
  for (int i = 0; i < 10; ++i) {
    const R error = phi + e * sin(phi) - target, slope = R(1) + e * cos(phi);
    lo = select(error > R(0), lo, phi);
    hi = select(error > R(0), phi, hi);
    const R newton = phi - error / select(slope > R(1e-6f), slope, R(1));
    const auto inside = (newton >= lo) & (newton <= hi) & (slope > R(1e-6f));
    phi = select(inside, newton, R(0.5f) * (lo + hi));
  }
  phi = select(one_sided & (tau < R(2) * edge), R(0.5f) * tau, phi);
  return select(u < R(0.5f), -phi, phi);
}

} // namespace nacre
