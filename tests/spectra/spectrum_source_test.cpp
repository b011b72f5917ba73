#include "spectra/spectrum_source.h"

#include "core/error.h"
#include "spectra/illuminants.h"

#include <gtest/gtest.h>
#include <random>

using namespace nacre;

namespace {
constexpr float inf = std::numeric_limits<float>::infinity();
const float nan_value = std::nanf("");

float reference_linear(const std::vector<float>& x, const std::vector<float>& y, float v) {
  if (v < x.front() || v > x.back()) return 0;
  std::size_t i = 0;
  while (i + 2 < x.size() && v >= x[i + 1])
    ++i;
  const double f = (static_cast<double>(v) - static_cast<double>(x[i])) /
                   (static_cast<double>(x[i + 1]) - static_cast<double>(x[i]));
  return static_cast<float>((1 - f) * static_cast<double>(y[i]) + f * static_cast<double>(y[i + 1]));
}
} // namespace

TEST(SpectrumSource, TabulatedIsLinearInterpolationForAnyNodes) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (float mean_step :
       {0.05f, 0.9f, 13.0f, 200.0f}) { // many nodes in a nanometre, and few in the whole range
    std::vector<float> x, y;
    for (float v = 300 + 100 * uniform(random); v < 900; v += mean_step * (0.05f + uniform(random))) {
      x.push_back(v);
      y.push_back(uniform(random));
    }
    const auto s = SpectrumSource::tabulated(x, y);
    for (int i = 0; i < 3000; ++i) {
      const float v = 290 + 620 * uniform(random);
      EXPECT_NEAR(s.eval(v), reference_linear(x, y, v), 1e-4) << v << " nm, step " << mean_step;
    }
    for (std::size_t i = 0; i < x.size(); ++i)
      EXPECT_FLOAT_EQ(s.eval(x[i]), y[i]);
  }
}

TEST(SpectrumSource, TabulatedIsZeroOutsideItsNodes) {
  const std::vector<float> x{450, 550, 650}, y{1, 2, 1};
  const auto s = SpectrumSource::tabulated(x, y);
  EXPECT_EQ(s.eval(449.99f), 0);
  EXPECT_EQ(s.eval(450.0f), 1);
  EXPECT_EQ(s.eval(650.0f), 1);
  EXPECT_EQ(s.eval(650.01f), 0);
  EXPECT_FLOAT_EQ(s.max_value(), 2);
  EXPECT_EQ(s.eval(nan_value), 0);
  const std::vector<float> one{500}, value{3};
  EXPECT_EQ(SpectrumSource::tabulated(one, value).eval(500.0f), 3);
  EXPECT_EQ(SpectrumSource::tabulated(one, value).eval(500.5f), 0);
}

TEST(SpectrumSource, RegularSpreadsItsValuesEvenly) {
  const std::vector<float> values{0, 1, 4};
  const auto s = SpectrumSource::regular(400, 700, values);
  EXPECT_FLOAT_EQ(s.eval(550.0f), 1);
  EXPECT_FLOAT_EQ(s.eval(475.0f), 0.5f);
  EXPECT_FLOAT_EQ(s.eval(700.0f), 4);
}

TEST(SpectrumSource, EvalOfAPathAgreesWithEachWavelength) {
  const std::vector<float> x{360, 500, 830}, y{0.1f, 0.9f, 0.3f};
  const Wavelengths w = sample_wavelengths(0.61f);
  for (const auto& s : {SpectrumSource(), SpectrumSource::constant(0.4f), SpectrumSource::tabulated(x, y),
                        SpectrumSource::rgb_reflectance(0.2f, 0.5f, 0.7f),
                        SpectrumSource::rgb_unbounded(2, 0.5f, 1), SpectrumSource::rgb_illuminant(4, 2, 1),
                        SpectrumSource::d65(3), SpectrumSource::blackbody(3000, 2)}) {
    const SampledSpectrum v = s.eval(w);
    for (int i = 0; i < 4; ++i) {
      EXPECT_FLOAT_EQ(v[i], s.eval(w.lambda_nm[i]));
      EXPECT_LE(v[i], s.max_value() * (1 + 1e-6f));
      EXPECT_FLOAT_EQ(s.scaled(2.5f).eval(w.lambda_nm[i]), 2.5f * v[i]);
    }
    EXPECT_NEAR(s.scaled(2.5f).luminance(), 2.5 * s.luminance(), 1e-5 * s.luminance() + 1e-12);
    EXPECT_FLOAT_EQ(s.scaled(2.5f).max_value(), 2.5f * s.max_value());
  }
}

