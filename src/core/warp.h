#pragma once
// Warps: maps from the unit square to the domains that light transport samples, each with its density.
// Templated on the number type and free of branches, so that one call may warp a pack of points.

#include "core/vec.h"

namespace nacre {

/// Uniform on the unit disk; keeps neighbours neighbours and areas in proportion.
/// Source: Shirley and Chiu 1997, A Low Distortion Map Between Disk and Square, with the centre guarded.
template <class R>
Vec2<R> square_to_disk(const Vec2<R>& u) {
  const R a = R(2) * u.x - R(1), b = R(2) * u.y - R(1);
  const auto x_major = abs(a) > abs(b);
  const R radius = select(x_major, a, b), minor = select(x_major, b, a);
  const R angle = constant<R>(pi / 4) * minor / select(radius == R(0), R(1), radius);
  const R along = radius * cos(angle), across = radius * sin(angle);
  return {select(x_major, along, across), select(x_major, across, along)};
}
/// Per area of the disk, 1 / pi inside and 0 outside.
template <class R>
R square_to_disk_pdf(const Vec2<R>& p) {
  return select(p.x * p.x + p.y * p.y <= R(1), constant<R>(inv_pi), R(0));
}

/// Directions of the upper hemisphere with density cos(theta) / pi (Malley's method: disk points lifted). On
/// the edge of the square w.z, and with it the density, may be 0.
template <class R>
Vec3<R> square_to_cosine_hemisphere(const Vec2<R>& u) {
  const Vec2<R> d = square_to_disk(u);
  return {d.x, d.y, safe_sqrt(R(R(1) - d.x * d.x - d.y * d.y))};
}
/// Per solid angle.
template <class R>
R square_to_cosine_hemisphere_pdf(const Vec3<R>& w) {
  return max(w.z, R(0)) * constant<R>(inv_pi);
}

namespace warp_detail {
/// The direction at height z = 1 - drop whose azimuth comes from u.y; exact near the pole, where z rounds
/// to 1.
template <class R>
Vec3<R> lifted(const R& drop, const R& u_azimuth) {
  const R s = safe_sqrt(R(drop * (R(2) - drop))), phi = constant<R>(2 * pi) * u_azimuth;
  return {s * cos(phi), s * sin(phi), R(1) - drop};
}
} // namespace warp_detail

/// Uniform over the upper hemisphere.
template <class R>
Vec3<R> square_to_hemisphere(const Vec2<R>& u) {
  return warp_detail::lifted(u.x, u.y);
}
template <class R>
R square_to_hemisphere_pdf(const Vec3<R>& w) {
  return select(w.z >= R(0), constant<R>(0.5 * inv_pi), R(0));
}

/// Uniform over the whole sphere.
template <class R>
Vec3<R> square_to_sphere(const Vec2<R>& u) {
  return warp_detail::lifted(R(R(2) * u.x), u.y);
}
template <class R>
R square_to_sphere_pdf(const Vec3<R>&) {
  return constant<R>(0.25 * inv_pi);
}

/// Uniform over the cone of directions with w.z >= cos_theta_max, for cos_theta_max in [-1, 1).
template <class R>
Vec3<R> square_to_cone(const Vec2<R>& u, const std::type_identity_t<R>& cos_theta_max) {
  return warp_detail::lifted(R(u.x * (R(1) - cos_theta_max)), u.y);
}
template <class R>
R square_to_cone_pdf(const Vec3<R>& w, const std::type_identity_t<R>& cos_theta_max) {
  return select(w.z >= cos_theta_max, R(constant<R>(0.5 * inv_pi) / (R(1) - cos_theta_max)), R(0));
}

/// Uniform over a triangle: barycentrics (b0, b1) of its first two corners, b2 = 1 - b0 - b1. Continuous.
/// Source: Heitz 2019, A Low-Distortion Map Between Triangle and Square: fold the square about its diagonal.
template <class R>
Vec2<R> square_to_triangle(const Vec2<R>& u) {
  const R small = R(0.5f) * min(u.x, u.y), rest = max(u.x, u.y) - small;
  const auto below = u.y > u.x;
  return {select(below, small, rest), select(below, rest, small)};
}
/// Per area in the plane (b0, b1), where the triangle has area 1/2; divide by twice a triangle's own area.
template <class R>
R square_to_triangle_pdf(const Vec2<R>& b) {
  const auto inside = min(min(b.x, b.y), R(R(1) - b.x - b.y)) >= R(0);
  return select(inside, R(2), R(0));
}

} // namespace nacre
