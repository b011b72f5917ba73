#pragma once
// A camera that a page turns about a point.

#include "scene/scene.h"

#include <nlohmann/json.hpp>

namespace nacre {

class Arguments;

/// {"target", "distance", "azimuth", "elevation", "fov"}: looks at the target from that distance; elevation
/// above the horizon and azimuth about the upright axis, degrees. At azimuth 0 and elevation 0 it stands on
/// the +z axis, in scenes where z is up on +x.
struct OrbitCamera {
  Vec3d target{0, 0, 0};
  double distance = 4, azimuth = 0, elevation = 0, fov = 30;

  /// @param otherwise  what is not given. @throws Error for values outside their domain
  static OrbitCamera parse(const Arguments& request, const OrbitCamera& otherwise);
  /// The nearest one to a scene's camera: its target lies on the axis, beside the middle of the scene.
  static OrbitCamera of(const Scene& scene);
  nlohmann::json to_json() const;
  /// Moves a camera; its projection and the axis of its field of view stay.
  void place(Camera& camera) const;

private:
  bool z_up_ = false; ///< of the scene
};

} // namespace nacre
