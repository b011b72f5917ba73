#pragma once
// A material in the words of other programs. Where a format has the material's own formulas they are written;
// where it has not, the format's own model is fitted to the material, and how far it then is from it is said.

#include "measured/material_spec.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

/// How far what was written is from the material, over nodes of the MERL grid (all theta_h, every second
/// theta_d, every fourth phi_d) with both angles below 80 degrees; of a measurement, over what was measured.
/// Reflection on the front alone, mirror directions left out.
struct MappingError {
  double log = 0, cosine = 0; ///< E of fit/metric.h; cosine in 1/sr
  double relative = 0;        ///< largest |f_written - f| / max(f, 0.001 / sr) of any channel
  std::string where;          ///< the directions of that, in degrees
};

struct Translation {
  std::string format;  ///< "pbrt-v4 materials"
  MaterialSpec target; ///< what the file says, as models of the list
  bool fitted = false; ///< its parameters were fitted to the material
  MappingError error;
  std::vector<std::string> remarks; ///< what the error does not say
  std::string text;                 ///< the file

  /// What was written is the same function but for rounding.
  bool is_exact() const { return error.relative < 1e-4; }
};

struct ExportOptions {
  std::string model;      ///< which of a format's models to use, "openpbr"; empty: the one of the least error
  std::uint64_t seed = 0; ///< of the starts of a fit
};

/// @param ending   of the file, with its dot: .json .brdf .xml .pbrt .gltf .mtlx
/// @throws Error that names the endings, or the format's models; for a material the format has no words for
Translation translate(const MaterialSpec& material, std::string_view ending,
                      const ExportOptions& options = {});
/// The same by the path's ending, written whole or not at all.
Translation export_material(const MaterialSpec& material, const std::string& path,
                            const ExportOptions& options = {});

/// ".brdf", "Disney BRDF Explorer" and the models it can say, for a help text; in the order of the list.
struct ExportFormat {
  std::string ending, name;
  std::vector<std::string> models; ///< those that can be fitted, "ggx_schlick+lambert"
};
std::vector<ExportFormat> export_formats();
/// What is said of a translation on a terminal: a few lines, each ended.
std::string to_text(const Translation& translation);

} // namespace nacre
