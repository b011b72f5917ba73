#pragma once
// From a material as a person writes it, or as a fit left it, to a material of a scene.

#include "measured/material_spec.h"
#include "scene/scene.h"

namespace nacre {

/// A material of a scene with the lobes of `spec`. Colours in [0, 1] become spectra linear in RGB, by the
/// basis that measured tables are rendered with: so a measured material and its fit differ in a picture where
/// their reflectances do, and not by how colours were turned into spectra.
Material scene_material(const MaterialSpec& spec);

} // namespace nacre
