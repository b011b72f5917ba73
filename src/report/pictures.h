#pragma once
// The pictures of a report: two renders as seen on a display, and where they differ.

#include "core/image.h"

#include <span>
#include <string>

namespace nacre {

/// Two renders and their differences, each coded for display, R G B.
struct ComparedPictures {
  Image reference, picture;
  Image flip;                ///< LDR-FLIP of the two as displayed, as colour of `error_colour`
  Image signed_luminance;    ///< luminance of picture - reference as displayed, through `signed_colour`
  double exposure_stops = 0; ///< of both
  double rmse = 0;           ///< linear, after exposure
  double flip_mean = 0, hdr_flip_mean = 0;
  double signed_range = 0.1; ///< display-linear difference at either end of signed_colour
};
/// Both are tone-mapped with one exposure, which brings the reference's log-average luminance to 0.16.
ComparedPictures compare_for_display(const Image& picture, const Image& reference);

/// sRGB code of a difference in [-1, 1], clipped to it: blue below 0, grey at 0, orange above; lightness
/// rises away from 0 on both sides alike.
std::array<float, 3> signed_colour(double difference);

/// Pictures of one height side by side with gaps of `gap` pixels in `grey`.
Image side_by_side(std::span<const Image> pictures, int gap, float grey);

/// "data:image/png;base64,..."
std::string png_data_url(const Image& picture);

} // namespace nacre
