#pragma once
// The long-tailed facets of Disney's clearcoat: generalised Trowbridge-Reitz with exponent 1.

#include "core/vec.h"

namespace nacre {

/// Isotropic; no masking function exists for it in closed form, its users borrow GGX's.
/// Source: Burley 2012, Physically-Based Shading at Disney, appendix B, eq. 4 (D) and 5 (sampling).
template <class R>
struct Gtr1 {
  R alpha; ///< in (0, 1)

  R D(const Vec3<R>& wm) const {
    const R a2 = alpha * alpha;
    // 1 + (a2 - 1) cos^2 as a sum of positive terms: the difference leaves no digits in float
    const R t = a2 * wm.z * wm.z + wm.x * wm.x + wm.y * wm.y;
    return (a2 - R(1)) / (constant<R>(pi) * log(a2) * t);
  }
  /// A normal with density D cos.
  Vec3<R> sample_normal(const Vec2<R>& u) const {
    const R a2 = alpha * alpha, phi = constant<R>(2 * pi) * u.x;
    const R sin2 = (pow(a2, R(1) - u.y) - a2) / (R(1) - a2); // 1 - (1 - a2^(1 - u)) / (1 - a2)
    const R s = safe_sqrt(sin2);
    return {s * cos(phi), s * sin(phi), safe_sqrt(R(1) - sin2)};
  }
};

} // namespace nacre
