#pragma once
// JPEG files: pictures to look at, a seventh of the size of a PNG where there is noise. Not for measuring.

#include "core/image.h"

#include <string>

namespace nacre {

/// `image` has 1 or 3 channels already encoded for display in [0, 1], as write_png takes it.
/// @param quality  1 to 100; up to 90 colour has half the resolution
/// @throws Error
void write_jpeg(const Image& image, const std::string& path, int quality = 90);

} // namespace nacre
