#pragma once
// Rays, what they hit, and where a ray may start so that it does not hit the surface it leaves.

#include "core/vec.h"

#include <cmath>
#include <cstdint>
#include <limits>

namespace nacre {

inline constexpr float infinity = std::numeric_limits<float>::infinity();

/// Points origin + t direction with t in (t_min, t_max). The direction need not be of unit length.
struct Ray {
  Vec3f origin;
  float t_min = 0;
  Vec3f direction;
  float t_max = infinity;
};

/// The nearest intersection of a ray, in the numbers of the shape itself.
struct Hit {
  static constexpr std::uint32_t none = ~0u;

  float t = infinity;
  /// Surface coordinates of the primitive: barycentric weights of a triangle's second and third corner, (s,
  /// t) of a quad, local (x, y) of a disk, (azimuth, z) of a cylinder, nothing for a sphere.
  float u = 0, v = 0;
  std::uint32_t shape = none;    ///< index into Scene::shapes, or into the shapes of the instance's group
  std::uint32_t primitive = 0;   ///< triangle of a mesh
  std::uint32_t instance = none; ///< index into Scene::instances

  explicit operator bool() const { return shape != none; }
};

/// `p` moved off its surface to the side that `direction` leaves to, along the unit normal `n` by `distance`,
/// a bound of the error with which p lies on the surface and the traversal finds it; rounded away from the
/// surface. In the spirit of Waechter and Binder 2019, A Fast and Robust Method for Avoiding
/// Self-Intersection, with the bound taken from the magnitude of the coordinates that p was computed from
/// instead of from p itself, which may lie near the origin of a large triangle.
inline Vec3f offset_origin(const Vec3f& p, const Vec3f& n, const Vec3f& direction, float distance) {
  return p + n * std::copysign(distance, dot(n, direction));
}

} // namespace nacre
