#include "display/flip.h"

#include "core/error.h"
#include "core/parallel.h"
#include "display/rgb_planes.h"
#include "display/tone_curves.h"
#include "spectra/cielab.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace nacre {
namespace {

constexpr double q_c = 0.7, p_c = 0.4, p_t = 0.95; // colour: exponent and knee, section 4.1.3
constexpr double feature_width_deg = 0.082;        // width w of a detector, section 4.2.1
constexpr double q_f = 0.5;                        // features: exponent, section 4.2.2

using Planes = std::array<std::vector<float>, 3>;

/// What of one picture is compared.
struct Percept {
  Planes lab;                     ///< filtered, Hunt-adjusted
  std::vector<float> edge, point; ///< strength of features
};

std::vector<float> filtered(const std::vector<float>& in, int w, int h, const Kernel& rows,
                            const Kernel& columns) {
  return filter_columns(filter_rows(in, w, h, rows), w, h, columns);
}

Planes contrast_filtered(const Planes& ycxcz, int w, int h, double density) {
  Planes out;
  for (int c = 0; c < 3; ++c)
    for (const auto& term : flip::sensitivity_filter(static_cast<flip::Opponent>(c), density)) {
      std::vector<float> part = filtered(ycxcz[c], w, h, term.kernel, term.kernel);
      out[c].resize(part.size());
      for (std::size_t i = 0; i < part.size(); ++i)
        out[c][i] += static_cast<float>(term.share) * part[i];
    }
  return out;
}

std::vector<float> magnitude(const std::vector<float>& x, const std::vector<float>& y) {
  std::vector<float> out(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    out[i] = std::sqrt(x[i] * x[i] + y[i] * y[i]);
  return out;
}

/// `display` holds display-linear sRGB in [0, 1].
Percept perceive(const Planes& display, int w, int h, double density) {
  const std::size_t pixels = display[0].size();
  Planes ycxcz;
  for (auto& plane : ycxcz)
    plane.resize(pixels);
  std::vector<float> grey(pixels);
  parallel_for(static_cast<std::size_t>(h), [&](std::size_t y) {
    for (std::size_t i = y * w; i < (y + 1) * w; ++i) {
      const auto v = srgb_to_ycxcz({display[0][i], display[1][i], display[2][i]});
      for (int c = 0; c < 3; ++c)
        ycxcz[c][i] = static_cast<float>(v[c]);
      grey[i] = static_cast<float>((v[0] + 16) / 116);
    }
  });

  Percept percept;
  percept.lab = contrast_filtered(ycxcz, w, h, density);
  parallel_for(static_cast<std::size_t>(h), [&](std::size_t y) {
    for (std::size_t i = y * w; i < (y + 1) * w; ++i) {
      RGB rgb = ycxcz_to_srgb({percept.lab[0][i], percept.lab[1][i], percept.lab[2][i]});
      for (double& v : rgb)
        v = std::clamp(v, 0.0, 1.0);
      const auto lab = flip::hunt_lab(rgb);
      for (int c = 0; c < 3; ++c)
        percept.lab[c][i] = static_cast<float>(lab[c]);
    }
  });

  const double deviation = 0.5 * feature_width_deg * density;
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  const Kernel smooth = gaussian_kernel(deviation, radius), slope = gaussian_slope_kernel(deviation, radius),
               curvature = gaussian_curvature_kernel(deviation, radius);
  percept.edge = magnitude(filtered(grey, w, h, slope, smooth), filtered(grey, w, h, smooth, slope));
  percept.point = magnitude(filtered(grey, w, h, curvature, smooth), filtered(grey, w, h, smooth, curvature));
  return percept;
}

/// error = max(error, FLIP of the two percepts), pixel by pixel.
void raise_to_difference(std::vector<float>& error, const Percept& a, const Percept& b, int w, int h) {
  parallel_for(static_cast<std::size_t>(h), [&](std::size_t y) {
    for (std::size_t i = y * w; i < (y + 1) * w; ++i) {
      const double colour = flip::colour_error(
          flip::hyab({a.lab[0][i], a.lab[1][i], a.lab[2][i]}, {b.lab[0][i], b.lab[1][i], b.lab[2][i]}));
      if (colour == 0) continue; // 0 to any power below 1
      const double feature = std::max(std::abs(a.edge[i] - b.edge[i]), std::abs(a.point[i] - b.point[i]));
      const double feature_error = std::min(1.0, std::pow(feature / std::numbers::sqrt2, q_f));
      error[i] = std::max(error[i], static_cast<float>(std::pow(colour, 1 - feature_error)));
    }
  });
}

/// Non-negative and finite, with a count of the pixels that were not finite.
RgbPlanes readable_planes(const Image& image, const std::string& what, std::vector<char>& not_finite) {
  RgbPlanes planes = rgb_planes(image, what);
  for (auto& plane : planes.plane)
    for (std::size_t i = 0; i < plane.size(); ++i) {
      if (!std::isfinite(plane[i])) not_finite[i] = 1;
      plane[i] = plane[i] > 0 ? std::min(plane[i], std::numeric_limits<float>::max()) : 0.0f;
    }
  return planes;
}

template <class Display>
Planes displayed(const RgbPlanes& planes, Display&& display) {
  Planes out = planes.plane;
  for (auto& plane : out)
    parallel_for(static_cast<std::size_t>(planes.height), [&](std::size_t y) {
      for (std::size_t i = y * planes.width; i < (y + 1) * planes.width; ++i)
        plane[i] = static_cast<float>(display(plane[i]));
    });
  return out;
}

struct Pair {
  RgbPlanes picture, reference;
  std::size_t not_finite = 0;
};
Pair readable_pair(const Image& picture, const Image& reference, const FlipOptions& options) {
  require_same_size(picture, reference, "FLIP: the picture", "the reference");
  if (!(options.pixels_per_degree >= 1 && options.pixels_per_degree <= 1000))
    throw Error(
        fmt::format("FLIP: pixels per degree must be in [1, 1000], found {}", options.pixels_per_degree));
  std::vector<char> bad(static_cast<std::size_t>(std::max(0, picture.width)) * std::max(0, picture.height));
  Pair pair{readable_planes(picture, "FLIP: the picture", bad),
            readable_planes(reference, "FLIP: the reference", bad), 0};
  pair.not_finite = std::count(bad.begin(), bad.end(), 1);
  return pair;
}

void summarise(FlipResult& result) {
  double sum = 0;
  for (float e : result.error.data) {
    sum += e;
    result.max = std::max<double>(result.max, e);
  }
  result.mean = sum / static_cast<double>(result.error.data.size());
}

} // namespace

namespace flip {

std::vector<SensitivityTerm> sensitivity_filter(Opponent channel, double density) {
  // Table 1: amplitude a and spread b (deg^2) of two Gaussians in frequency for each channel.
  struct Term {
    double a, b;
  };
  constexpr Term table[3][2] = {
      {{1, 0.0047}, {0, 1e-5}}, {{1, 0.0053}, {0, 1e-5}}, {{34.1, 0.04}, {13.5, 0.025}}};
  constexpr double pi = std::numbers::pi, widest = 0.04;
  // All channels use the window of the widest Gaussian, three deviations.
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(widest / (2 * pi * pi)) * density));
  std::vector<SensitivityTerm> terms;
  double total = 0;
  for (const Term& t : table[static_cast<int>(channel)]) {
    if (t.a == 0) continue;
    // In space: a sqrt(pi / b) exp(-pi^2 r^2 / b), r in degrees.
    const double deviation = std::sqrt(t.b / (2 * pi * pi)) * density;
    double sum = 0;
    for (int k = -radius; k <= radius; ++k)
      sum += std::exp(-0.5 * k * k / (deviation * deviation));
    terms.push_back({t.a * std::sqrt(pi / t.b) * sum * sum, gaussian_kernel(deviation, radius)});
    total += terms.back().share;
  }
  for (auto& term : terms)
    term.share /= total;
  return terms;
}

