#pragma once
// Substances by name as the three channels of linear sRGB need them: "metal=Au", "glass=BK7".

#include "spectra/color_space.h"

#include <optional>
#include <string_view>

namespace nacre {

/// Complex index eta + i k per channel of linear sRGB.
struct RgbIor {
  RGB eta, k;
};

/// Three conductors whose reflectance at normal incidence is the metal's linear sRGB colour under D65, or
/// nothing for a name find_metal does not know. eta is in [0.01, 20], k in [0, 30].
///
/// Each channel starts from the metal's eta and k averaged under D65 with the positive part of the channel's
/// sensitivity, and moves to the nearest index of the wanted reflectance. Wanted values above 0.99995 (gold's
/// red is 1.02) are 0.99995: a conductor reflects no more. Away from normal incidence it is an approximation:
/// the hemispherical average of the channels is within 0.01 of that of the spectrum.
std::optional<RgbIor> metal_rgb(std::string_view name);

/// Index of refraction of a transparent substance at the helium d line, by find_glass, else find_dielectric.
std::optional<double> glass_eta(std::string_view name);

} // namespace nacre
