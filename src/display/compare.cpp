#include "display/compare.h"

#include "core/error.h"
#include "core/srgb.h"
#include "display/rgb_planes.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace nacre {
namespace {

struct FinitePair {
  RgbPlanes picture, reference;
  std::vector<std::size_t> finite; ///< pixels where both are
};

FinitePair read_pair(const Image& picture, const Image& reference) {
  require_same_size(picture, reference, "the picture", "the reference");
  FinitePair pair{rgb_planes(picture, "the picture"), rgb_planes(reference, "the reference"), {}};
  for (std::size_t i = 0; i < pair.picture.plane[0].size(); ++i) {
    bool finite = true;
    for (int c = 0; c < 3; ++c)
      finite = finite && std::isfinite(pair.picture.plane[c][i]) && std::isfinite(pair.reference.plane[c][i]);
    if (finite) pair.finite.push_back(i);
  }
  return pair;
}

template <class F>
double pixel_mean(const FinitePair& pair, std::size_t pixel, F&& error) {
  double sum = 0;
  for (int c = 0; c < 3; ++c)
    sum += error(static_cast<double>(pair.picture.plane[c][pixel]),
                 static_cast<double>(pair.reference.plane[c][pixel]));
  return sum / 3;
}
template <class F>
double mean(const FinitePair& pair, F&& error) {
  double sum = 0;
  for (std::size_t i : pair.finite)
    sum += pixel_mean(pair, i, error);
  return sum / static_cast<double>(pair.finite.size());
}

double squared(double a, double b) { return (a - b) * (a - b); }
double absolute(double a, double b) { return std::abs(a - b); }
auto relative_squared(double epsilon) {
  return [epsilon](double a, double b) { return squared(a, b) / (b * b + epsilon); };
}
double squared_on_display(double a, double b) {
  return squared(srgb_encode(std::clamp(a, 0.0, 1.0)), srgb_encode(std::clamp(b, 0.0, 1.0)));
}

double trimmed_relative(const FinitePair& pair, const CompareOptions& options) {
  std::vector<double> errors;
  for (std::size_t i : pair.finite)
    errors.push_back(pixel_mean(pair, i, relative_squared(options.relative_epsilon)));
  const auto dropped = static_cast<std::size_t>(options.trimmed_share * static_cast<double>(errors.size()));
  std::nth_element(errors.begin(), errors.end() - dropped - 1, errors.end());
  errors.resize(errors.size() - dropped);
  std::sort(errors.begin(), errors.end()); // from small to large: one sum whatever the order of pixels
  double sum = 0;
  for (double e : errors)
    sum += e;
  return sum / static_cast<double>(errors.size());
}

void check_relative(const CompareOptions& options) {
  if (!(options.relative_epsilon > 0 && std::isfinite(options.relative_epsilon)))
    throw Error(fmt::format("relMSE: epsilon must be positive, found {}", options.relative_epsilon));
  if (!(options.trimmed_share >= 0 && options.trimmed_share < 1))
    throw Error(fmt::format("relMSE: the trimmed share must be in [0, 1), found {}", options.trimmed_share));
}

} // namespace

std::span<const ImageMetric> metrics() {
  static const std::vector<ImageMetric> list{
      {"mse", "mean squared error", "mean (a - b)^2"},
      {"rmse", "root of the mean squared error", "sqrt(mse)"},
      {"mae", "mean absolute error", "mean |a - b|"},
      {"bias", "mean signed error: light gained or lost", "mean (a - b)"},
      {"relmse", "squared error relative to the reference (Rousselle et al. 2011)",
       "mean (a - b)^2 / (b^2 + 0.01)"},
      {"relmse-trimmed",
       "the same without the 0.1 % of pixels of largest error, so that fireflies do not rule",
       "mean over the smallest 99.9 %"},
      {"psnr", "peak signal-to-noise ratio in dB as displayed: clipped to [0, 1] and sRGB-coded",
       "-10 log10(mean (code a - code b)^2)"},
      {"flip", "difference seen when alternating the two on a display, clipped to [0, 1]",
       "Andersson et al. 2020"},
      {"hdr-flip", "the largest such difference over all useful exposures", "Andersson et al. 2021"},
  };
  return list;
}

void check(std::span<const std::string> names, const CompareOptions& options) {
  check_relative(options);
  std::vector<std::string> known;
  for (const ImageMetric& m : metrics())
    known.push_back(m.name);
  for (const std::string& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error(fmt::format("compare: unknown measure '{}'{}", name, suggestion(name, known)));
}

Comparison compare(const Image& picture, const Image& reference, std::span<const std::string> names,
                   const CompareOptions& options) {
  check(names, options);
  const FinitePair pair = read_pair(picture, reference);
  Comparison result;
  result.pixels = pair.picture.plane[0].size();
  result.not_finite = result.pixels - pair.finite.size();
  if (pair.finite.empty()) throw Error("compare: the two pictures have no pixel in common that is finite");
  for (const std::string& name : names) {
    double value = 0;
    if (name == "mse")
      value = mean(pair, squared);
    else if (name == "rmse")
      value = std::sqrt(mean(pair, squared));
    else if (name == "mae")
      value = mean(pair, absolute);
    else if (name == "bias")
      value = mean(pair, [](double a, double b) { return a - b; });
    else if (name == "relmse")
      value = mean(pair, relative_squared(options.relative_epsilon));
    else if (name == "relmse-trimmed")
      value = trimmed_relative(pair, options);
    else if (name == "psnr")
      value = -10 * std::log10(mean(pair, squared_on_display));
    else if (name == "flip") {
      result.flip = ldr_flip(picture, reference, options.flip);
      value = result.flip->mean;
    } else if (name == "hdr-flip") {
      result.hdr_flip = hdr_flip(picture, reference, options.flip);
      value = result.hdr_flip->mean;
    }
    result.values.push_back({name, value});
  }
  return result;
}

Image error_map(const Image& picture, const Image& reference, PixelError kind,
                const CompareOptions& options) {
  check_relative(options);
  require_same_size(picture, reference, "the picture", "the reference");
  const FinitePair pair{rgb_planes(picture, "the picture"), rgb_planes(reference, "the reference"), {}};
  Image map(picture.width, picture.height, {"Y"});
  for (std::size_t i = 0; i < map.data.size(); ++i) {
    const double error = kind == PixelError::squared ? pixel_mean(pair, i, squared)
                         : kind == PixelError::absolute
                             ? pixel_mean(pair, i, absolute)
                             : pixel_mean(pair, i, relative_squared(options.relative_epsilon));
    map.data[i] = static_cast<float>(error);
  }
  return map;
}

Image difference(const Image& picture, const Image& reference) {
  require_same_size(picture, reference, "the picture", "the reference");
  const RgbPlanes a = rgb_planes(picture, "the picture"), b = rgb_planes(reference, "the reference");
  Image out(picture.width, picture.height, {"R", "G", "B"});
  for (std::size_t i = 0; i < a.plane[0].size(); ++i)
    for (int c = 0; c < 3; ++c)
      out.data[3 * i + c] = a.plane[c][i] - b.plane[c][i];
  return out;
}

} // namespace nacre
