#include "display/compare.h"

#include "core/error.h"
#include "core/srgb.h"
#include "display/ztest.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace nacre {
namespace {

using ::testing::HasSubstr;

double measure(const std::string& name, const Image& a, const Image& b) {
  return compare(a, b, std::vector<std::string>{name}).values.at(0).value;
}
Image pixels(std::vector<float> data) {
  Image image(static_cast<int>(data.size() / 3), 1, {"R", "G", "B"});
  image.data = std::move(data);
  return image;
}
Image filled(int w, int h, float value) {
  Image image(w, h, {"R", "G", "B"});
  std::fill(image.data.begin(), image.data.end(), value);
  return image;
}
std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(Compare, MeasuresMatchTheirDefinitionsByHand) {
  const Image a = pixels({1, 2, 3, 0, 0, 0}), b = pixels({1, 0, 2, 0, 1, 3});
  // differences 0 2 1 0 -1 -3
  EXPECT_DOUBLE_EQ(measure("mse", a, b), 15.0 / 6);
  EXPECT_DOUBLE_EQ(measure("rmse", a, b), std::sqrt(15.0 / 6));
  EXPECT_DOUBLE_EQ(measure("mae", a, b), 7.0 / 6);
  EXPECT_DOUBLE_EQ(measure("bias", a, b), -1.0 / 6);
  EXPECT_NEAR(measure("relmse", a, b), (4 / 0.01 + 1 / 4.01 + 1 / 1.01 + 9 / 9.01) / 6, 1e-12);
}

TEST(Compare, PsnrIsOfTheDisplayedPicture) {
  const Image a = filled(3, 2, 0.5f), b = filled(3, 2, 0.25f);
  EXPECT_NEAR(measure("psnr", a, b), -20 * std::log10(srgb_encode(0.5) - srgb_encode(0.25)), 1e-9);
  EXPECT_NEAR(measure("psnr", filled(2, 2, 7), filled(2, 2, 0)), 0, 1e-9); // white against black
  EXPECT_TRUE(std::isinf(measure("psnr", a, a)));
}

TEST(Compare, EqualPicturesHaveNoError) {
  const Image a = pixels({1, 2, 3, 4, 5, 6});
  for (const char* name : {"mse", "rmse", "mae", "bias", "relmse", "relmse-trimmed", "flip", "hdr-flip"})
    EXPECT_EQ(measure(name, a, a), 0) << name;
}

TEST(Compare, TrimmingDropsFirefliesAndNothingElse) {
  Image a = filled(100, 20, 1.1f), b = filled(100, 20, 1);
  const double one = 0.01 / 1.01; // (0.1)^2 / (1 + 0.01)
  EXPECT_NEAR(measure("relmse", a, b), one, 1e-7);
  EXPECT_NEAR(measure("relmse-trimmed", a, b), one, 1e-7);
  std::fill_n(a.at(50, 10), 3, 1e4f);
  std::fill_n(a.at(7, 3), 3, 1e5f); // 2 of 2000 pixels: exactly the share dropped
  EXPECT_GT(measure("relmse", a, b), 1e5);
  EXPECT_NEAR(measure("relmse-trimmed", a, b), one, 1e-7);
  std::fill_n(a.at(8, 3), 3, 1e5f);
  EXPECT_GT(measure("relmse-trimmed", a, b), 1e3);
}

TEST(Compare, MeanOfAnErrorMapIsItsMeasure) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(0, 3);
  Image a(31, 17, {"R", "G", "B"}), b = a;
  for (float& v : a.data)
    v = value(random);
  for (float& v : b.data)
    v = value(random);
  const std::pair<PixelError, const char*> kinds[] = {
      {PixelError::squared, "mse"}, {PixelError::absolute, "mae"}, {PixelError::relative_squared, "relmse"}};
  for (const auto& [kind, name] : kinds) {
    double sum = 0;
    const Image map = error_map(a, b, kind);
    for (float e : map.data)
      sum += e;
    const double expected = measure(name, a, b);
    EXPECT_NEAR(sum / static_cast<double>(map.data.size()), expected, 1e-6 * expected) << name;
  }
  const Image d = difference(a, b);
  EXPECT_FLOAT_EQ(d.at(4, 5)[2], a.at(4, 5)[2] - b.at(4, 5)[2]);
}

