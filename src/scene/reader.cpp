#include "scene/reader.h"

#include "core/error.h"
#include "scene/mitsuba.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace nacre {

Scene read_scene(const std::string& path, const SceneOptions& options) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".xml")
    return read_mitsuba_scene(path, {options.folders, options.definitions, options.strict});
  throw Error::in_file(path, "not a scene Nacre reads: expected a file that ends in .xml (Mitsuba)");
}

} // namespace nacre
