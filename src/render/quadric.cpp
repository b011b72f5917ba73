#include "render/quadric.h"

#include <array>
#include <optional>

namespace nacre {
namespace {

Vec3d to_double(const Vec3f& v) { return {v.x, v.y, v.z}; }

/// The crossings t0 <= t1 of the line o + t d with the sphere |x| = radius in 3-D, or, given vectors of a
/// plane, with a circle. The discriminant is taken from the distance of the line, not from b^2 - ac, so that
/// it keeps its digits for a small or far sphere, and the smaller root comes from the product of both: Haines
/// et al. 2019, Precision Improvements for Ray/Sphere Intersection (Ray Tracing Gems, chapter 7).
std::optional<std::array<double, 2>> crossings(const Vec3d& o, const Vec3d& d, double radius) {
  const double a = dot(d, d), b = dot(o, d);
  if (!(a > 0)) return std::nullopt;
  const double discriminant = radius * radius - length_squared(o - d * (b / a));
  if (!(discriminant >= 0)) return std::nullopt;
  const double q = -b - std::copysign(std::sqrt(a * discriminant), b);
  const double distance = length(o), c = (distance - radius) * (distance + radius);
  const double t0 = q / a, t1 = q != 0 ? c / q : t0;
  return std::array<double, 2>{std::min(t0, t1), std::max(t0, t1)};
}

} // namespace

Quadric::Quadric(const Sphere& s) : kind_(Kind::sphere), center_(to_double(s.center)), radius_(s.radius) {}
Quadric::Quadric(const Disk& d) : kind_(Kind::disk), to_world_(d.to_world), to_local_(d.to_world.inverse()) {}
Quadric::Quadric(const Cylinder& c)
    : kind_(Kind::cylinder), to_world_(c.to_world), to_local_(c.to_world.inverse()) {}

Quadric::Box Quadric::bounds() const {
  Vec3d lo, hi;
  if (kind_ == Kind::sphere) {
    const Vec3d r{radius_, radius_, radius_};
    lo = center_ - r, hi = center_ + r;
  } else {
    // A unit circle in local x, y reaches sqrt(m_i0^2 + m_i1^2) along the world axis i.
    const auto& m = to_world_.m;
    double l[3], h[3];
    for (std::size_t i = 0; i < 3; ++i) {
      const double r = std::hypot(m[i][0], m[i][1]), z = kind_ == Kind::cylinder ? m[i][2] : 0;
      l[i] = m[i][3] - r + std::min(z, 0.0);
      h[i] = m[i][3] + r + std::max(z, 0.0);
    }
    lo = {l[0], l[1], l[2]}, hi = {h[0], h[1], h[2]};
  }
  const auto down = [](double x) { return std::nextafter(float(x), -infinity); };
  const auto up = [](double x) { return std::nextafter(float(x), infinity); };
  return {{down(lo.x), down(lo.y), down(lo.z)}, {up(hi.x), up(hi.y), up(hi.z)}};
}

bool Quadric::intersect(const Ray& ray, Hit& hit) const {
  switch (kind_) {
  case Kind::sphere:
    return sphere_hit(ray, hit);
  case Kind::disk:
    return disk_hit(ray, hit);
  default:
    return cylinder_hit(ray, hit);
  }
}

bool Quadric::sphere_hit(const Ray& ray, Hit& hit) const {
  const auto t = crossings(to_double(ray.origin) - center_, to_double(ray.direction), radius_);
  if (!t) return false;
  for (const double candidate : *t)
    if (candidate > ray.t_min && candidate < ray.t_max) {
      hit.t = float(candidate);
      return true;
    }
  return false;
}

bool Quadric::disk_hit(const Ray& ray, Hit& hit) const {
  const Vec3d o = to_local_.point(to_double(ray.origin)), d = to_local_.vector(to_double(ray.direction));
  const double t = -o.z / d.z;
  if (!(t > ray.t_min && t < ray.t_max)) return false;
  const double x = o.x + t * d.x, y = o.y + t * d.y;
  if (!(x * x + y * y <= 1)) return false;
  hit.t = float(t), hit.u = float(x), hit.v = float(y);
  return true;
}

bool Quadric::cylinder_hit(const Ray& ray, Hit& hit) const {
  const Vec3d o = to_local_.point(to_double(ray.origin)), d = to_local_.vector(to_double(ray.direction));
  const auto t = crossings({o.x, o.y, 0}, {d.x, d.y, 0}, 1);
  if (!t) return false;
  for (const double candidate : *t) {
    const double z = o.z + candidate * d.z;
    if (candidate > ray.t_min && candidate < ray.t_max && z >= 0 && z <= 1) {
      hit.t = float(candidate);
      hit.u = float(std::atan2(o.y + candidate * d.y, o.x + candidate * d.x));
      hit.v = float(z);
      return true;
    }
  }
  return false;
}

} // namespace nacre
