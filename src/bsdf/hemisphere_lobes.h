#pragma once
// Two one-parameter families of azimuth-free densities over the upper hemisphere, for sampling reflection
// that no closed form samples: one that flattens from cosine to uniform, one that gathers at the horizon.

#include "core/warp.h"

namespace nacre {

/// Density (k + 1) z^k / (2 pi) with z = w.z: uniform at k = 0, Lambert's at 1. k >= 0.
template <class R>
struct PowerCosine {
  R k;

  Vec3<R> sample(const Vec2<R>& u) const {
    const R z = pow(max(u.x, R(1e-30f)), R(R(1) / (k + R(1)))); // guarded: pow wants more than 0
    return warp_detail::lifted(R(R(1) - z), u.y);
  }
  R pdf(const Vec3<R>& w) const {
    const auto up = w.z > R(0);
    const R z = max(select(up, w.z, R(1)), R(1e-30f));
    return select(up, (k + R(1)) * constant<R>(0.5 * inv_pi) * pow(z, k), R(0));
  }
};

/// Near to what a medium of isotropic scatterers sends along w.z, w.z / (w.z + wo.z), from flat at grazing to
/// a cosine at the normal.
template <class R>
PowerCosine<R> diffusing_lobe(const Vec3<R>& wo) {
  return {safe_sqrt(max(wo.z, R(0)))};
}

/// Density (k + 1) (1 - z)^k in z = w.z: the nearer to the horizon the larger k >= 0. Its azimuth is even for
/// `wo` at the normal and falls linearly from wo's side to the other.
template <class R>
struct HorizonLobe {
  R k;
  Vec3<R> wo;

  Vec3<R> sample(const Vec2<R>& u) const {
    const R s = lean();
    const auto leans = u.y < s;
    const R t = select(leans, u.y / select(leans, s, R(1)), (u.y - s) / (R(1) - s));
    // a tent over (-pi, pi) by inversion of each half
    const R half = abs(R(2) * t - R(1)), tent = R(1) - safe_sqrt(R(R(1) - half));
    const R turn = select(leans, select(t < R(0.5f), -tent, tent), R(R(2) * t - R(1)));
    const R drop = pow(max(u.x, R(1e-30f)), R(R(1) / (k + R(1)))); // guarded: pow wants more than 0
    const Vec3<R> w = warp_detail::lifted(drop, R(R(0.5f) * turn));
    const Vec2<R> a = axis();
    return {a.x * w.x - a.y * w.y, a.y * w.x + a.x * w.y, w.z};
  }
  R pdf(const Vec3<R>& w) const {
    const auto up = w.z > R(0);
    const R drop = max(R(1) - select(up, w.z, R(0.5f)), R(1e-30f));
    const Vec2<R> a = axis();
    const R along = a.x * w.x + a.y * w.y, across = a.x * w.y - a.y * w.x;
    const auto tilted = sqr(along) + sqr(across) > R(1e-20f);
    const R turn =
        abs(atan2(select(tilted, across, R(0)), select(tilted, along, R(1)))) * constant<R>(inv_pi);
    const R s = lean(), azimuth = R(1) - s + s * R(2) * (R(1) - turn);
    return select(up, (k + R(1)) * constant<R>(0.5 * inv_pi) * pow(drop, k) * azimuth, R(0));
  }

private:
  R lean() const { return R(0.9f) * min(sqrt(max(sin2_theta(wo), R(1e-20f))), R(1)); }
  /// Unit vector of wo's azimuth.
  Vec2<R> axis() const {
    const R s2 = sin2_theta(wo);
    const auto tilted = s2 > R(1e-20f);
    const R inv = R(1) / sqrt(select(tilted, s2, R(1)));
    return {select(tilted, wo.x * inv, R(1)), select(tilted, wo.y * inv, R(0))};
  }
};

} // namespace nacre