TEST(Compare, PixelsThatAreNotFiniteAreLeftOutAndCounted) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const Image a = pixels({1, 1, 1, nan, 1, 1, 1, 1, 1}), b = pixels({2, 2, 2, 9, 9, 9, 1, inf, 1});
  const std::vector<std::string> names{"mse", "relmse-trimmed"};
  const Comparison result = compare(a, b, names);
  EXPECT_EQ(result.pixels, 3u);
  EXPECT_EQ(result.not_finite, 2u);
  EXPECT_EQ(result.values[0].value, 1);
  EXPECT_TRUE(std::isfinite(result.values[1].value));
  const Image none = pixels({nan, nan, nan});
  EXPECT_THAT(message_of([&] { compare(none, none, names); }), HasSubstr("no pixel"));
}

TEST(Compare, ChannelsMayComeInAnyOrderAndOthersDoNotCount) {
  Image a(1, 1, {"A", "B", "G", "R"});
  a.data = {0.5f, 3, 2, 1};
  EXPECT_EQ(measure("mse", a, pixels({1, 2, 3})), 0);
}

TEST(Compare, ErrorsNameWhatIsWrong) {
  const Image a = filled(4, 3, 1), b = filled(5, 3, 1);
  const std::string sizes = message_of([&] { measure("mse", a, b); });
  EXPECT_THAT(sizes, HasSubstr("4 x 3"));
  EXPECT_THAT(sizes, HasSubstr("5 x 3"));
  EXPECT_THAT(message_of([&] { measure("rsme", a, a); }), HasSubstr("rmse"));
  EXPECT_THAT(message_of([&] { measure("mse", Image(1, 1, {"Z"}), a); }), HasSubstr("1 x 1"));
  EXPECT_THAT(message_of([&] { measure("mse", Image(4, 3, {"Z"}), a); }), HasSubstr("R, G, B"));
  CompareOptions options;
  options.relative_epsilon = 0;
  EXPECT_THAT(message_of([&] { compare(a, a, std::vector<std::string>{"relmse"}, options); }),
              HasSubstr("epsilon"));
}

TEST(Compare, EveryListedMeasureIsComputed) {
  const Image a = filled(8, 8, 0.5f), b = filled(8, 8, 0.6f);
  for (const ImageMetric& m : metrics())
    EXPECT_TRUE(std::isfinite(measure(m.name, a, b)) && measure(m.name, a, b) != 0) << m.name;
}

/// Mean of `spp` normal samples of deviation `deviation` per pixel about `reference`, in Y alone so that
/// every channel of XYZ carries the same relative noise.
Image noisy(const Image& reference, double deviation, int spp, std::uint32_t seed, float shift = 0) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(shift, static_cast<float>(deviation / std::sqrt(spp)));
  Image out = reference;
  for (std::size_t i = 0; i < out.data.size(); i += 3) {
    const float n = noise(random);
    for (int c = 0; c < 3; ++c)
      out.data[i + c] += n;
  }
  return out;
}

TEST(ZTest, ZOfLuminanceIsByHand) {
  // Grey: Y = value and its variance as given: z = (1.3 - 1) sqrt(16 / 0.09) = 4.
  const ZTestResult result = z_test(filled(2, 2, 1.3f), filled(2, 2, 1), filled(2, 2, 0.09f), 16);
  EXPECT_NEAR(result.z.at(1, 1)[1], 4, 1e-5);
  EXPECT_NEAR(result.level, 1 - std::pow(0.99, 0.25), 1e-12);
  EXPECT_EQ(result.accepted_share, 0); // p(4) = 6e-5 against a level of 0.0025
  EXPECT_EQ(z_test(filled(2, 2, 1.15f), filled(2, 2, 1), filled(2, 2, 0.09f), 16).accepted_share,
            1); // p(2) = 0.046
}

