#pragma once
// Scenes of any format Nacre reads.

#include "scene/scene.h"

#include <map>
#include <string>
#include <vector>

namespace nacre {

struct SceneOptions {
  std::vector<std::string> folders; ///< where named files are looked up after the scene's own folder
  std::map<std::string, std::string> definitions; ///< values of the scene's parameters
  bool strict = false;                            ///< a warning is an error
};

/// Reads a scene by its file's extension: .xml is Mitsuba. @throws Error
Scene read_scene(const std::string& path, const SceneOptions& options = {});

} // namespace nacre
