#include "display/flip.h"

#include "core/error.h"
#include "core/srgb.h"
#include "display/colormap.h"
#include "spectra/cielab.h"
#include "uniform_image.h"

#include <algorithm>
#include <chrono>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace nacre {
namespace {

using ::testing::HasSubstr;

Image noise(int w, int h, std::uint32_t seed, float scale = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(0, scale);
  Image image(w, h, {"R", "G", "B"});
  for (float& v : image.data)
    v = value(random);
  return image;
}

// An independent reading of the 2020 paper: two-dimensional kernels, double precision, no separation.
struct Reference2d {
  int w, h;
  double density;
  using Plane = std::vector<double>;
  using Kernel2d = std::function<double(int, int)>;

  Plane filter(const Plane& in, int r, const Kernel2d& kernel) const {
    Plane out(in.size());
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        for (int j = -r; j <= r; ++j)
          for (int i = -r; i <= r; ++i)
            out[y * w + x] +=
                kernel(i, j) * in[std::clamp(y + j, 0, h - 1) * w + std::clamp(x + i, 0, w - 1)];
    return out;
  }
  /// Positive weights sum to 1, negative ones to -1.
  static Kernel2d balanced(int r, const Kernel2d& k) {
    double plus = 0, minus = 0;
    for (int j = -r; j <= r; ++j)
      for (int i = -r; i <= r; ++i)
        (k(i, j) > 0 ? plus : minus) += k(i, j);
    return [=](int i, int j) { return k(i, j) > 0 ? k(i, j) / plus : k(i, j) < 0 ? k(i, j) / -minus : 0; };
  }
  std::array<Plane, 5> perceive(const Image& image) const {
    const double pi = std::numbers::pi;
    std::array<Plane, 3> o;
    Plane grey;
    for (int i = 0; i < w * h; ++i) {
      const auto v = srgb_to_ycxcz({image.data[3 * i], image.data[3 * i + 1], image.data[3 * i + 2]});
      for (int c = 0; c < 3; ++c)
        o[c].push_back(v[c]);
      grey.push_back((v[0] + 16) / 116);
    }
    const int r = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * density));
    const double a1[] = {1, 1, 34.1}, b1[] = {0.0047, 0.0053, 0.04}, a2[] = {0, 0, 13.5},
                 b2[] = {1e-5, 1e-5, 0.025};
    for (int c = 0; c < 3; ++c)
      o[c] = filter(o[c], r, balanced(r, [&](int i, int j) {
                      const double d2 = (i * i + j * j) / (density * density);
                      return a1[c] * std::sqrt(pi / b1[c]) * std::exp(-pi * pi * d2 / b1[c]) +
                             a2[c] * std::sqrt(pi / b2[c]) * std::exp(-pi * pi * d2 / b2[c]);
                    }));
    std::array<Plane, 5> out;
    for (int i = 0; i < w * h; ++i) {
      RGB rgb = ycxcz_to_srgb({o[0][i], o[1][i], o[2][i]});
      for (double& v : rgb)
        v = std::clamp(v, 0.0, 1.0);
      const Lab lab = srgb_to_lab(rgb);
      out[0].push_back(lab[0]);
      out[1].push_back(lab[0] * lab[1] / 100);
      out[2].push_back(lab[0] * lab[2] / 100);
    }
    const double sd = 0.5 * 0.082 * density;
    const int fr = static_cast<int>(std::ceil(3 * sd));
    const auto g = [&](int i, int j) { return std::exp(-(i * i + j * j) / (2 * sd * sd)); };
    const auto pair = [&](const std::function<double(int, int)>& k) {
      const Plane x = filter(grey, fr, balanced(fr, [&](int i, int j) { return k(i, j); })),
                  y = filter(grey, fr, balanced(fr, [&](int i, int j) { return k(j, i); }));
      Plane m;
      for (int i = 0; i < w * h; ++i)
        m.push_back(std::hypot(x[i], y[i]));
      return m;
    };
    out[3] = pair([&](int i, int j) { return -i * g(i, j); });
    out[4] = pair([&](int i, int j) { return (i * i / (sd * sd) - 1) * g(i, j); });
    return out;
  }
  Plane flip(const Image& p, const Image& q) const {
    const auto a = perceive(p), b = perceive(q);
    const auto green = srgb_to_lab({0, 1, 0}), blue = srgb_to_lab({0, 0, 1});
    const double largest =
        std::pow(std::abs(green[0] - blue[0]) + std::hypot((green[0] * green[1] - blue[0] * blue[1]) / 100,
                                                           (green[0] * green[2] - blue[0] * blue[2]) / 100),
                 0.7);
    Plane out;
    for (int i = 0; i < w * h; ++i) {
      const double d =
          std::pow(std::abs(a[0][i] - b[0][i]) + std::hypot(a[1][i] - b[1][i], a[2][i] - b[2][i]), 0.7);
      const double knee = 0.4 * largest;
      const double colour = d < knee ? 0.95 * d / knee : 0.95 + 0.05 * (d - knee) / (largest - knee);
      const double feature = std::max(std::abs(a[3][i] - b[3][i]), std::abs(a[4][i] - b[4][i]));
      out.push_back(std::pow(colour, 1 - std::sqrt(feature / std::sqrt(2.0))));
    }
    return out;
  }
};

