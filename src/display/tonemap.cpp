#include "display/tonemap.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/srgb.h"
#include "display/convolution.h"
#include "display/rgb_planes.h"
#include "display/tone_curves.h"
#include "spectra/color_space.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

double luminance(const std::array<float, 3>& rgb) { return srgb_luminance({rgb[0], rgb[1], rgb[2]}); }

template <class F>
void for_each_pixel(TonePicture& picture, F&& f) {
  parallel_for(static_cast<std::size_t>(picture.height), [&](std::size_t y) {
    for (std::size_t i = y * picture.width, end = i + picture.width; i < end; ++i)
      f(i, picture.rgb[i]);
  });
}
template <class Curve>
void apply_per_channel(TonePicture& picture, Curve&& curve) {
  for_each_pixel(picture, [&](std::size_t, std::array<float, 3>& rgb) {
    for (float& v : rgb)
      v = static_cast<float>(curve(picture.exposure * v));
  });
}
void scale(std::array<float, 3>& rgb, double factor) {
  for (float& v : rgb)
    v = static_cast<float>(v * factor);
}
/// Eq. 2 of Reinhard 2002: the factor that brings the log-average luminance to the key, times the exposure.
double photographic_scale(const TonePicture& picture, double key, double delta) {
  return picture.exposure * key / log_average_luminance(picture, delta);
}

void clip(TonePicture& picture, std::span<const double>) {
  apply_per_channel(picture, [](double v) { return v; });
}

void reinhard(TonePicture& picture, std::span<const double> p) {
  const double to_key = photographic_scale(picture, p[0], p[2]);
  double white = p[1];
  if (white == 0) // the paper's default: the brightest pixel is just white
    for (const auto& rgb : picture.rgb)
      white = std::max(white, to_key * luminance(rgb));
  for_each_pixel(picture, [&](std::size_t, std::array<float, 3>& rgb) {
    const double world = luminance(rgb);
    if (world > 0) scale(rgb, reinhard_curve(to_key * world, white) / world);
  });
}

/// Reinhard 2002, section 3.2: each pixel is compressed by the average of the largest surround without strong
/// contrast.
void reinhard_local(TonePicture& picture, std::span<const double> p) {
  constexpr int scales = 8;
  constexpr double ratio = 1.6, alpha = 0.35; // section 3.2: alpha_1; alpha_2 is 1.6 times that
  const double key = p[0], sharpening = p[1], threshold = p[2];
  const double to_key = photographic_scale(picture, key, p[3]);
  std::vector<float> scaled(picture.rgb.size());
  for (std::size_t i = 0; i < scaled.size(); ++i)
    scaled[i] = static_cast<float>(std::min(1e30, to_key * luminance(picture.rgb[i])));
  const auto surround = [&](double s) { // eqs. 5 and 6: exp(-r^2 / (alpha s)^2)
    const double deviation = alpha * s / std::sqrt(2.0);
    const Kernel kernel = gaussian_kernel(deviation, std::max(1, static_cast<int>(std::ceil(3 * deviation))));
    return filter_columns(filter_rows(scaled, picture.width, picture.height, kernel), picture.width,
                          picture.height, kernel);
  };
  double s = 1;
  std::vector<float> centre = surround(s), adaptation = centre;
  std::vector<char> open(scaled.size(), 1);
  for (int i = 0; i < scales; ++i, s *= ratio) {
    std::vector<float> outer = surround(s * ratio); // the next scale's centre is this one's surround
    const double bias = std::exp2(sharpening) * key / (s * s);
    for (std::size_t k = 0; k < scaled.size(); ++k) {
      const double activity = (centre[k] - outer[k]) / (bias + centre[k]); // eq. 7
      if (open[k] && std::abs(activity) < threshold)
        adaptation[k] = centre[k];
      else
        open[k] = 0; // eq. 8
    }
    centre = std::move(outer);
  }
  for_each_pixel(picture, [&](std::size_t i, std::array<float, 3>& rgb) {
    scale(rgb, to_key / (1 + adaptation[i])); // eq. 9, colour kept by the ratio of luminances
  });
}

void hable(TonePicture& picture, std::span<const double> p) {
  const double bias = p[0], at_white = hable_curve(p[1]);
  apply_per_channel(picture, [&](double v) { return hable_curve(bias * v) / at_white; });
}

void narkowicz(TonePicture& picture, std::span<const double>) { apply_per_channel(picture, narkowicz_curve); }

const ToneParameter key_parameter{
    "key", "display value of the log-average luminance: 0.09 for a dark scene, 0.72 for a bright one", 1e-6,
    1e6, 0.18};
const ToneParameter delta_parameter{
    "delta", "added to each luminance before its logarithm, so that black counts", 1e-30, 1e30, 1e-5};

