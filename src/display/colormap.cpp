#include "display/colormap.h"

#include "core/error.h"
#include "core/srgb.h"
#include "spectra/cielab.h"

#include <algorithm>
#include <fmt/format.h>

namespace nacre {
namespace {

bool in_gamut(const RGB& rgb) {
  return std::all_of(rgb.begin(), rgb.end(), [](double v) { return v >= 0 && v <= 1; });
}

/// The colour of that lightness and hue, with as much of the wanted chroma as sRGB has.
RGB colour_of(double lightness, double hue, double chroma) {
  const auto at = [&](double c) {
    return xyz_to_srgb * lab_to_xyz({lightness, c * std::cos(hue), c * std::sin(hue)});
  };
  if (in_gamut(at(chroma))) return at(chroma);
  double inside = 0, outside = chroma;
  for (int i = 0; i < 40; ++i) {
    const double middle = (inside + outside) / 2;
    (in_gamut(at(middle)) ? inside : outside) = middle;
  }
  return at(inside);
}

std::array<std::array<float, 3>, 256> make_ramp() {
  std::array<std::array<float, 3>, 256> ramp;
  for (int i = 0; i < 256; ++i) {
    const double t = i / 255.0;
    const double hue = (300 + 160 * t) * std::numbers::pi / 180,
                 chroma = 75 * std::sqrt(4 * t * (1 - t) + 0.02);
    const RGB rgb = colour_of(4 + 92 * t, hue, chroma);
    for (int c = 0; c < 3; ++c)
      ramp[i][c] = static_cast<float>(srgb_encode(std::clamp(rgb[c], 0.0, 1.0)));
  }
  return ramp;
}

} // namespace

std::array<float, 3> error_colour(float error) {
  static const auto ramp = make_ramp();
  const float at = std::clamp(error, 0.0f, 1.0f) * 255;
  return ramp[static_cast<std::size_t>(std::lround(at))];
}

Image colour_map(const Image& errors) {
  if (errors.channels.size() != 1)
    throw Error(fmt::format("colour map: expected one channel, found {}", errors.channels.size()));
  Image out(errors.width, errors.height, {"R", "G", "B"});
  for (std::size_t i = 0; i < errors.data.size(); ++i) {
    const auto rgb = error_colour(errors.data[i]);
    std::copy(rgb.begin(), rgb.end(), out.data.begin() + 3 * i);
  }
  return out;
}

} // namespace nacre