TEST(Cielab, WhiteAndBlackAreWhereTheyBelong) {
  const Lab white = srgb_to_lab({1, 1, 1}), black = srgb_to_lab({0, 0, 0}),
            grey = srgb_to_lab({0.18, 0.18, 0.18});
  EXPECT_NEAR(white[0], 100, 1e-10);
  EXPECT_NEAR(black[0], 0, 1e-10);
  EXPECT_NEAR(grey[0], 116 * std::cbrt(0.18) - 16, 1e-10); // 49.496
  for (const Lab& lab : {white, black, grey})
    EXPECT_NEAR(std::hypot(lab[1], lab[2]), 0, 1e-10);
}

TEST(Cielab, PrimariesHaveTheirPublishedCoordinates) {
  // Known for sRGB under D65 to one digit: red (53.2, 80.1, 67.2), green (87.7, -86.2, 83.2), blue
  // (32.3, 79.2, -107.9)
  const Lab known[] = {{53.2, 80.1, 67.2}, {87.7, -86.2, 83.2}, {32.3, 79.2, -107.9}};
  for (int c = 0; c < 3; ++c) {
    RGB rgb{0, 0, 0};
    rgb[c] = 1;
    const Lab lab = srgb_to_lab(rgb);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(lab[i], known[c][i], 0.06) << c << " " << i;
  }
}

TEST(Cielab, InversesUndo) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(0, 1);
  for (int k = 0; k < 100; ++k) {
    const RGB rgb{value(random), value(random), k % 10 ? value(random) : 0.001};
    const RGB a = xyz_to_srgb * lab_to_xyz(srgb_to_lab(rgb)), b = ycxcz_to_srgb(srgb_to_ycxcz(rgb));
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(a[i], rgb[i], 1e-12);
      EXPECT_NEAR(b[i], rgb[i], 1e-12);
    }
  }
}

TEST(FlipParts, SensitivityFiltersPassEvenPicturesUnchanged) {
  for (double density : {20.0, 67.0, 120.0})
    for (auto channel :
         {flip::Opponent::achromatic, flip::Opponent::red_green, flip::Opponent::blue_yellow}) {
      double sum = 0;
      for (const auto& term : flip::sensitivity_filter(channel, density)) {
        double weights = 0;
        for (float w : term.kernel.weights)
          weights += w;
        EXPECT_NEAR(weights, 1, 1e-6);
        sum += term.share * weights * weights;
      }
      EXPECT_NEAR(sum, 1, 1e-6);
    }
}

