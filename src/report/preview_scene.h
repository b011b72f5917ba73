#pragma once
// The little scene a material is shown in.

#include "scene/scene_material.h"

#include <memory>

namespace nacre {

/// Two spheres of the material on a chequered mat before a plain backdrop, under `environment`, or the light
/// of a clear sky with sun if there is none.
/// @param environment  latitude-longitude map, linear sRGB
Scene preview_scene(const MaterialSpec& material, std::shared_ptr<const Image> environment, int width,
                    int height);

/// That clear sky. Building it takes a moment; two previews share one.
std::shared_ptr<const Image> preview_sky();

} // namespace nacre
