#pragma once
// The picture while it is made: per pixel the running mean and variance of its samples, linear sRGB.

#include "core/image.h"
#include "core/statistics.h"

#include <array>
#include <vector>

namespace nacre {

/// Pixels share nothing: different pixels may be written from different threads.
class FilmBuffer {
public:
  FilmBuffer(int width, int height);
  int width() const { return width_; }
  int height() const { return height_; }
  /// One more sample of pixel (x, y).
  void add(int x, int y, const std::array<double, 3>& rgb);
  std::uint64_t samples(int x, int y) const { return at(x, y)[0].count(); }

  /// Channels R, G, B: the means of the samples; with `with_variance` also variance.R, variance.G,
  /// variance.B: the estimated variance of those means (0 below two samples).
  Image to_image(bool with_variance) const;

private:
  using Pixel = std::array<RunningMoments, 3>;
  const Pixel& at(int x, int y) const {
    return pixels_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
  }
  int width_, height_;
  std::vector<Pixel> pixels_;
};

} // namespace nacre