TEST(FlipParts, FeatureKernelsAnswerAStepAndNothingElse) {
  const Kernel slope = gaussian_slope_kernel(2.7, 9), curvature = gaussian_curvature_kernel(2.7, 9);
  for (const Kernel& k : {slope, curvature}) {
    double plus = 0, minus = 0;
    for (float w : k.weights)
      (w > 0 ? plus : minus) += w;
    EXPECT_NEAR(plus, 1, 1e-6);
    EXPECT_NEAR(minus, -1, 1e-6);
  }
  // A unit step, seen from its edge, is the sum over one half of the slope kernel: 1.
  double half = 0;
  for (int k = 1; k <= 9; ++k)
    half += slope.at(k);
  EXPECT_NEAR(std::abs(half), 1, 1e-6);
}

TEST(FlipParts, LargestDistanceFollowsFromGreenAndBlue) {
  // Green (87.73, -86.18, 83.18) becomes (87.73, -75.61, 72.97), blue (32.30, 79.19, -107.86) becomes (32.30,
  // 25.58, -34.84): 55.43 + hypot(101.19, 107.81) = 203.3, to the power 0.7: 41.3.
  EXPECT_NEAR(flip::largest_distance(), 41.3, 0.1);
  EXPECT_NEAR(flip::colour_error(flip::hyab(flip::hunt_lab({0, 1, 0}), flip::hunt_lab({0, 0, 1}))), 1, 1e-12);
}

TEST(FlipParts, ColourErrorBendsAtItsKnee) {
  const double knee = std::pow(0.4 * flip::largest_distance(), 1 / 0.7);
  EXPECT_EQ(flip::colour_error(0), 0);
  EXPECT_NEAR(flip::colour_error(knee), 0.95, 1e-9);
  EXPECT_NEAR(flip::colour_error(knee * std::pow(0.5, 1 / 0.7)), 0.475, 1e-9);
}

TEST(FlipParts, DefaultDensityIsThatOfThePapersDisplay) {
  EXPECT_DOUBLE_EQ(FlipOptions{}.pixels_per_degree, pixels_per_degree(0.7, 3840, 0.7));
  EXPECT_NEAR(FlipOptions{}.pixels_per_degree, 67, 0.03);
}

TEST(Flip, EqualPicturesDoNotDiffer) {
  const Image a = noise(40, 30, 1);
  EXPECT_EQ(ldr_flip(a, a).max, 0);
  EXPECT_EQ(hdr_flip(a, a).max, 0);
}

TEST(Flip, EvenPicturesDifferByColourAlone) {
  // Black and white: HyAB = 100, and 100^0.7 = 25.12 lies above the knee at 16.5.
  const double largest = flip::largest_distance();
  const double expected = 0.95 + 0.05 * (std::pow(100, 0.7) - 0.4 * largest) / (0.6 * largest);
  const FlipResult result = ldr_flip(uniform(33, 21, 0, 0, 0), uniform(33, 21, 1, 1, 1));
  EXPECT_NEAR(result.mean, expected, 1e-5);
  EXPECT_NEAR(expected, 0.967, 5e-4);
  for (float e : result.error.data)
    EXPECT_NEAR(e, expected, 1e-5);
  EXPECT_NEAR(ldr_flip(uniform(9, 9, 0, 1, 0), uniform(9, 9, 0, 0, 1)).mean, 1, 1e-4);
}

TEST(Flip, LdrIsSymmetric) {
  const Image a = noise(50, 41, 2), b = noise(50, 41, 3);
  EXPECT_EQ(ldr_flip(a, b).error.data, ldr_flip(b, a).error.data);
}

