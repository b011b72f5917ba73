#pragma once
// One object of a material under an environment.

#include "explorer/folder.h"
#include "measured/material_spec.h"
#include "scene/scene.h"

namespace nacre {

struct ObjectView {
  std::string mesh = "sphere";     ///< "sphere", "teapot", "plane", or a file
  std::string environment = "sky"; ///< "sky", "white", or a file
  int width = 512, height = 512;
  double turn_deg = 0; ///< of the environment about the upright axis
};

/// The object about the origin, as large as the unit sphere, +y up. The camera is left to the caller.
/// @throws Error for a file that is no mesh or picture
Scene object_scene(const MaterialSpec& material, const ObjectView& view, const Folder& folder);

} // namespace nacre
