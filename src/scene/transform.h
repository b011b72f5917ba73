#pragma once
// Affine transforms between object, world and camera space. Double precision: scenes are described once and
// rounded to float only when they are handed to the renderer.

#include "core/vec.h"

#include <array>

namespace nacre {

/// A 4x4 matrix, row-major, acting on column vectors; the last row is 0 0 0 1 for every transform of a shape.
struct Transform {
  std::array<std::array<double, 4>, 4> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

  static Transform translate(const Vec3d& offset);
  static Transform scale(const Vec3d& factor);
  /// Counter-clockwise by `angle_deg` about `axis` (any length but 0).
  static Transform rotate(const Vec3d& axis, double angle_deg);
  /// Camera to world: +z looks from origin to target, +y is up, +x to the left, as Mitsuba has it.
  static Transform look_at(const Vec3d& origin, const Vec3d& target, const Vec3d& up);

  friend Transform operator*(const Transform& a, const Transform& b); ///< first b, then a
  /// @throws Error if the matrix is singular
  Transform inverse() const;
  double determinant3() const; ///< of the linear part; negative where it mirrors
  Vec3d point(const Vec3d& p) const;
  Vec3d vector(const Vec3d& v) const;
  /// A normal under this transform: the transpose of `inverse` applied to n, not normalised.
  static Vec3d normal(const Transform& inverse, const Vec3d& n);
};

} // namespace nacre
