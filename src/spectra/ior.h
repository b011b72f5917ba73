#pragma once
// Indices of refraction of named substances: facts from measurement, each with its source.

#include "spectra/spectrum_source.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

/// Complex index of refraction eta + i k of a metal.
struct ConductorIor {
  SpectrumSource eta, k;
};

/// The metal or absorbing solid of that chemical symbol or compound name ("Au", "TiN", "a-C"), "none" for the
/// ideal mirror, or null. Sources in data/conductor_ior.h. Lives as long as the program.
const ConductorIor* find_metal(std::string_view name);
/// Names `find_metal` knows, sorted; to suggest a near one when a name is misspelt.
const std::vector<std::string>& metal_names();
/// Index of refraction at the sodium or helium d line (587.6 to 589.3 nm) of a transparent substance ("bk7",
/// "water"), if known.
std::optional<double> find_dielectric(std::string_view name);
/// Names `find_dielectric` knows, sorted.
const std::vector<std::string>& dielectric_names();

} // namespace nacre
