#include "display/tonemap.h"

#include "core/error.h"
#include "core/srgb.h"
#include "display/tone_curves.h"
#include "uniform_image.h"

#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace nacre {
namespace {

using ::testing::HasSubstr;

/// Grey row of the given values.
Image grey_row(const std::vector<float>& values) {
  Image image(static_cast<int>(values.size()), 1, {"R", "G", "B"});
  for (std::size_t i = 0; i < values.size(); ++i)
    std::fill_n(image.data.begin() + 3 * i, 3, values[i]);
  return image;
}
Image log_normal_noise(int w, int h, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::lognormal_distribution<float> value(0, 2);
  Image image(w, h, {"R", "G", "B"});
  for (float& v : image.data)
    v = value(random);
  return image;
}
ToneMapOptions with(const std::string& name, std::map<std::string, double> parameters = {},
                    double stops = 0) {
  return {name, stops, std::move(parameters)};
}
std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(SrgbTransfer, HasTheValuesOfTheStandard) {
  EXPECT_EQ(srgb_encode(0), 0);
  EXPECT_NEAR(srgb_encode(1), 1, 1e-15);
  EXPECT_NEAR(srgb_encode(0.18), 0.461356, 1e-6); // 1.055 * 0.18^(1/2.4) - 0.055
  EXPECT_NEAR(srgb_decode(0.5), 0.214041, 1e-6);  // (0.555 / 1.055)^2.4
  EXPECT_DOUBLE_EQ(srgb_encode(0.001), 0.01292);
  EXPECT_NEAR(srgb_decode(128 / 255.0), 0.215861, 1e-6);
}

TEST(SrgbTransfer, InverseUndoesForward) {
  for (int i = 0; i <= 10000; ++i) {
    const double x = i / 10000.0;
    EXPECT_NEAR(srgb_decode(srgb_encode(x)), x, 3e-8) << x;
    if (i > 32) { // beyond the joint
      EXPECT_NEAR(srgb_decode(srgb_encode(x)), x, 1e-15) << x;
    }
  }
}

TEST(SrgbTransfer, IsContinuousToTheDigitsOfTheStandard) {
  const double joint = 0.0031308;
  EXPECT_NEAR(srgb_encode(joint), srgb_encode(std::nextafter(joint, 1.0)), 3e-8);
}

TEST(ToneCurves, ReinhardIsEquationFour) {
  for (double white : {0.5, 1.0, 3.0})
    for (double l : {0.0, 0.1, 1.0, 7.0}) {
      EXPECT_NEAR(reinhard_curve(l, white), l * (1 + l / (white * white)) / (1 + l), 1e-14);
      EXPECT_NEAR(reinhard_curve(white, white), 1, 1e-15);
    }
  EXPECT_NEAR(reinhard_curve(3, std::numeric_limits<double>::infinity()), 0.75, 1e-15); // eq. 3
}

TEST(ToneCurves, HableHasTheValuesOfItsConstants) {
  EXPECT_NEAR(hable_curve(0), 0, 1e-15);
  // At 1: (0.15 + 0.05 + 0.004) / (0.15 + 0.5 + 0.06) - 1/15 = 0.204 / 0.71 - 0.0666667.
  EXPECT_NEAR(hable_curve(1), 0.204 / 0.71 - 0.02 / 0.30, 1e-15);
}

TEST(ToneCurves, NarkowiczHasTheValuesOfItsConstants) {
  EXPECT_EQ(narkowicz_curve(0), 0);
  EXPECT_NEAR(narkowicz_curve(1), 2.54 / 3.16, 1e-15);
  // 0.08 x^2 - 0.56 x - 0.14 = 0
  const double full = (0.56 + std::sqrt(0.56 * 0.56 + 4 * 0.08 * 0.14)) / 0.16;
  EXPECT_NEAR(narkowicz_curve(full), 1, 1e-14);
  EXPECT_LT(narkowicz_curve(full - 0.01), 1);
  EXPECT_EQ(narkowicz_curve(full + 100), 1);
}

TEST(ToneMap, ClipIsTheTransferFunctionOfTheExposedPicture) {
  const Image out = tone_map(grey_row({0, 0.05f, 0.09f, 0.5f, 4}), with("clip", {}, 1));
  const double expected[] = {0, srgb_encode(0.1), srgb_encode(0.18), 1, 1};
  for (int x = 0; x < 5; ++x)
    EXPECT_NEAR(out.at(x, 0)[1], expected[x], 1e-6);
}

TEST(ToneMap, ReinhardBringsAnEvenPictureToItsKey) {
  // Even luminance: log average = luminance, so L = key, and eq. 3 gives key / (1 + key).
  for (double key : {0.09, 0.18, 0.72}) {
    const Image out = tone_map(uniform(5, 3, 40, 40, 40), with("reinhard", {{"key", key}, {"white", 1e20}}));
    EXPECT_NEAR(out.at(2, 1)[0], srgb_encode(key / (1 + key)), 1e-6);
  }
}

TEST(ToneMap, ReinhardMatchesTheEquationsByHand) {
  // Luminances 1 and 100: log average 10; scaled by 0.18 / 10: 0.018 and 1.8; white by default 1.8.
  const Image out = tone_map(grey_row({1, 100}), with("reinhard", {{"delta", 1e-12}}));
  EXPECT_NEAR(out.at(0, 0)[0], srgb_encode(0.018 * (1 + 0.018 / 3.24) / 1.018), 1e-6);
  EXPECT_NEAR(out.at(1, 0)[0], 1, 1e-6);
}

TEST(ToneMap, LogAverageCountsBlackByDelta) {
  TonePicture picture{2, 1, {{0, 0, 0}, {1, 1, 1}}, 1};
  EXPECT_NEAR(log_average_luminance(picture, 0.01), std::sqrt(0.01 * 1.01), 1e-9);
}

TEST(ToneMap, ReinhardForgetsTheScaleOfItsInput) {
  Image a = log_normal_noise(16, 16, 1), b = a;
  for (float& v : b.data)
    v *= 1024;
  for (const char* name : {"reinhard", "reinhard-local"}) {
    const Image x = tone_map(a, with(name, {{"delta", 1e-20}})),
                y = tone_map(b, with(name, {{"delta", 1e-20}}));
    for (std::size_t i = 0; i < x.data.size(); ++i)
      EXPECT_NEAR(x.data[i], y.data[i], 1e-5);
  }
}

TEST(ToneMap, ReinhardKeepsTheRatiosOfColour) {
  const Image in = uniform(2, 2, 0.2f, 0.4f, 0.1f);
  const Image out = tone_map(in, with("reinhard", {{"white", 1e20}}));
  const double r = srgb_decode(out.data[0]), g = srgb_decode(out.data[1]), b = srgb_decode(out.data[2]);
  EXPECT_NEAR(r / g, 0.5, 1e-5);
  EXPECT_NEAR(b / g, 0.25, 1e-5);
}

TEST(ToneMap, LocalReinhardOfAnEvenPictureIsTheGlobalOne) {
  const Image local = tone_map(uniform(40, 30, 7, 7, 7), with("reinhard-local")),
              global = tone_map(uniform(40, 30, 7, 7, 7), with("reinhard", {{"white", 1e20}}));
  for (std::size_t i = 0; i < local.data.size(); ++i)
    EXPECT_NEAR(local.data[i], global.data[i], 1e-5);
}

TEST(ToneMap, LocalReinhardKeepsMoreContrastInABrightRegion) {
  // Half dark, half bright with a fine chequer of 10 % in it: the surround of the bright half is bright, so
  // both its squares are divided by nearly the same, while the global curve divides the brighter one by more.
  Image in(128, 64, {"R", "G", "B"});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 128; ++x)
      std::fill_n(in.at(x, y), 3, x < 64 ? 0.02f : ((x + y) % 2 ? 20.0f : 22.0f));
  const Image local = tone_map(in, with("reinhard-local")),
              global = tone_map(in, with("reinhard", {{"white", 1e20}}));
  const auto contrast = [](const Image& i) {
    return srgb_decode(i.at(100, 32)[0]) / srgb_decode(i.at(101, 32)[0]);
  };
  EXPECT_LT(contrast(global), 1.06);
  EXPECT_GT(contrast(local), 1.09);
}

