#include "scene/transform.h"

#include "core/error.h"

#include <cmath>

namespace nacre {

Transform Transform::translate(const Vec3d& offset) {
  Transform t;
  t.m[0][3] = offset.x;
  t.m[1][3] = offset.y;
  t.m[2][3] = offset.z;
  return t;
}

Transform Transform::scale(const Vec3d& factor) {
  Transform t;
  t.m[0][0] = factor.x;
  t.m[1][1] = factor.y;
  t.m[2][2] = factor.z;
  return t;
}

Transform Transform::rotate(const Vec3d& axis, double angle_deg) {
  const double l = length(axis);
  if (!(l > 0) || !std::isfinite(l)) throw Error("a rotation needs an axis of finite length other than 0");
  const Vec3d a = axis / l;
  const double radians = angle_deg * pi / 180, s = std::sin(radians), c = std::cos(radians), d = 1 - c;
  // Rodrigues' formula: cos I + sin [a]x + (1 - cos) a a^T.
  Transform t;
  t.m = {{{c + d * a.x * a.x, d * a.x * a.y - s * a.z, d * a.x * a.z + s * a.y, 0},
          {d * a.y * a.x + s * a.z, c + d * a.y * a.y, d * a.y * a.z - s * a.x, 0},
          {d * a.z * a.x - s * a.y, d * a.z * a.y + s * a.x, c + d * a.z * a.z, 0},
          {0, 0, 0, 1}}};
  return t;
}

Transform Transform::look_at(const Vec3d& origin, const Vec3d& target, const Vec3d& up) {
  const Vec3d to_target = target - origin;
  const double distance = length(to_target);
  if (!(distance > 0) || !std::isfinite(distance))
    throw Error("look_at needs a target that differs from the origin");
  const Vec3d forward = to_target / distance, side = cross(up, forward);
  const double l = length(side);
  if (!(l > 1e-12 * length(up)) || !std::isfinite(l))
    throw Error("look_at needs an up vector that is not along the viewing direction");
  const Vec3d left = side / l, above = cross(forward, left);
  Transform t;
  t.m = {{{left.x, above.x, forward.x, origin.x},
          {left.y, above.y, forward.y, origin.y},
          {left.z, above.z, forward.z, origin.z},
          {0, 0, 0, 1}}};
  return t;
}

Transform operator*(const Transform& a, const Transform& b) {
  Transform t;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      double sum = 0;
      for (int k = 0; k < 4; ++k)
        sum += a.m[i][k] * b.m[k][j];
      t.m[i][j] = sum;
    }
  return t;
}

Transform Transform::inverse() const {
  // Gauss-Jordan elimination with partial pivoting on [m | I].
  auto a = m;
  Transform result;
  auto& b = result.m;
  for (int column = 0; column < 4; ++column) {
    int pivot = column;
    for (int row = column + 1; row < 4; ++row)
      if (std::abs(a[row][column]) > std::abs(a[pivot][column])) pivot = row;
    const double p = a[pivot][column];
    if (!(std::abs(p) > 1e-300) || !std::isfinite(p))
      throw Error("the transform is singular: it has no inverse (is a scale factor 0?)");
    std::swap(a[pivot], a[column]);
    std::swap(b[pivot], b[column]);
    for (int j = 0; j < 4; ++j) {
      a[column][j] /= p;
      b[column][j] /= p;
    }
    for (int row = 0; row < 4; ++row) {
      const double factor = a[row][column];
      if (row == column || factor == 0) continue;
      for (int j = 0; j < 4; ++j) {
        a[row][j] -= factor * a[column][j];
        b[row][j] -= factor * b[column][j];
      }
    }
  }
  return result;
}

double Transform::determinant3() const {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

Vec3d Transform::point(const Vec3d& p) const { return vector(p) + Vec3d{m[0][3], m[1][3], m[2][3]}; }

Vec3d Transform::vector(const Vec3d& v) const {
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

Vec3d Transform::normal(const Transform& inverse, const Vec3d& n) {
  const auto& i = inverse.m;
  return {i[0][0] * n.x + i[1][0] * n.y + i[2][0] * n.z, i[0][1] * n.x + i[1][1] * n.y + i[2][1] * n.z,
          i[0][2] * n.x + i[1][2] * n.y + i[2][2] * n.z};
}

} // namespace nacre
