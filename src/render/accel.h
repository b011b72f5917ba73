#pragma once
// Ray intersection: the one file pair that knows Embree. Everything a scene's shapes consist of lies in one
// two-level hierarchy; triangles are watertight, quadrics are intersected in double precision.

#include "render/ray.h"
#include "scene/scene.h"

#include <memory>
#include <span>

namespace nacre {

/// Immutable once built; all queries may run on any number of threads at once.
class Accel {
public:
  /// @throws Error naming the shape if a triangle refers to a vertex that does not exist, an index is out of
  /// range, or memory does not suffice
  explicit Accel(const Scene& scene);
  ~Accel();
  Accel(const Accel&) = delete;
  Accel& operator=(const Accel&) = delete;

  /// The nearest hit; `hit` becomes a miss where there is none.
  bool intersect(const Ray& ray, Hit& hit) const;
  /// Whether anything lies between t_min and t_max.
  bool occluded(const Ray& ray) const;

  /// The same for many rays, traced in packets of 16 in the order given: fast where neighbours in the span go
  /// similar ways. `hits` and `occluded` are as long as `rays`; the latter gets 1 or 0.
  void intersect(std::span<const Ray> rays, std::span<Hit> hits) const;
  void occluded(std::span<const Ray> rays, std::span<std::uint8_t> occluded) const;

  /// Centre and radius of a sphere about all shapes; radius 0 if there are none.
  Vec3f center() const;
  float radius() const;

private:
  struct Built;
  std::unique_ptr<const Built> built_;
};

} // namespace nacre
