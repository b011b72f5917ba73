#pragma once
// The half vectors of a direction of view as a rectangle: where densities and integrals of reflectance are
// tabulated.

#include "core/pack.h"
#include "core/vec.h"
#include "measured/rusinkiewicz.h"

namespace nacre {

/// The half vectors that reflect wo to somewhere above the surface, as a rectangle. A half vector has angle
/// theta in [0, theta_max) to the normal and azimuth phi_max(theta) v, v in (-1, 1), from wo's. A density on
/// the rectangle loses nothing below the horizon. R = float, double or Pack; wo.z > 0.
template <class R>
struct HalfVectorChart {
  R theta_o, cos_o;

  explicit HalfVectorChart(const Vec3<R>& wo)
      : theta_o(angle_of(R(sqrt(wo.x * wo.x + wo.y * wo.y)), wo.z)), cos_o(wo.z) {}

  R theta_max() const { return constant<R>(pi / 4) + theta_o * R(0.5f); }
  /// wi = reflect(wo, wh) has wi.z = 0 where cos phi = -cot theta_o cot 2 theta. As an arc tangent, whose
  /// square root is 0 where every azimuth or none is above the horizon.
  R phi_max(const R& theta) const {
    const R twice = theta + theta;
    const R root = safe_sqrt(R(-cos(twice + theta_o) * cos(twice - theta_o)));
    return max(angle_of(R(root + R(1e-30f)), R(-cos_o * cos(twice))), R(1e-6f)); // + : never both 0
  }
  /// Cosine and sine of wo's azimuth; (1, 0) for wo on the normal.
  static Vec2<R> azimuth(const Vec3<R>& wo) {
    const R r2 = wo.x * wo.x + wo.y * wo.y;
    const auto on_normal = r2 < R(1e-24f);
    const R inv = R(1) / sqrt(select(on_normal, R(1), r2));
    return {select(on_normal, R(1), wo.x * inv), select(on_normal, R(0), wo.y * inv)};
  }
};

/// sin^2(b / 2) - sin^2(a / 2) without cancellation: half the solid angle between two polar angles, over 2
/// pi.
template <class R>
R half_versine_between(const R& a, const R& b) {
  return sin((a + b) * R(0.5f)) * sin((b - a) * R(0.5f));
}

} // namespace nacre