TonePicture read_colour(const Image& image, ToneMapReport& report) {
  const auto channels = rgb_channels(image, "tone mapping");
  TonePicture picture{image.width, image.height, {}, 1};
  picture.rgb.resize(static_cast<std::size_t>(image.width) * image.height);
  float largest = 0;
  for (std::size_t i = 0; i < picture.rgb.size(); ++i) {
    bool nan = false, infinite = false, negative = false;
    for (int c = 0; c < 3; ++c) {
      float v = image.data[i * image.channels.size() + channels[c]];
      nan |= std::isnan(v);
      negative |= v < 0;
      if (!(v > 0)) v = 0;
      if (std::isinf(v))
        infinite = true;
      else
        largest = std::max(largest, v);
      picture.rgb[i][c] = v;
    }
    report.not_a_number += nan;
    report.infinite += infinite;
    report.negative += negative;
  }
  if (report.infinite > 0)
    for (auto& rgb : picture.rgb)
      for (float& v : rgb)
        if (std::isinf(v)) v = largest > 0 ? largest : 1.0f;
  return picture;
}

std::vector<double> parameter_values(const ToneOperator& op, const std::map<std::string, double>& given) {
  std::vector<std::string> names;
  std::vector<double> values;
  for (const ToneParameter& p : op.parameters) {
    names.push_back(p.name);
    values.push_back(p.value);
  }
  for (const auto& [name, value] : given) {
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end())
      throw Error(names.empty() ? fmt::format("tone mapping: {} has no parameters, found '{}'", op.name, name)
                                : fmt::format("tone mapping: {} has no parameter '{}'{}", op.name, name,
                                              suggestion(name, names)));
    const ToneParameter& p = op.parameters[at - names.begin()];
    if (!(value >= p.min && value <= p.max))
      throw Error(fmt::format("tone mapping: {} of {} must be in [{}, {}], found {}", name, op.name, p.min,
                              p.max, value));
    values[at - names.begin()] = value;
  }
  return values;
}

const ToneOperator& find_operator(const std::string& name) {
  std::vector<std::string> names;
  for (const ToneOperator& op : tone_operators()) {
    if (op.name == name) return op;
    names.push_back(op.name);
  }
  throw Error(fmt::format("tone mapping: unknown operator '{}'{}", name, suggestion(name, names)));
}

} // namespace

std::span<const ToneOperator> tone_operators() {
  static const std::vector<ToneOperator> list{
      {"clip", "no curve: values above 1 are white", "IEC 61966-2-1", {}, clip},
      {"reinhard",
       "compresses luminance as L / (1 + L) about the picture's key, burning out above `white`",
       "Reinhard et al. 2002, eqs. 1-4",
       {key_parameter,
        {"white", "smallest scaled luminance shown as white; 0 takes the brightest pixel", 0, 1e30, 0},
        delta_parameter},
       reinhard},
      {"reinhard-local",
       "the same with dodging and burning: each pixel is compressed by its own surround",
       "Reinhard et al. 2002, eqs. 5-9",
       {key_parameter,
        {"phi", "sharpening: the larger, the less small contrasts hold back the growth of a surround", 0, 30,
         8},
        {"epsilon", "contrast that ends the growth of a surround", 1e-6, 1, 0.05},
        delta_parameter},
       reinhard_local},
      {"hable",
       "film curve with toe and shoulder, per channel",
       "Hable 2010, Uncharted 2",
       {{"bias", "exposure before the curve", 1e-6, 1e6, 2},
        {"white", "value after bias shown as white", 1e-3, 1e6, 11.2}},
       hable},
      {"narkowicz", "rational fit of the ACES film curve, per channel", "Narkowicz 2015", {}, narkowicz},
  };
  return list;
}

double log_average_luminance(const TonePicture& picture, double delta) {
  std::vector<double> row_sums(static_cast<std::size_t>(picture.height));
  parallel_for(row_sums.size(), [&](std::size_t y) {
    double sum = 0;
    for (std::size_t i = y * picture.width, end = i + picture.width; i < end; ++i)
      sum += std::log(delta + luminance(picture.rgb[i]));
    row_sums[y] = sum;
  });
  double sum = 0;
  for (double row : row_sums)
    sum += row;
  return std::exp(sum / static_cast<double>(picture.rgb.size()));
}

void check(const ToneMapOptions& options) {
  parameter_values(find_operator(options.operator_name), options.parameters);
  if (!(std::abs(options.exposure_stops) <= 100))
    throw Error(fmt::format("tone mapping: exposure must be within 100 stops of 0, found {}",
                            options.exposure_stops));
}

Image tone_map(const Image& picture, const ToneMapOptions& options, ToneMapReport* report) {
  check(options);
  const ToneOperator& op = find_operator(options.operator_name);
  const std::vector<double> parameters = parameter_values(op, options.parameters);
  ToneMapReport met;
  TonePicture colour = read_colour(picture, met);
  colour.exposure = std::exp2(options.exposure_stops);
  op.apply(colour, parameters);

  Image out(picture.width, picture.height, {"R", "G", "B"});
  std::vector<std::size_t> clipped(static_cast<std::size_t>(picture.height));
  for_each_pixel(colour, [&](std::size_t i, std::array<float, 3>& rgb) {
    bool over = false;
    for (int c = 0; c < 3; ++c) {
      over |= rgb[c] > 1.0f;
      out.data[3 * i + c] = static_cast<float>(srgb_encode(std::clamp(rgb[c], 0.0f, 1.0f)));
    }
    clipped[i / picture.width] += over;
  });
  for (std::size_t row : clipped)
    met.clipped += row;
  if (report) *report = met;
  return out;
}

} // namespace nacre