TEST(ToneMap, HableShowsItsWhitePointAsWhite) {
  const Image out = tone_map(grey_row({0, 1, 5.6f}), with("hable"));
  EXPECT_NEAR(out.at(0, 0)[0], 0, 1e-6);
  EXPECT_NEAR(out.at(1, 0)[0], srgb_encode(hable_curve(2) / hable_curve(11.2)), 1e-6);
  EXPECT_NEAR(out.at(2, 0)[0], 1, 1e-6);
}

TEST(ToneMap, EveryOperatorIsMonotoneInGreyAndStaysInRange) {
  std::vector<float> ramp;
  for (int i = 0; i < 400; ++i)
    ramp.push_back(std::pow(10.0f, -4 + 0.02f * i));
  for (const ToneOperator& op : tone_operators()) {
    if (op.name == "reinhard-local") continue; // depends on the surround
    const Image out = tone_map(grey_row(ramp), with(op.name));
    for (int x = 1; x < out.width; ++x) {
      EXPECT_GE(out.at(x, 0)[0], out.at(x - 1, 0)[0]) << op.name;
      EXPECT_LE(out.at(x, 0)[0], 1) << op.name;
    }
    EXPECT_GT(out.at(399, 0)[0], out.at(0, 0)[0] + 0.5f) << op.name;
  }
}

