#pragma once
// The colour of a picture, taken out of its channels.

#include "core/image.h"

#include <array>
#include <vector>

namespace nacre {

/// Indices of the channels R, G, B; three times Y in a picture of luminance alone. Alpha and every other
/// channel are not colour: a picture with alpha is premultiplied, so leaving it out shows the picture over
/// black.
/// @throws Error naming `what` if there is no colour, or not one pixel
std::array<int, 3> rgb_channels(const Image& image, const std::string& what);

/// One plane of width x height values a channel.
struct RgbPlanes {
  int width = 0, height = 0;
  std::array<std::vector<float>, 3> plane;
};
RgbPlanes rgb_planes(const Image& image, const std::string& what);

/// @throws Error with both sizes unless they are equal
void require_same_size(const Image& picture, const Image& reference, const std::string& what_picture,
                       const std::string& what_reference);

} // namespace nacre