TEST(Flip, SeparableFiltersMatchTheDefinitionInTwoDimensions) {
  Image a = noise(37, 29, 4), b = a;
  for (int y = 0; y < 29; ++y) // smooth parts, an edge, a spot, and noise
    for (int x = 0; x < 37; ++x) {
      if (x < 20) std::fill_n(a.at(x, y), 3, 0.3f + 0.01f * y);
      std::copy_n(a.at(x, y), 3, b.at(x, y));
      if (x >= 8 && x < 12) b.at(x, y)[0] += 0.4f;
      if (x > 24) b.at(x, y)[2] *= 0.7f;
    }
  std::fill_n(b.at(15, 15), 3, 1.0f);
  for (double density : {20.0, 67.0}) {
    const auto expected = Reference2d{37, 29, density}.flip(a, b);
    FlipOptions options;
    options.pixels_per_degree = density;
    const FlipResult result = ldr_flip(a, b, options);
    // Floats carry L* near 100 to 1e-5; distances near 0 pass through d^0.7, which magnifies that.
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(result.error.data[i], expected[i], 2e-3) << i;
    double mean = 0;
    for (double e : expected)
      mean += e / static_cast<double>(expected.size());
    EXPECT_NEAR(result.mean, mean, 1e-4);
    EXPECT_GT(mean, 0.05);
  }
}

TEST(Flip, GrowsWithThePerturbation) {
  const Image a = uniform(40, 40, 0.4f, 0.4f, 0.4f);
  const Image pattern = noise(40, 40, 6);
  double last = 0;
  for (float amount : {0.01f, 0.03f, 0.1f, 0.3f}) {
    Image b = a;
    for (std::size_t i = 0; i < b.data.size(); ++i)
      b.data[i] += amount * pattern.data[i];
    const FlipResult result = ldr_flip(b, a);
    EXPECT_GT(result.mean, last);
    last = result.mean;
    for (float e : result.error.data)
      EXPECT_TRUE(e >= 0 && e <= 1);
  }
}

TEST(Flip, FineNoiseCountsLessSeenFromAfar) {
  const Image a = uniform(60, 60, 0.4f, 0.4f, 0.4f);
  Image b = noise(60, 60, 7);
  for (float& v : b.data)
    v = 0.3f + 0.2f * v;
  FlipOptions near, far;
  near.pixels_per_degree = 20;
  far.pixels_per_degree = 200;
  EXPECT_LT(ldr_flip(b, a, far).mean, 0.7 * ldr_flip(b, a, near).mean);
}

TEST(HdrFlip, ExposureRangeIsThatOfTheCurve) {
  // The curve (2.51 x^2 + 0.03 x) / (2.43 x^2 + 0.59 x + 0.14) at 0.6 x must give 0.85 at the maximum, at the
  // start, and at the median, at the stop.
  Image reference(3, 1, {"Y"});
  reference.data = {0.5f, 2, 64};
  const auto range = flip::exposure_range(reference);
  const auto curve = [](double x) {
    const double v = 0.6 * x;
    return v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14);
  };
  EXPECT_NEAR(curve(64 * std::exp2(range[0])), 0.85, 1e-9);
  EXPECT_NEAR(curve(2 * std::exp2(range[1])), 0.85, 1e-9);
  EXPECT_NEAR(range[1] - range[0], 5, 1e-6);
  const FlipResult result = hdr_flip(reference, reference);
  EXPECT_EQ(result.exposures, 5);
}

TEST(HdrFlip, ForgetsACommonScale) {
  const Image a = noise(30, 30, 8, 8), b = noise(30, 30, 9, 8);
  Image a2 = a, b2 = b;
  for (float& v : a2.data)
    v *= 1024;
  for (float& v : b2.data)
    v *= 1024;
  EXPECT_NEAR(hdr_flip(a, b).mean, hdr_flip(a2, b2).mean, 1e-5);
}