TEST(ToneMap, WhatIsNoLightIsCountedAndShownAsStated) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  Image in = grey_row({nan, inf, -inf, -1, 0.5f});
  in.at(4, 0)[2] = 0.25f;
  for (const ToneOperator& op : tone_operators()) {
    ToneMapReport report;
    const Image out = tone_map(in, with(op.name), &report);
    EXPECT_EQ(report.not_a_number, 1u) << op.name;
    EXPECT_EQ(report.infinite, 1u) << op.name;
    EXPECT_EQ(report.negative, 2u) << op.name;
    for (float v : out.data)
      EXPECT_TRUE(v >= 0 && v <= 1) << op.name << " " << v;
    for (int x : {0, 2, 3}) // black, but for the light that local adaptation does not add either
      EXPECT_EQ(out.at(x, 0)[0], 0) << op.name;
    EXPECT_GT(out.at(1, 0)[0], 0) << op.name;
  }
  const Image clip = tone_map(in, with("clip"));
  EXPECT_EQ(clip.at(1, 0)[0], clip.at(4, 0)[0]); // infinity shows as the largest finite value
}

TEST(ToneMap, ExtremeValuesAreNoTrouble) {
  const float huge = std::numeric_limits<float>::max(), tiny = std::numeric_limits<float>::denorm_min();
  for (const ToneOperator& op : tone_operators())
    for (double stops : {-100.0, 0.0, 100.0})
      for (float v : tone_map(grey_row({0, tiny, 1, huge}), with(op.name, {}, stops)).data)
        EXPECT_TRUE(v >= 0 && v <= 1) << op.name << " " << stops << " " << v;
  for (const ToneOperator& op : tone_operators()) // black, and one pixel
    EXPECT_EQ(tone_map(grey_row({0}), with(op.name)).data[0], 0) << op.name;
}

TEST(ToneMap, ClippedPixelsAreCounted) {
  ToneMapReport report;
  tone_map(grey_row({0.5f, 1, 1.5f, 2}), with("clip"), &report);
  EXPECT_EQ(report.clipped, 2u);
}

TEST(ToneMap, LuminanceAloneShowsAsGreyAndOtherChannelsAreIgnored) {
  Image y(1, 1, {"Y"}), rgba(1, 1, {"A", "B", "G", "R", "depth"});
  y.data = {0.25f};
  rgba.data = {1, 0.75f, 0.5f, 0.25f, 9};
  const Image grey = tone_map(y, with("clip")), colour = tone_map(rgba, with("clip"));
  EXPECT_EQ(grey.channels, (std::vector<std::string>{"R", "G", "B"}));
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(grey.data[c], srgb_encode(0.25), 1e-6);
    EXPECT_NEAR(colour.data[c], srgb_encode(0.25 * (c + 1)), 1e-6);
  }
}

TEST(ToneMap, ErrorsNameWhatIsWrong) {
  const Image in = uniform(1, 1, 1, 1, 1);
  EXPECT_THAT(message_of([&] { tone_map(in, with("reinhart")); }), HasSubstr("reinhard"));
  EXPECT_THAT(message_of([&] { tone_map(in, with("reinhard", {{"kye", 1}})); }), HasSubstr("key"));
  EXPECT_THAT(message_of([&] { tone_map(in, with("clip", {{"key", 1}})); }), HasSubstr("no parameters"));
  EXPECT_THAT(message_of([&] { tone_map(in, with("reinhard", {{"key", -1}})); }), HasSubstr("must be in"));
  EXPECT_THAT(message_of([&] {
                tone_map(in, with("reinhard", {{"key", std::nan("")}}));
              }),
              HasSubstr("must be in"));
  EXPECT_THAT(message_of([&] { tone_map(in, with("clip", {}, std::nan(""))); }), HasSubstr("exposure"));
  EXPECT_THAT(message_of([&] { tone_map(Image(1, 1, {"depth"}), {}); }), HasSubstr("depth"));
  EXPECT_THAT(message_of([&] { tone_map(Image(), {}); }), HasSubstr("not one pixel"));
}

TEST(ToneMap, EveryParameterHasItsDefaultInItsDomainAndIsUsed) {
  const Image in = log_normal_noise(24, 24, 3);
  for (const ToneOperator& op : tone_operators())
    for (const ToneParameter& p : op.parameters) {
      EXPECT_TRUE(p.value >= p.min && p.value <= p.max) << op.name << " " << p.name;
      const double other = p.name == "delta"   ? 1
                           : p.name == "white" ? 4
                           : p.name == "phi"   ? 0
                                               : p.value * 1.5;
      EXPECT_NE(tone_map(in, with(op.name)).data, tone_map(in, with(op.name, {{p.name, other}})).data)
          << op.name << " " << p.name;
    }
}

TEST(ToneMap, RealPhotographsUseTheRangeOfTheDisplay) {
  const std::string path = NACRE_SOURCE_DIR "/../shared/data/hdr/Desk.exr";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const Image in = read_exr(path);
  for (const ToneOperator& op : tone_operators()) {
    const Image out = tone_map(in, with(op.name));
    double sum = 0;
    for (float v : out.data) {
      ASSERT_TRUE(v >= 0 && v <= 1) << op.name;
      sum += v;
    }
    const double mean = sum / static_cast<double>(out.data.size());
    EXPECT_GT(mean, 0.1) << op.name;
    EXPECT_LT(mean, 0.8) << op.name;
  }
}

} // namespace
} // namespace nacre
