#pragma once
// What a model declares, without its types: what listings, readers and doors know of it.

#include "bsdf/parameter.h"

#include <string>
#include <vector>

namespace nacre {

struct ParameterInfo {
  std::string name, unit, meaning;
  double lo, hi, initial;
  bool per_channel, fitted;

  /// The colour called "wavelength": each channel's own, which a renderer sets to that of the path and RGB to
  /// those of its primaries.
  bool is_wavelength() const { return per_channel && name == "wavelength"; }
  /// A nanometre in the parameter's unit.
  double wavelength_unit() const { return unit == "um" ? 1e-3 : 1; }
};
struct ModelInfo {
  std::string name, source, summary;
  Laws laws;
  std::vector<ParameterInfo> parameters;

  /// Place of a parameter. @throws Error that suggests the nearest name
  std::size_t parameter_index(std::string_view parameter) const;
  bool has(std::string_view parameter) const;
};

} // namespace nacre