TEST(SpectrumSource, LuminanceIsNormalised) {
  EXPECT_NEAR(SpectrumSource::constant(1).luminance(), 1, 1e-6);
  EXPECT_NEAR(SpectrumSource::d65().luminance(), 1, 1e-6);
  EXPECT_NEAR(SpectrumSource::rgb_illuminant(1, 1, 1).luminance(), 1, 1e-6);
}

TEST(SpectrumSource, RgbComesBack) {
  const auto near = [](const RGB& a, double r, double g, double b, double tolerance) {
    EXPECT_NEAR(a[0], r, tolerance);
    EXPECT_NEAR(a[1], g, tolerance);
    EXPECT_NEAR(a[2], b, tolerance);
  };
  // 1e-3: 5e-4 of the fit and 3e-4 of the rounded sRGB white, of the largest component.
  near(SpectrumSource::rgb_reflectance(0.8f, 0.3f, 0.1f).to_srgb_reflectance(), 0.8, 0.3, 0.1, 1e-3);
  near(SpectrumSource::rgb_unbounded(8, 3, 1).to_srgb_reflectance(), 8, 3, 1, 8e-3);
  near(SpectrumSource::rgb_illuminant(17, 12, 4).to_srgb_emission(), 17, 12, 4, 17e-3);
  near(SpectrumSource::rgb_illuminant(1, 1, 1).to_srgb_emission(), 1, 1, 1, 5e-4);
  near(SpectrumSource::d65(2).to_srgb_emission(), 2, 2, 2, 1e-3);
  near(SpectrumSource::rgb_unbounded(0, 0, 0).to_srgb_reflectance(), 0, 0, 0, 0);
}

TEST(SpectrumSource, BlackbodyIsPlancksLaw) {
  const auto s = SpectrumSource::blackbody(5772, 0.5f);
  EXPECT_NEAR(s.eval(500.0f), 0.5 * blackbody(500, 5772), 1e-2);
  EXPECT_FLOAT_EQ(s.max_value(), static_cast<float>(0.5 * blackbody(2.897771955e6 / 5772, 5772)));
  const auto cool = SpectrumSource::blackbody(1000);
  EXPECT_FLOAT_EQ(cool.max_value(), cool.eval(830.0f)); // its peak is infrared
}

TEST(SpectrumSource, RefusesWhatIsNoSpectrum) {
  const std::vector<float> x{400, 500}, same{400, 400}, bad_x{400, nan_value}, y{1, 2}, negative{1, -1},
      nan_y{nan_value, 1}, short_y{1}, none;
  EXPECT_THROW(SpectrumSource::constant(-1), Error);
  EXPECT_THROW(SpectrumSource::constant(inf), Error);
  EXPECT_THROW(SpectrumSource::tabulated(x, short_y), Error);
  EXPECT_THROW(SpectrumSource::tabulated(none, none), Error);
  EXPECT_THROW(SpectrumSource::tabulated(same, y), Error);
  EXPECT_THROW(SpectrumSource::tabulated(bad_x, y), Error);
  EXPECT_THROW(SpectrumSource::tabulated(x, negative), Error);
  EXPECT_THROW(SpectrumSource::tabulated(x, nan_y), Error);
  EXPECT_THROW(SpectrumSource::regular(400, 400, y), Error);
  EXPECT_THROW(SpectrumSource::regular(400, 700, short_y), Error);
  EXPECT_THROW(SpectrumSource::rgb_reflectance(1.5f, 0, 0), Error);
  EXPECT_THROW(SpectrumSource::rgb_reflectance(nan_value, 0, 0), Error);
  EXPECT_THROW(SpectrumSource::rgb_unbounded(inf, 0, 0), Error);
  EXPECT_THROW(SpectrumSource::rgb_illuminant(0, -1, 0), Error);
  EXPECT_THROW(SpectrumSource::d65(nan_value), Error);
  EXPECT_THROW(SpectrumSource::blackbody(0), Error);
  EXPECT_THROW(SpectrumSource::blackbody(nan_value), Error);
  EXPECT_THROW(SpectrumSource::blackbody(2e6f), Error);
  EXPECT_THROW(SpectrumSource::constant(1).scaled(-1), Error);
  EXPECT_THROW(SpectrumSource::constant(1e30f).scaled(1e30f), Error);
  const std::vector<float> near_x{500, 500.0001f}, far_y{0, 3e38f};
  EXPECT_THROW(SpectrumSource::tabulated(near_x, far_y), Error);
}

TEST(SpectrumSource, MessageSaysWhatIsWrong) {
  try {
    SpectrumSource::rgb_reflectance(0.5f, 1.5f, 0.25f);
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "RGB reflectance (0.5, 1.5, 0.25): each component must be in [0, 1]");
  }
}
