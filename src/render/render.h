#pragma once
// From a scene to a picture.

#include "core/image.h"
#include "scene/scene.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace nacre {

class FilmBuffer;
struct World;

struct RenderOptions {
  int samples_per_pixel = 0; ///< 0: as the scene says; with a time limit, as many as it allows
  std::uint64_t seed = 0;
  double time_limit_s = 0; ///< 0: none; else no new work begins after it
  bool variance = false;   ///< also give the variance of every pixel
  bool quiet = false;      ///< no progress on standard error
  /// Called between passes with the picture so far and its samples a pixel.
  std::function<void(const FilmBuffer&, int samples_per_pixel)> on_pass = {};
  /// Asked between units of work from many threads, as stop_requested() is: true ends the render.
  std::function<bool()> stopped = {};
};

struct RenderResult {
  Image image; ///< linear sRGB: R, G, B, and with options.variance variance.R, variance.G, variance.B
  std::uint64_t samples = 0;         ///< paths, over all pixels
  std::uint64_t rays = 0;            ///< shadow rays included
  std::uint64_t invalid_samples = 0; ///< paths that gave infinity or NaN; they count as black
  double seconds = 0;                ///< building the acceleration structure included
  bool complete = true;              ///< all samples asked for were taken
};

/// What arrives at a pixel over the wavelength, in bands of equal width.
struct PixelSpectrum {
  std::vector<double> wavelength_nm; ///< centres of the bands
  std::vector<double> radiance;      ///< means over the bands, W/(m^2 sr nm) where the scene is in such units
  std::array<double, 3> xyz{};       ///< CIE 1931
};

/// A scene prepared once for several renders.
class Renderer {
public:
  /// Keeps a reference to the scene. @throws Error if the scene cannot be rendered
  explicit Renderer(const Scene& scene);
  ~Renderer();

  /// As `render` below.
  RenderResult render(const RenderOptions& options) const;
  /// @param samples  paths, of four wavelengths each. @throws Error for a pixel outside the picture
  PixelSpectrum spectrum(int x, int y, int samples, int bands = 40) const;
  /// Index of the material that the centre of a pixel shows, or -1. @throws Error as above
  int material_at(int x, int y) const;

private:
  const Scene& scene_;
  std::unique_ptr<const World> world_;
};

/// Renders with the scene's integrator. A path is a function of (scene, pixel, sample, seed) alone, so the
/// picture does not depend on the number of threads. Passes over the whole picture refine it; when
/// stop_requested() or at the time limit what is done is returned, and pixels may then differ in their number
/// of samples.
/// @throws Error if the scene cannot be rendered
RenderResult render(const Scene& scene, const RenderOptions& options);

} // namespace nacre
