#include "report/pictures.h"

#include "core/error.h"
#include "core/srgb.h"
#include "display/colormap.h"
#include "display/compare.h"
#include "display/tonemap.h"
#include "report/material_plots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

constexpr double displayed_key = 0.16; // of the log-average luminance

double luminance_at(const Image& image, std::size_t pixel) {
  const std::size_t n = image.channels.size();
  return luminance({image.data[pixel * n], image.data[pixel * n + 1], image.data[pixel * n + 2]});
}

double exposure_for(const Image& reference) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < reference.data.size() / reference.channels.size(); ++i) {
    const double y = luminance_at(reference, i);
    if (std::isfinite(y) && y > 1e-9) sum += std::log2(y), ++count;
  }
  return count == 0 ? 0 : std::log2(displayed_key) - sum / static_cast<double>(count);
}

Image decoded(Image coded) {
  for (float& v : coded.data)
    v = static_cast<float>(srgb_decode(v));
  return coded;
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve(bytes.size() / 3 * 4 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto at = [&](std::size_t k) { return i + k < bytes.size() ? std::uint32_t(bytes[i + k]) : 0u; };
    const std::uint32_t word = at(0) << 16 | at(1) << 8 | at(2);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k < bytes.size() + 1 ? digits[word >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

} // namespace

std::array<float, 3> signed_colour(double difference) {
  const double d = std::clamp(std::isfinite(difference) ? difference : 0.0, -1.0, 1.0);
  const double t = std::pow(std::abs(d), 0.7); // small differences are the interesting ones
  constexpr std::array<double, 3> zero{0.16, 0.16, 0.17}, above{1.0, 0.72, 0.25}, below{0.42, 0.80, 1.0};
  std::array<float, 3> code{};
  for (std::size_t c = 0; c < 3; ++c)
    code[c] = static_cast<float>(zero[c] + t * ((d > 0 ? above : below)[c] - zero[c]));
  return code;
}

ComparedPictures compare_for_display(const Image& picture, const Image& reference) {
  ComparedPictures result;
  ToneMapOptions tone;
  tone.operator_name = "narkowicz";
  tone.exposure_stops = result.exposure_stops = exposure_for(reference);
  result.reference = tone_map(reference, tone);
  result.picture = tone_map(picture, tone);

  const std::vector<std::string> measures{"rmse", "hdr-flip"};
  const Comparison linear = compare(picture, reference, measures);
  result.rmse = linear.values[0].value * std::exp2(result.exposure_stops);
  result.hdr_flip_mean = linear.values[1].value;

  // FLIP clips what the display would; the curve has already brought the pictures there.
  const Image shown = decoded(result.picture), shown_reference = decoded(result.reference);
  const FlipResult flip = ldr_flip(shown, shown_reference);
  result.flip_mean = flip.mean;
  result.flip = colour_map(flip.error);
  result.signed_luminance = Image(picture.width, picture.height, {"R", "G", "B"});
  for (std::size_t i = 0; i < result.signed_luminance.data.size() / 3; ++i) {
    const auto code =
        signed_colour((luminance_at(shown, i) - luminance_at(shown_reference, i)) / result.signed_range);
    std::copy(code.begin(), code.end(), result.signed_luminance.data.begin() + static_cast<long>(3 * i));
  }
  return result;
}

Image side_by_side(std::span<const Image> pictures, int gap, float grey) {
  if (pictures.empty()) throw Error("side by side: no picture");
  int width = gap * (static_cast<int>(pictures.size()) - 1);
  for (const Image& p : pictures) {
    if (p.height != pictures[0].height || p.channels.size() != 3)
      throw Error(fmt::format("side by side: expected {} rows of 3 channels, found {} of {}",
                              pictures[0].height, p.height, p.channels.size()));
    width += p.width;
  }
  Image out(width, pictures[0].height, {"R", "G", "B"});
  std::fill(out.data.begin(), out.data.end(), grey);
  int left = 0;
  for (const Image& p : pictures) {
    for (int y = 0; y < p.height; ++y)
      std::copy(p.at(0, y), p.at(0, y) + 3 * p.width, out.at(left, y));
    left += p.width + gap;
  }
  return out;
}

std::string png_data_url(const Image& picture) {
  return "data:image/png;base64," + base64(encode_png(picture));
}

} // namespace nacre
