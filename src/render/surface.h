#pragma once
// From a hit to the point that is shaded: where it is, how it is oriented, and how well that is known.

#include "render/ray.h"
#include "scene/scene.h"

#include <vector>

namespace nacre {

/// A point on a surface, in world space.
struct Surface {
  Vec3f p;
  Vec3f ng;           ///< unit geometric normal, on the side the shape declares outer (or vertex normals say)
  Frame<float> frame; ///< shading frame: n interpolated, s along dp/du made perpendicular to it
  Vec2f uv;
  Vec3f dp_du{0, 0, 0}, dp_dv{0, 0, 0}; ///< 0 where uv are degenerate
  float offset = 0; ///< bound of the error of p along ng; rays leave from offset_origin(p, ng, d, offset)
  int material = -1;
  std::uint32_t shape = Hit::none, instance = Hit::none, primitive = 0; ///< as in Hit

  /// A ray into `direction` that does not hit this surface where it starts.
  Ray spawn(const Vec3f& direction, float t_max = infinity) const {
    return {offset_origin(p, ng, direction, offset), 0, direction, t_max};
  }
};

/// Looks up surface points. Keeps a reference to the scene.
class SurfaceTable {
public:
  explicit SurfaceTable(const Scene& scene);
  Surface at(const Ray& ray, const Hit& hit) const;

private:
  /// An affine map in float, with the transposed inverse for normals.
  struct Placement {
    std::array<std::array<float, 4>, 3> to_world, to_local;
    Vec3f point(const Vec3f& p) const;
    Vec3f vector(const Vec3f& v) const;
    Vec3f normal(const Vec3f& n) const; ///< not unit length
    Vec3f local_point(const Vec3f& p) const;
    Vec3f local_vector(const Vec3f& v) const;
  };
  /// What `at` needs of a shape beyond its description.
  struct Prepared {
    const Shape* shape;
    Vec3f reach{0, 0, 0}; ///< largest |coordinate| that its points are computed from, per axis
    Placement placement;  ///< of quadrics
  };
  static Placement place(const Transform& t);
  static Prepared prepare(const Shape& shape);
  /// Fills in the point as the shape has it, `offset` left out; in place, as it is much data to copy.
  static void set_local(Surface& s, const Prepared& shape, const Hit& hit, const Vec3f& approximate_p);

  std::vector<Prepared> shapes_;
  std::vector<std::vector<Prepared>> groups_;
  std::vector<Placement> instances_;
  std::vector<std::uint32_t> instance_group_;
};

} // namespace nacre