std::array<double, 3> hunt_lab(const std::array<double, 3>& linear) {
  const Lab lab = srgb_to_lab(linear);
  return {lab[0], 0.01 * lab[0] * lab[1], 0.01 * lab[0] * lab[2]};
}

double hyab(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  const double da = a[1] - b[1], db = a[2] - b[2];
  return std::abs(a[0] - b[0]) + std::sqrt(da * da + db * db);
}

double largest_distance() {
  static const double distance = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), q_c);
  return distance;
}

double colour_error(double hyab_distance) {
  const double distance = std::pow(hyab_distance, q_c), largest = largest_distance(), knee = p_c * largest;
  if (distance < knee) return p_t / knee * distance;
  return std::min(1.0, p_t + (distance - knee) / (largest - knee) * (1 - p_t));
}

std::array<double, 2> exposure_range(const Image& reference) {
  const RgbPlanes planes = rgb_planes(reference, "FLIP: the reference");
  std::vector<double> luminances;
  for (std::size_t i = 0; i < planes.plane[0].size(); ++i) {
    const double y = srgb_luminance({planes.plane[0][i], planes.plane[1][i], planes.plane[2][i]});
    luminances.push_back(std::isfinite(y) ? std::max(0.0, y) : 0.0);
  }
  // 0.85 on the curve y = x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14) of 0.6 x: the larger root.
  constexpr double target = 0.85, a = 2.51 - target * 2.43, b = 0.03 - target * 0.59, c = -target * 0.14;
  const double x = (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a) / 0.6;
  const double brightest = *std::max_element(luminances.begin(), luminances.end());
  if (!(brightest > 0))
    throw Error("FLIP: the reference is black, so the range of exposures must be given "
                "(--start-exposure, --stop-exposure), or another --metric");
  const auto median_of = [](std::vector<double>& v) {
    const auto middle = v.begin() + v.size() / 2;
    std::nth_element(v.begin(), middle, v.end());
    return *middle;
  };
  double median = median_of(luminances);
  if (median == 0) { // more than half is black: the median of what is not
    std::erase(luminances, 0.0);
    median = median_of(luminances);
  }
  return {std::log2(x / brightest), std::log2(x / median)};
}

} // namespace flip

