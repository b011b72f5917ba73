#pragma once
// Error maps as colour.

#include "core/image.h"

#include <array>

namespace nacre {

/// sRGB code of an error in [0, 1] (clipped to it): lightness L* rises linearly from 4 to 96 while hue turns
/// from violet over red to yellow, so that equal steps of error look equal and the map still reads in grey.
std::array<float, 3> error_colour(float error);

/// A one-channel picture through error_colour, ready for write_png.
Image colour_map(const Image& errors);

} // namespace nacre
