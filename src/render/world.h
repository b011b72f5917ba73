#pragma once
// Everything an integrator asks of a scene, built once and immutable from then on.

#include "render/accel.h"
#include "render/lights.h"
#include "render/material.h"
#include "render/surface.h"

namespace nacre {

/// A scene prepared for light transport. Keeps references into the scene, which must outlive it.
struct World {
  Accel accel;
  SurfaceTable surfaces;
  MaterialTable materials;
  LightSet lights;

  /// @throws Error if the scene cannot be rendered
  explicit World(const Scene& scene)
      : accel(scene), surfaces(scene), materials(scene), lights(scene, surfaces, accel.radius()) {}
};

} // namespace nacre