double pixels_per_degree(double distance_m, double width_pixels, double width_m) {
  return distance_m * width_pixels / width_m * std::numbers::pi / 180;
}

FlipResult ldr_flip(const Image& picture, const Image& reference, const FlipOptions& options) {
  const Pair pair = readable_pair(picture, reference, options);
  const int w = picture.width, h = picture.height;
  const auto percept = [&](const RgbPlanes& planes) {
    return perceive(displayed(planes, [](float v) { return std::min(v, 1.0f); }), w, h,
                    options.pixels_per_degree);
  };
  FlipResult result{Image(w, h, {"Y"}), 0, 0, 0, 0, 1, pair.not_finite};
  raise_to_difference(result.error.data, percept(pair.picture), percept(pair.reference), w, h);
  summarise(result);
  return result;
}

FlipResult hdr_flip(const Image& picture, const Image& reference, const FlipOptions& options) {
  const Pair pair = readable_pair(picture, reference, options);
  const int w = picture.width, h = picture.height;
  FlipResult result{Image(w, h, {"Y"}), 0, 0, 0, 0, 1, pair.not_finite};
  if (options.start_exposure && options.stop_exposure) {
    result.start_exposure = *options.start_exposure;
    result.stop_exposure = *options.stop_exposure;
  } else {
    const auto range = flip::exposure_range(reference);
    result.start_exposure = options.start_exposure.value_or(range[0]);
    result.stop_exposure = options.stop_exposure.value_or(range[1]);
  }
  const double span = result.stop_exposure - result.start_exposure;
  if (!(span >= 0 && span <= 1000))
    throw Error(fmt::format("FLIP: exposures must run from low to high, found {} to {} stops",
                            result.start_exposure, result.stop_exposure));
  result.exposures = options.exposures.value_or(std::max(2, static_cast<int>(std::ceil(span))));
  if (result.exposures < 1 || result.exposures > 1000)
    throw Error(fmt::format("FLIP: expected 1 to 1000 exposures, found {}", result.exposures));
  for (int i = 0; i < result.exposures; ++i) {
    const double stops =
        result.start_exposure + (result.exposures > 1 ? span * i / (result.exposures - 1) : 0);
    // Narkowicz: 0.6 makes the fit agree with ACES, whose exposure it otherwise leaves out.
    const double factor = 0.6 * std::exp2(stops);
    const auto percept = [&](const RgbPlanes& planes) {
      return perceive(displayed(planes, [&](float v) { return narkowicz_curve(factor * v); }), w, h,
                      options.pixels_per_degree);
    };
    raise_to_difference(result.error.data, percept(pair.picture), percept(pair.reference), w, h);
  }
  summarise(result);
  return result;
}

} // namespace nacre
