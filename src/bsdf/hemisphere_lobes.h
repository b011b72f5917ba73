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

/// Density (k + 1) (1 - z)^k / (2 pi): uniform at k = 0, the nearer to the horizon the larger k >= 0.
template <class R>
struct HorizonLobe {
  R k;

  Vec3<R> sample(const Vec2<R>& u) const {
    return warp_detail::lifted(R(pow(max(u.x, R(1e-30f)), R(R(1) / (k + R(1))))), u.y);
  }
  R pdf(const Vec3<R>& w) const {
    const auto up = w.z > R(0);
    const R drop = max(R(1) - select(up, w.z, R(0.5f)), R(1e-30f));
    return select(up, (k + R(1)) * constant<R>(0.5 * inv_pi) * pow(drop, k), R(0));
  }
};

} // namespace nacre
