#pragma once
// From a point of the film to a ray into the scene. +z looks forward, +y is up and +x to the left, so the
// picture is not mirrored.

#include "render/ray.h"
#include "scene/scene.h"

namespace nacre {

/// The camera of a scene for a film of a given size.
class CameraRays {
public:
  /// @throws Error if the film is empty, the field of view leaves (0, 180) degrees, or the clip planes are
  /// not 0 <= near < far
  CameraRays(const Camera& camera, const Film& film);
  /// Ray through film position (x, y) in pixels, (0, 0) the top left corner of the top left pixel. The
  /// direction is of unit length, t lies between the near and the far plane.
  Ray ray(float x, float y) const;
  /// The inverse of a perspective's `ray`: position on the film in film sizes, (0, 0) the top left corner and
  /// (1, 1) the bottom right one, of what sees the world point `p`; and the depth of `p` along the axis, not
  /// positive behind the camera, where the position has no meaning.
  Vec3d project(const Vec3d& p) const;

private:
  Camera::Projection projection_;
  Transform to_camera_;
  Vec3d origin_, left_, up_, forward_; ///< axes of the camera in the world
  double half_width_, half_height_;    ///< of the film: at distance 1, or in camera units
  double width_, height_;              ///< in pixels
  double near_, far_;
};

} // namespace nacre
