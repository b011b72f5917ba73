#include "render/film.h"

#include "core/error.h"
#include "core/number.h"

#include <fmt/format.h>
#include <unistd.h>

namespace nacre {

FilmBuffer::FilmBuffer(int width, int height) : width_(width), height_(height) {
  const auto count = std::size_t(width) * std::size_t(height);
  // A system that promises more memory than it has ends the process at the last promise, without a word.
  const double memory = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGESIZE));
  const double needed = double(count) * (sizeof(Pixel) + 6 * sizeof(float));
  if (needed > memory)
    throw Error(fmt::format("a picture of {} x {} needs {:.0f} GB of memory, this machine has {:.0f}", width,
                            height, needed * 1e-9, memory * 1e-9));
  pixels_.resize(count);
}

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
