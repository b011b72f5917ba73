#pragma once
// FLIP: the difference a viewer sees when two pictures alternate on the same display.
// LDR: Andersson et al. 2020, FLIP: A Difference Evaluator for Alternating Images.
// HDR: Andersson et al. 2021, Visualizing Errors in Rendered High Dynamic Range Images.
// Matrices and white follow from the published primaries of Rec. 709, which moves values by some 1e-4 against
// the authors' program.

#include "core/image.h"
#include "display/convolution.h"

#include <optional>

namespace nacre {

/// Pixels per degree of visual angle in the middle of a display.
double pixels_per_degree(double distance_m, double width_pixels, double width_m);

struct FlipOptions {
  /// Default: a display of 3840 pixels and 0.7 m, seen from 0.7 m: 67.02.
  double pixels_per_degree = 67.02064327658225;
  // The rest is for HDR alone. What is not given is found from the reference.
  std::optional<double> start_exposure, stop_exposure; ///< stops
  std::optional<int> exposures;
};

struct FlipResult {
  Image error;                                  ///< channel "Y", in [0, 1]
  double mean = 0, max = 0;                     ///< of that picture
  double start_exposure = 0, stop_exposure = 0; ///< stops; 0 for LDR
  int exposures = 1;
  std::size_t not_finite =
      0; ///< pixels of either picture with NaN (read as 0) or infinity (as the largest float)
};

/// Both in linear sRGB, clipped to [0, 1]. Symmetric in its two pictures.
/// @throws Error for pictures of different size or without colour, or a density that is not in [1, 1000]
FlipResult ldr_flip(const Image& picture, const Image& reference, const FlipOptions& options = {});

/// The largest LDR-FLIP a pixel reaches over a range of exposures, with the ACES fit of Narkowicz as tone
/// curve.
/// @throws Error also for a black reference without given exposures
FlipResult hdr_flip(const Image& picture, const Image& reference, const FlipOptions& options = {});

/// Parts of the metric, for tests and the curious.
namespace flip {

/// Contrast-sensitivity filter of an opponent channel: a sum of separable Gaussians, each kernel summing to
/// 1, with shares that sum to 1. Paper section 4.1.1, table 1.
struct SensitivityTerm {
  double share;
  Kernel kernel;
};
enum class Opponent { achromatic, red_green, blue_yellow };
std::vector<SensitivityTerm> sensitivity_filter(Opponent channel, double pixels_per_degree);

/// Hunt-adjusted CIELAB of linear sRGB (section 4.1.2): a* and b* scaled by L* / 100.
std::array<double, 3> hunt_lab(const std::array<double, 3>& linear);
/// City-block in lightness plus Euclid in chroma (Abasi et al. 2019).
double hyab(const std::array<double, 3>& a, const std::array<double, 3>& b);
/// HyAB between pure green and pure blue, to the power 0.7: the largest distance in the gamut.
double largest_distance();
/// HyAB distance to colour error in [0, 1]: power 0.7, then two linear pieces (section 4.1.3).
double colour_error(double hyab_distance);
/// Start and stop exposure in stops: the curve brings maximum and median luminance of the reference to 0.85.
std::array<double, 2> exposure_range(const Image& reference);

} // namespace flip
} // namespace nacre
