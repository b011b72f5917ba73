#pragma once
// Lobes that depend on the distance of wi's projection onto the surface from the mirror direction's, as those
// of diffraction: an inverse power of it, sampled exactly.

#include "bsdf/model.h"
#include "optics/stable_functions.h"

namespace nacre {

/// (1 + B d^2)^-C with d = |projection of wo + wi|. B > 0, C >= 0.
/// Sampled are the distance, by inverting the power's integral, and of its circle the arc within the unit
/// disk: no sample is lost at the horizon. Source: Holzschuch and Pacanowski 2017, section 4.6, for any C;
/// the arc's share, there a weight, belongs to the density.
template <class R>
struct ProjectedDiskLobe {
  R B, C;

  R value(const Vec3<R>& wo, const Vec3<R>& wi) const { return power(distance2(wo, wi)); }

  Vec3<R> sample(const Vec3<R>& wo, const Vec2<R>& u) const {
    const R range = log_range(wo);
    const R v = range * exponential_blend(u.x, R((R(1) - C) * range));
    const R d = safe_sqrt(v * expm1_over(v) / B);
    const R s = sin_theta(wo), arc = half_arc(s, d), phi = (R(2) * u.y - R(1)) * arc;
    const auto tilted = s > R(0);
    const R x = select(tilted, wo.x / select(tilted, s, R(1)), R(1));
    const R y = select(tilted, wo.y / select(tilted, s, R(1)), R(0));
    // From the mirror direction (-wo) towards the disk's centre, turned by phi.
    const R px = -wo.x + d * (x * cos(phi) - y * sin(phi)), py = -wo.y + d * (y * cos(phi) + x * sin(phi));
    return {px, py, safe_sqrt(R(1) - px * px - py * py)};
  }
  /// Per sr; 0 below the surface.
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const R d2 = select(up, distance2(wo, wi), R(0)), range = log_range(wo);
    const R norm = range * expm1_over(R((R(1) - C) * range)) / B; // of the power over d^2
    const R arc = half_arc(sin_theta(wo), R(safe_sqrt(d2)));
    return select(up, power(d2) / (norm * max(arc, R(1e-6f))) * wi.z, R(0));
  }

private:
  static R distance2(const Vec3<R>& wo, const Vec3<R>& wi) { return sqr(wo.x + wi.x) + sqr(wo.y + wi.y); }
  static R sin_theta(const Vec3<R>& w) { return min(safe_sqrt(w.x * w.x + w.y * w.y), R(1)); }
  R power(const R& d2) const { return exp(-C * log(R(1) + B * d2)); }
  R log_range(const Vec3<R>& wo) const { return log(R(1) + B * sqr(R(1) + sin_theta(wo))); }
  /// Of the circle of radius d about a point at distance s from the centre of the unit disk.
  static R half_arc(const R& s, const R& d) {
    const auto cut = d > R(1) - s;
    const R cosine = (d * d + s * s - R(1)) / max(R(2) * d * s, R(1e-20f));
    return select(cut, acos(clamp(cosine, -0.999999f, 0.999999f)), constant<R>(pi));
  }
};

} // namespace nacre
