#include "display/rgb_planes.h"

#include "core/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace nacre {

std::array<int, 3> rgb_channels(const Image& image, const std::string& what) {
  if (image.width <= 0 || image.height <= 0)
    throw Error(fmt::format("{}: not one pixel ({} x {})", what, image.width, image.height));
  const std::array<int, 3> rgb{image.channel("R"), image.channel("G"), image.channel("B")};
  if (rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0) return rgb;
  const int y = image.channel("Y");
  if (y >= 0) return {y, y, y};
  throw Error(
      fmt::format("{}: expected channels R, G, B or Y, found {}", what, fmt::join(image.channels, ", ")));
}

RgbPlanes rgb_planes(const Image& image, const std::string& what) {
  const auto channels = rgb_channels(image, what);
  const std::size_t pixels = static_cast<std::size_t>(image.width) * image.height;
  const std::size_t stride = image.channels.size();
  RgbPlanes planes{image.width, image.height, {}};
  for (int c = 0; c < 3; ++c) {
    planes.plane[c].resize(pixels);
    for (std::size_t i = 0; i < pixels; ++i)
      planes.plane[c][i] = image.data[i * stride + channels[c]];
  }
  return planes;
}

void require_same_size(const Image& picture, const Image& reference, const std::string& what_picture,
                       const std::string& what_reference) {
  if (picture.width == reference.width && picture.height == reference.height) return;
  throw Error(fmt::format("{} is {} x {}, {} is {} x {}: pictures of different size cannot be compared",
                          what_picture, picture.width, picture.height, what_reference, reference.width,
                          reference.height));
}

} // namespace nacre