TEST(ZTest, AcceptsADrawAndRejectsABias) {
  const Image reference = filled(64, 64, 1), variance = filled(64, 64, 0.25f);
  const ZTestResult fair = z_test(noisy(reference, 0.5, 100, 1), reference, variance, 100);
  EXPECT_TRUE(fair.pass);
  // Under the hypothesis 1 % of all pictures have any rejected pixel at all.
  EXPECT_EQ(fair.accepted_share, 1);
  // Y: z is standard normal. X and Z have the noise times 0.95 and 1.09 and the variance times the same.
  double squares = 0;
  for (int i = 0; i < 64 * 64; ++i)
    squares += fair.z.data[3 * i + 1] * fair.z.data[3 * i + 1];
  EXPECT_NEAR(squares / 4096, 1, 4 * std::sqrt(2.0 / 4096)); // chi-square of 4096 degrees, four deviations
  const ZTestResult biased = z_test(noisy(reference, 0.5, 100, 1, 0.35f), reference, variance, 100);
  EXPECT_FALSE(biased.pass);
}

TEST(ZTest, FailsOnAFewBadPixelsAndSaysWhere) {
  const Image reference = filled(20, 20, 1), variance = filled(20, 20, 0.01f);
  Image picture = reference;
  std::fill_n(picture.at(13, 5), 3, 30.0f);
  const ZTestResult one = z_test(picture, reference, variance, 64); // 3 of 1200: 0.25 %, just allowed
  EXPECT_TRUE(one.pass);
  EXPECT_NEAR(one.accepted_share, 0.9975, 1e-9);
  EXPECT_EQ(one.worst_x, 13);
  EXPECT_EQ(one.worst_y, 5);
  picture.at(1, 1)[0] = std::numeric_limits<float>::quiet_NaN();
  const ZTestResult two = z_test(picture, reference, variance, 64);
  EXPECT_FALSE(two.pass);
  EXPECT_TRUE(std::isinf(two.largest_z));
  EXPECT_EQ(two.worst_x, 1);
}

TEST(ZTest, SmallVariancesAreRaised) {
  const ZTestResult result = z_test(filled(1, 1, 1.01f), filled(1, 1, 1), filled(1, 1, 0), 4);
  EXPECT_NEAR(result.z.data[1], 0.01 * std::sqrt(4 / 1e-4), 1e-3);
}

TEST(ZTest, AVarianceThatIsNoNumberAcceptsNothing) {
  const ZTestResult result =
      z_test(filled(1, 1, 1), filled(1, 1, 1), filled(1, 1, std::numeric_limits<float>::infinity()), 4);
  EXPECT_EQ(result.accepted_share, 0);
}

TEST(ZTest, ErrorsNameWhatIsWrong) {
  const Image a = filled(4, 3, 1), b = filled(5, 3, 1);
  EXPECT_THAT(message_of([&] { z_test(a, a, b, 1); }), HasSubstr("variance"));
  EXPECT_THAT(message_of([&] { z_test(b, a, a, 1); }), HasSubstr("5 x 3"));
  EXPECT_THAT(message_of([&] { z_test(a, a, a, 0); }), HasSubstr("sample"));
}

TEST(ZTest, AReferenceAgreesWithItself) {
  const std::string folder =
      NACRE_SOURCE_DIR "/../shared/data/scenes/mitsuba/tests/scenes/bsdf_spheres/refs/test_arealight_ref_rgb";
  if (!std::filesystem::exists(folder + ".exr")) GTEST_SKIP() << "no " << folder << ".exr";
  const Image reference = read_exr(folder + ".exr"), variance = read_exr(folder + "_var.exr");
  EXPECT_TRUE(z_test(reference, reference, variance, 1000).pass);
  Image dimmed = reference;
  for (float& v : dimmed.data)
    v *= 0.8f;
  EXPECT_FALSE(z_test(dimmed, reference, variance, 1000).pass);
}

} // namespace
} // namespace nacre
