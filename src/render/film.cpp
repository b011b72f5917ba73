#include "render/film.h"

#include "core/number.h"

namespace nacre {

FilmBuffer::FilmBuffer(int width, int height)
    : width_(width), height_(height), pixels_(std::size_t(width) * std::size_t(height)) {}

void FilmBuffer::add(int x, int y, const std::array<double, 3>& rgb) {
  Pixel& p = pixels_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
  for (std::size_t c = 0; c < 3; ++c)
    p[c].add(rgb[c]);
}

Image FilmBuffer::to_image(bool with_variance) const {
  std::vector<std::string> channels{"R", "G", "B"};
  if (with_variance) channels.insert(channels.end(), {"variance.R", "variance.G", "variance.B"});
  Image image(width_, height_, channels);
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const Pixel& p = at(x, y);
      float* out = image.at(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        out[c] = float(p[c].mean());
        if (with_variance) out[3 + c] = float(sqr(p[c].standard_error()));
      }
    }
  return image;
}

} // namespace nacre