TEST(HdrFlip, SeesWhatOneExposureHides) {
  Image a = uniform(40, 40, 0.5f, 0.5f, 0.5f), b = a;
  for (int y = 10; y < 20; ++y)
    for (int x = 10; x < 20; ++x) {
      std::fill_n(a.at(x, y), 3, 50.0f);
      std::fill_n(b.at(x, y), 3, 400.0f);
    }
  EXPECT_EQ(ldr_flip(a, b).max, 0); // both white
  EXPECT_GT(hdr_flip(a, b).max, 0.5);
}

TEST(HdrFlip, IsTheLargestOfItsExposures) {
  const Image a = noise(30, 30, 10, 20), b = noise(30, 30, 11, 20);
  FlipOptions options;
  options.start_exposure = -3;
  options.stop_exposure = 1;
  options.exposures = 3;
  const FlipResult all = hdr_flip(a, b, options);
  Image largest(30, 30, {"Y"});
  options.exposures = 1;
  for (double stop : {-3.0, -1.0, 1.0}) {
    options.start_exposure = stop;
    options.stop_exposure = stop;
    const FlipResult one = hdr_flip(a, b, options);
    for (std::size_t i = 0; i < largest.data.size(); ++i)
      largest.data[i] = std::max(largest.data[i], one.error.data[i]);
  }
  EXPECT_EQ(all.error.data, largest.data);
}

TEST(Flip, WhatIsNotFiniteIsCountedAndHarmless) {
  Image a = noise(20, 20, 12), b = a;
  a.at(3, 4)[1] = std::numeric_limits<float>::quiet_NaN();
  b.at(7, 7)[0] = std::numeric_limits<float>::infinity();
  for (const FlipResult& result : {ldr_flip(a, b), hdr_flip(a, b)}) {
    EXPECT_EQ(result.not_finite, 2u);
    EXPECT_TRUE(std::isfinite(result.mean));
    EXPECT_GT(result.error.at(3, 4)[0], 0);
  }
}

TEST(Flip, ErrorsNameWhatIsWrong) {
  const auto message = [](auto&& f) -> std::string {
    try {
      f();
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  const Image a = noise(4, 3, 1), b = noise(3, 4, 1), black = uniform(2, 2, 0, 0, 0);
  EXPECT_THAT(message([&] { ldr_flip(a, b); }), HasSubstr("4 x 3"));
  EXPECT_THAT(message([&] { ldr_flip(a, b); }), HasSubstr("3 x 4"));
  EXPECT_THAT(message([&] { hdr_flip(black, black); }), HasSubstr("black"));
  FlipOptions options;
  options.pixels_per_degree = std::nan("");
  EXPECT_THAT(message([&] { ldr_flip(a, a, options); }), HasSubstr("pixels per degree"));
  options = {};
  options.start_exposure = 2;
  options.stop_exposure = 1;
  EXPECT_THAT(message([&] { hdr_flip(a, a, options); }), HasSubstr("low to high"));
}

TEST(Flip, OneMegapixelTakesLittleTime) {
  const Image a = noise(1024, 1024, 1), b = noise(1024, 1024, 2);
  const auto start = std::chrono::steady_clock::now();
  ldr_flip(a, b);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  RecordProperty("seconds", std::to_string(seconds));
  EXPECT_LT(seconds, 20); // generous: sanitizers and busy machines; 0.3 s on one idle core
}

TEST(ErrorColour, LightnessRisesEvenly) {
  double last = 0;
  for (int i = 0; i < 256; ++i) {
    const auto code = error_colour(static_cast<float>(i) / 255);
    const double lightness =
        srgb_to_lab({srgb_decode(code[0]), srgb_decode(code[1]), srgb_decode(code[2])})[0];
    EXPECT_NEAR(lightness, 4 + 92 * i / 255.0, 1e-3);
    EXPECT_GT(lightness, last);
    last = lightness;
  }
  EXPECT_EQ(error_colour(-1), error_colour(0));
  EXPECT_EQ(error_colour(2), error_colour(1));
}

} // namespace
} // namespace nacre
