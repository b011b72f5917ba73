#pragma once
// Spheres, disks and cylinders under rays, in double precision: exact to the rounding of the ray itself, from
// inside and at grazing incidence.

#include "render/ray.h"
#include "scene/scene.h"

namespace nacre {

class Quadric {
public:
  explicit Quadric(const Sphere& sphere);
  explicit Quadric(const Disk& disk);
  explicit Quadric(const Cylinder& cylinder);

  struct Box {
    Vec3f lo, hi;
  };
  Box bounds() const;
  /// The nearest crossing within (ray.t_min, ray.t_max) from either side; sets t, u, v of `hit`.
  bool intersect(const Ray& ray, Hit& hit) const;

private:
  enum class Kind { sphere, disk, cylinder };
  bool sphere_hit(const Ray& ray, Hit& hit) const;
  bool disk_hit(const Ray& ray, Hit& hit) const;
  bool cylinder_hit(const Ray& ray, Hit& hit) const;

  Kind kind_;
  Vec3d center_{};  ///< sphere
  double radius_{}; ///< sphere
  Transform to_world_, to_local_;
};

} // namespace nacre
