#pragma once
// An image of one colour.

#include "core/image.h"

namespace nacre {

inline Image uniform(int w, int h, float r, float g, float b) {
  Image image(w, h, {"R", "G", "B"});
  for (std::size_t i = 0; i < image.data.size(); i += 3) {
    image.data[i] = r;
    image.data[i + 1] = g;
    image.data[i + 2] = b;
  }
  return image;
}

} // namespace nacre
