#pragma once
// How far a picture is from its reference, in the measures of the field.

#include "core/image.h"
#include "display/flip.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace nacre {

/// The closed list of measures; the command line's help and its checks come from it.
struct ImageMetric {
  std::string name, meaning, formula;
};
std::span<const ImageMetric> metrics();

struct CompareOptions {
  double relative_epsilon = 0.01; ///< added to the squared reference in relMSE
  double trimmed_share = 0.001;   ///< of the pixels, those of largest error, left out by relmse-trimmed
  FlipOptions flip;
};

/// @throws Error for an unknown measure (with the nearest name), or an option out of its domain
void check(std::span<const std::string> names, const CompareOptions& options);

struct MetricValue {
  std::string name;
  double value; ///< infinite for the PSNR of equal pictures
};
struct Comparison {
  std::vector<MetricValue> values; ///< in the order asked for
  std::size_t pixels = 0;
  std::size_t not_finite = 0; ///< pixels with NaN or infinity in either; left out of every measure but FLIP
  std::optional<FlipResult> flip, hdr_flip; ///< if asked for
};

/// Measures the colour of `picture` against `reference`, both in linear sRGB; other channels are not
/// compared. Means are over pixels and the three channels, in double.
/// @throws Error for pictures of different size or without colour, an unknown measure, no finite pixel in
/// common
Comparison compare(const Image& picture, const Image& reference, std::span<const std::string> names,
                   const CompareOptions& options = {});

/// Error of each pixel, mean over its channels, as channel "Y". @throws Error as above
enum class PixelError { squared, absolute, relative_squared };
Image error_map(const Image& picture, const Image& reference, PixelError kind,
                const CompareOptions& options = {});
/// picture - reference in R, G, B.
Image difference(const Image& picture, const Image& reference);

} // namespace nacre
