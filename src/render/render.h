#pragma once
// From a scene to a picture.

#include "core/image.h"
#include "scene/scene.h"

#include <cstdint>

namespace nacre {

struct RenderOptions {
  int samples_per_pixel = 0; ///< 0: as the scene says; with a time limit, as many as it allows
  std::uint64_t seed = 0;
  double time_limit_s = 0; ///< 0: none; else no new work begins after it
  bool variance = false;   ///< also give the variance of every pixel
  bool quiet = false;      ///< no progress on standard error
};

struct RenderResult {
  Image image; ///< linear sRGB: R, G, B, and with options.variance variance.R, variance.G, variance.B
  std::uint64_t samples = 0;         ///< paths, over all pixels
  std::uint64_t rays = 0;            ///< shadow rays included
  std::uint64_t invalid_samples = 0; ///< paths that gave infinity or NaN; they count as black
  double seconds = 0;                ///< building the acceleration structure included
  bool complete = true;              ///< all samples asked for were taken
};

/// Renders with the scene's integrator. A path is a function of (scene, pixel, sample, seed) alone, so the
/// picture does not depend on the number of threads. Passes over the whole picture refine it; when
/// stop_requested() or at the time limit what is done is returned, and pixels may then differ in their number
/// of samples.
/// @throws Error if the scene cannot be rendered
RenderResult render(const Scene& scene, const RenderOptions& options);

} // namespace nacre
