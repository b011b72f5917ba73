#pragma once
// Reads scenes of Mitsuba 2 and 3, and of the 0.x versions with their camelCase names.

#include "scene/scene.h"

#include <map>
#include <string>
#include <vector>

namespace nacre {

struct MitsubaOptions {
  std::vector<std::string> folders; ///< where named files are looked up after the scene's own folder
  std::map<std::string, std::string> definitions; ///< values of $parameters, before those of <default>
  bool strict = false;                            ///< a warning is an error
};

/// What the file means in Mitsuba's spectral mode. Known: integrators path and direct (moment gives the one
/// it wraps); sensors perspective and orthographic; emitters area, point, spot, projector, directional,
/// constant, envmap and Nacre's sky and sunsky; bsdfs diffuse, (rough)conductor, (rough)dielectric,
/// (rough)plastic, principled, twosided, mask, normalmap, bumpmap, blendbsdf; shapes obj, ply, serialized,
/// sphere, rectangle, cube, disk, cylinder, shapegroup, instance; textures bitmap and checkerboard. Nacre's
/// own bsdfs are merl (filename: .binary), each model of the list under its name with its declared
/// parameters, and nacre (material: as on the command line; or filename: .json of a fit, .binary). Anything
/// else, and any parameter nobody asks for, is an Error at its line and column, but for parameters that only
/// steer noise, speed or the output's format. Masking-shadowing of Mitsuba's rough surfaces is the separable
/// product, as Mitsuba has it.
Scene read_mitsuba_scene(const std::string& path, const MitsubaOptions& options = {});
/// The same from a text; `name` is its file, beside which others are looked up.
Scene parse_mitsuba_scene(const std::string& text, const std::string& name,
                          const MitsubaOptions& options = {});

} // namespace nacre
