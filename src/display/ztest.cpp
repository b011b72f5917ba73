#include "display/ztest.h"

#include "core/error.h"
#include "core/statistics.h"
#include "display/rgb_planes.h"
#include "spectra/color_space.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace nacre {
namespace {

XYZ xyz_at(const RgbPlanes& planes, std::size_t pixel) {
  return srgb_to_xyz * RGB{planes.plane[0][pixel], planes.plane[1][pixel], planes.plane[2][pixel]};
}

} // namespace

ZTestResult z_test(const Image& picture, const Image& reference, const Image& variance_one_sample, int spp,
                   const ZTestOptions& options) {
  if (spp < 1) throw Error(fmt::format("z-test: expected at least one sample per pixel, found {}", spp));
  require_same_size(picture, reference, "z-test: the picture", "the reference");
  require_same_size(variance_one_sample, reference, "z-test: the variance", "the reference");
  const RgbPlanes a = rgb_planes(picture, "z-test: the picture"),
                  b = rgb_planes(reference, "z-test: the reference"),
                  v = rgb_planes(variance_one_sample, "z-test: the variance");
  const std::size_t pixels = a.plane[0].size();
  ZTestResult result;
  result.level = sidak_significance(options.significance, static_cast<int>(pixels));
  result.z = Image(picture.width, picture.height, {"X", "Y", "Z"});
  std::size_t accepted = 0, finite = 0;
  double squares = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const XYZ mean = xyz_at(a, i), expected = xyz_at(b, i), variance = xyz_at(v, i);
    for (int c = 0; c < 3; ++c) {
      // A variance that is no number accepts nothing.
      const double spread = std::isfinite(variance[c]) ? std::max(options.least_variance, variance[c])
                                                       : std::numeric_limits<double>::quiet_NaN();
      const double z = (mean[c] - expected[c]) * std::sqrt(spp / spread);
      result.z.data[3 * i + c] = static_cast<float>(z);
      accepted += normal_two_sided_p(z) > result.level;
      if (std::isfinite(z)) {
        squares += z * z;
        ++finite;
      }
      const double size = std::isnan(z) ? std::numeric_limits<double>::infinity() : std::abs(z);
      if (size > result.largest_z) {
        result.largest_z = size;
        result.worst_x = static_cast<int>(i % picture.width);
        result.worst_y = static_cast<int>(i / picture.width);
        result.worst_channel = c;
      }
    }
  }
  result.accepted_share = static_cast<double>(accepted) / static_cast<double>(3 * pixels);
  result.rms_z = finite ? std::sqrt(squares / static_cast<double>(finite)) : 0;
  result.pass = result.accepted_share >= options.required_share;
  return result;
}

} // namespace nacre
