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

  /// Share of the lobe's integral over the whole plane that lies within the unit disk, with the lobe's centre
  /// at distance s from the disk's; C > 1. Error below 0.002 (test). Nodes: Abramowitz and Stegun 1964,
  /// table 25.4, n = 8.
  R share_in_disk(const R& s) const {
    constexpr double x[] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
    constexpr double w[] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
    // By share v = 1 - (1 + B d^2)^(1 - C) within distance d: all of it up to 1 - s, arcs from there to 1 +
    // s.
    const R power = C - R(1);
    const auto share = [&](const R& d) { return R(R(1) - exp(-power * log(R(1) + B * d * d))); };
    const R whole = share(R(R(1) - s)), range = share(R(R(1) + s)) - whole;
    R arcs = R(0);
    for (int i = 0; i < 8; ++i) {
      const double node = 0.5 + (i < 4 ? -0.5 : 0.5) * x[i % 4];
      const R rest = max(R(1) - whole - range * constant<R>(node), R(1e-7f));
      const R y = -log(rest) / power, d2 = y * expm1_over(R(min(y, R(60)))) / B;
      arcs = arcs + constant<R>(0.5 * inv_pi * w[i % 4]) * half_arc(s, R(safe_sqrt(d2)));
    }
    return whole + range * arcs;
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
