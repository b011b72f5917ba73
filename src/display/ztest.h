#pragma once
// Is a rendered picture a draw from the distribution its reference describes?

#include "core/image.h"

#include <array>

namespace nacre {

struct ZTestOptions {
  double significance = 0.01;     ///< of the whole picture, spread over its pixels by Sidak's correction
  double required_share = 0.9975; ///< of pixel-channels to be accepted
  double least_variance = 1e-4;   ///< smaller variances, of which a sample says little, are raised to it
};

struct ZTestResult {
  bool pass = false;
  double accepted_share = 0; ///< of pixel-channels whose p-value is above `level`
  double level = 0;          ///< 1 - (1 - significance)^(1 / pixels)
  double largest_z = 0;      ///< NaN in the picture or the variance counts as infinite
  int worst_x = 0, worst_y = 0;
  int worst_channel = 0; ///< 0 X, 1 Y, 2 Z
  double rms_z = 0;      ///< near 1 where the variance rules and the two agree; over finite values
  Image z;               ///< signed z in channels X, Y, Z
};

/// Mitsuba's render test (src/render/tests/test_renders.py): pictures and variance, all three linear sRGB, go
/// to XYZ by the same matrix; z = (picture - reference) sqrt(spp / max(variance, 1e-4)); the two-sided
/// p-value of each pixel and channel is held against Sidak's level. That the variance goes through the matrix
/// and not its square is part of the test: its files were written through the inverse matrix.
/// @param variance_one_sample  variance of one sample a pixel, not of the mean
/// @param spp                  samples per pixel of `picture`, >= 1
/// @throws Error for pictures of different size or without colour, or spp < 1
ZTestResult z_test(const Image& picture, const Image& reference, const Image& variance_one_sample, int spp,
                   const ZTestOptions& options = {});

} // namespace nacre
