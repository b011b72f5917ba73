#pragma once
// The little scene a material is shown in.

#include "measured/material_spec.h"
#include "scene/scene.h"

#include <memory>

namespace nacre {

/// A material of a scene with the lobes of `spec`. Colours in [0, 1] become spectra linear in RGB, by the
/// basis that measured tables are rendered with: so a measured material and its fit differ in a picture where
/// their reflectances do, and not by how colours were turned into spectra.
Material scene_material(const MaterialSpec& spec);

/// Two spheres of the material on a chequered mat before a plain backdrop, under `environment`, or the light
/// of a clear sky with sun if there is none.
/// @param environment  latitude-longitude map, linear sRGB
Scene preview_scene(const MaterialSpec& material, std::shared_ptr<const Image> environment, int width,
                    int height);

/// That clear sky. Building it takes a moment; two previews share one.
std::shared_ptr<const Image> preview_sky();

} // namespace nacre
