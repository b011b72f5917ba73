#pragma once
// Vectors and local shading frames.

#include "core/number.h"

namespace nacre {

template <class R>
struct Vec2 {
  R x{}, y{};
};

template <class R>
struct Vec3 {
  R x{}, y{}, z{};

  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3 operator*(const Vec3& a, const R& s) { return {a.x * s, a.y * s, a.z * s}; }
  friend Vec3 operator*(const R& s, const Vec3& a) { return a * s; }
  friend Vec3 operator/(const Vec3& a, const R& s) { return a * (R(1) / s); }
  Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
  Vec3& operator*=(const R& s) { return *this = *this * s; }
};

using Vec2f = Vec2<float>;
using Vec2d = Vec2<double>;
using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

template <class R>
R dot(const Vec3<R>& a, const Vec3<R>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class R>
Vec3<R> cross(const Vec3<R>& a, const Vec3<R>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class R>
R length_squared(const Vec3<R>& a) {
  return dot(a, a);
}
template <class R>
R length(const Vec3<R>& a) {
  return sqrt(dot(a, a));
}
template <class R>
Vec3<R> normalize(const Vec3<R>& a) {
  return a / length(a);
}
template <class R, class M>
Vec3<R> select(const M& mask, const Vec3<R>& yes, const Vec3<R>& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
template <class R>
Vec3<R> vec3(const Vec3d& a) {
  return {constant<R>(a.x), constant<R>(a.y), constant<R>(a.z)};
}

// Trigonometry of a direction in the local shading frame: z is the normal, x the tangent.
template <class R>
R cos_theta(const Vec3<R>& w) {
  return w.z;
}
template <class R>
R sin2_theta(const Vec3<R>& w) {
  return w.x * w.x + w.y * w.y;
}
template <class R>
R tan2_theta(const Vec3<R>& w) {
  return sin2_theta(w) / (w.z * w.z);
}
template <class R>
Vec3<R> spherical_direction(const R& theta, const R& phi) {
  const R s = sin(theta);
  return {s * cos(phi), s * sin(phi), cos(theta)};
}
/// Mirror image of `w` about the unit vector `n`; both point away from the surface.
template <class R>
Vec3<R> reflect(const Vec3<R>& w, const Vec3<R>& n) {
  return (R(2) * dot(w, n)) * n - w;
}

/// Orthonormal right-handed frame: s the tangent (x), t the bitangent (y), n the normal (z).
template <class R>
struct Frame {
  Vec3<R> s, t, n;

  /// Any frame about the unit vector `n`, without branches (Duff et al. 2017, Building an Orthonormal Basis,
  /// Revisited, listing 3).
  static Frame around(const Vec3<R>& n) {
    const R sign = select(n.z < R(0), R(-1), R(1));
    const R a = R(-1) / (sign + n.z), b = n.x * n.y * a;
    return {{R(1) + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
  }
  /// The frame about the unit vector `n` whose tangent is `tangent` made perpendicular to it; `around(n)`
  /// where the two are parallel.
  static Frame with_tangent(const Vec3<R>& n, const Vec3<R>& tangent) {
    const Vec3<R> s = tangent - n * dot(n, tangent);
    const R l2 = length_squared(s);
    const auto usable = l2 > R(1e-12f) * length_squared(tangent);
    const Frame other = around(n);
    const Vec3<R> unit = select(usable, s / sqrt(select(usable, l2, R(1))), other.s);
    return {unit, select(usable, cross(n, unit), other.t), n};
  }
  Vec3<R> to_local(const Vec3<R>& w) const { return {dot(w, s), dot(w, t), dot(w, n)}; }
  Vec3<R> to_world(const Vec3<R>& w) const { return s * w.x + t * w.y + n * w.z; }
};

} // namespace nacre
