#pragma once
// Small files of every kind the commands read, made by the test.

#include "core/file.h"
#include "core/image.h"
#include "core/scratch_folder.h"
#include "measured/merl_table.h"

#include <cstring>
#include <string>

namespace nacre {

inline std::string write(const ScratchFolder& folder, const std::string& name, const std::string& contents) {
  write_file_atomically(folder / name, contents);
  return folder / name;
}

/// A diffuse table with a lobe, of 8 x 8 x 16 entries.
inline std::string small_table(const ScratchFolder& folder, const std::string& name = "small.binary") {
  write_merl(MerlTable::tabulate(8, 8, 16,
                                 [](double h, double, double) -> std::array<double, 3> {
                                   const double lobe = 0.3 * std::exp(-sqr(h / 0.4));
                                   return {0.1 + lobe, 0.05 + lobe, 0.02 + lobe};
                                 }),
             folder / name);
  return folder / name;
}

/// The first `size` bytes of a file, under a new name.
inline std::string truncated(const ScratchFolder& folder, const std::string& from, const std::string& name,
                             std::size_t size) {
  const std::string bytes = read_text_file(from);
  EXPECT_LT(size, bytes.size());
  return write(folder, name, bytes.substr(0, size));
}

inline std::string small_picture(const ScratchFolder& folder, const std::string& name, int width = 24,
                                 int height = 16, float brightness = 1) {
  Image image(width, height, {"R", "G", "B"});
  for (std::size_t i = 0; i < image.data.size(); ++i)
    image.data[i] = brightness * float(i % 97) / 97;
  write_exr(image, folder / name);
  return folder / name;
}

struct SceneParts {
  std::string film = "<integer name='width' value='32'/><integer name='height' value='24'/>";
  std::string samples = "4";
  std::string light = "<emitter type='constant'/>";
  std::string shapes = "<shape type='sphere'/>";
  std::string sensor_more = "";
};

/// One element a line: the shapes stand on line 4.
inline std::string scene_text(const SceneParts& parts = {}) {
  return "<scene version='3.0.0'>\n"
         "<sensor type='perspective'><film type='hdrfilm'>" +
         parts.film + "</film><sampler type='independent'><integer name='sample_count' value='" +
         parts.samples +
         "'/></sampler><transform name='to_world'><lookat origin='0,0,4' target='0,0,0' "
         "up='0,1,0'/></transform>" +
         parts.sensor_more + "</sensor>\n" + parts.light + "\n" + parts.shapes + "\n</scene>\n";
}

inline std::string small_scene(const ScratchFolder& folder, const SceneParts& parts = {},
                               const std::string& name = "scene.xml") {
  return write(folder, name, scene_text(parts));
}

/// A scene whose shapes on line 4 are these.
inline std::string scene_of(const ScratchFolder& folder, const std::string& shapes) {
  SceneParts parts;
  parts.shapes = shapes;
  return small_scene(folder, parts);
}

} // namespace nacre
