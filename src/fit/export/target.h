#pragma once
// What every format that materials are written to says of itself.

#include "measured/material_spec.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

struct Target {
  std::string_view ending, name;
  /// Materials whose parameters are fitted where the format has no words for the given one.
  std::vector<std::string> models;
  /// The material as far as the format has words for its lobes: what it cannot say (a masking function, a
  /// factor) is replaced by what it has. Nothing if it has no word for a lobe.
  std::optional<MaterialSpec> (*express)(const MaterialSpec& material);
  /// The file for a material that `express` gave, or one of `models`.
  /// @param name     what to call it, in letters, digits, - and _
  /// @param remarks  lines for a comment
  std::string (*write)(const MaterialSpec& material, const std::string& name,
                       const std::vector<std::string>& remarks);
  /// What the format leaves open, in a line each.
  std::vector<std::string> (*remarks)(const MaterialSpec& material);
};

Target brdf_target();      ///< Disney's BRDF Explorer
Target mitsuba_target();   ///< Mitsuba 3
Target pbrt_target();      ///< pbrt-v4
Target gltf_target();      ///< glTF 2.0
Target materialx_target(); ///< MaterialX with OpenPBR
Target json_target();      ///< Nacre's own

// What those have in common.

inline bool is_model(const LobeSpec& lobe, std::string_view name) {
  return !lobe.measured && model_info(lobe).name == name;
}
inline bool is_one_of(const LobeSpec& lobe, std::initializer_list<std::string_view> names) {
  return std::any_of(names.begin(), names.end(), [&](std::string_view name) { return is_model(lobe, name); });
}
/// A parameter of a lobe by its name; of one number three times the same.
inline const std::array<double, 3>& color(const LobeSpec& lobe, std::string_view parameter) {
  return lobe.values[model_info(lobe).parameter_index(parameter)];
}
inline double number(const LobeSpec& lobe, std::string_view parameter) { return color(lobe, parameter)[0]; }
inline void set(LobeSpec& lobe, std::string_view parameter, const std::array<double, 3>& value) {
  lobe.values[model_info(lobe).parameter_index(parameter)] = value;
}
inline void set(LobeSpec& lobe, std::string_view parameter, double value) {
  set(lobe, parameter, {value, value, value});
}
/// The names of the lobes' models, "ggx_schlick+lambert".
std::string models_of(const MaterialSpec& material);
/// As many digits as tell it from its neighbours in single precision.
std::string digits(double x);
/// Three of them with a separator between.
std::string digits(const std::array<double, 3>& rgb, std::string_view separator);

/// Lines as a comment of XML, in which -- may not stand.
std::string xml_comment(const std::vector<std::string>& lines);

/// A sum of lobes as a mixture, for formats that have none but mixtures: weights that sum to 1, reached by
/// scaling the colours of those lobes that have some. A black diffuse lobe takes what is left.
/// @param scaled  parameters that a lobe's f is proportional to, all of them together; none: its weight stays
/// @return nothing if the lobes are too bright together
std::optional<MaterialSpec> as_mixture(const MaterialSpec& material,
                                       std::vector<std::string> (*scaled)(const LobeSpec&));

} // namespace nacre
