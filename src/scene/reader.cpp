#include "scene/reader.h"

#include "core/error.h"
#include "scene/mitsuba.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace nacre {

namespace {

/// What makes a picture black although nothing in the file is wrong.
void warn_of_darkness(Scene& scene, bool strict) {
  const auto emits = [](const Shape& shape) { return shape.emission.has_value(); };
  if (!scene.lights.empty() || std::any_of(scene.shapes.begin(), scene.shapes.end(), emits)) return;
  const std::string message = "the scene has no light: the picture is black";
  if (strict) throw Error::in_file(scene.file, message);
  scene.warnings.push_back(scene.file + ": " + message);
}

} // namespace

Scene read_scene(const std::string& path, const SceneOptions& options) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension != ".xml")
    throw Error::in_file(path, "not a scene Nacre reads: expected a file that ends in .xml (Mitsuba)");
  Scene scene = read_mitsuba_scene(path, {options.folders, options.definitions, options.strict});
  warn_of_darkness(scene, options.strict);
  return scene;
}

} // namespace nacre
