#include "spectra/rgb.h"

#include "core/error.h"
#include "spectra/cie.h"
#include "spectra/illuminants.h"

#include <gtest/gtest.h>
#include <random>
#include <thread>

using namespace nacre;

namespace {
// Linear sRGB under D65, relative to the colour of a perfect white there.
template <class F>
RGB color_under_d65(F reflectance) {
  static const RGB white = xyz_to_srgb * integrate_xyz(unit_d65());
  RGB rgb = xyz_to_srgb * integrate_xyz([&](float l) {
              return static_cast<double>(reflectance(l)) * static_cast<double>(unit_d65()(l));
            });
  for (int i = 0; i < 3; ++i)
    rgb[i] /= white[i];
  return rgb;
}
double distance(const RGB& a, const std::array<float, 3>& b) {
  double d = 0;
  for (int i = 0; i < 3; ++i)
    d = std::max(d, std::abs(a[i] - static_cast<double>(b[i])));
  return d;
}
Wavelengths at(float lambda_nm) { return {{lambda_nm, lambda_nm, lambda_nm, lambda_nm}, {1, 1, 1, 1}}; }
} // namespace

TEST(FitSigmoid, ColorsComeBackOverTheWholeCube) {
  constexpr int n = 12;
  for (int r = 0; r <= n; ++r)
    for (int g = 0; g <= n; ++g)
      for (int b = 0; b <= n; ++b) {
        const std::array<float, 3> rgb{static_cast<float>(r) / n, static_cast<float>(g) / n,
                                       static_cast<float>(b) / n};
        EXPECT_LT(distance(color_under_d65(fit_sigmoid(rgb)), rgb), 5e-4)
            << rgb[0] << " " << rgb[1] << " " << rgb[2];
      }
}

TEST(FitSigmoid, DarkAndNearlyWhiteColorsComeBack) {
  for (const std::array<float, 3>& rgb : {std::array<float, 3>{1e-4f, 2e-4f, 5e-5f},
                                          {0.003f, 0, 0},
                                          {0, 0, 1e-3f},
                                          {0.999f, 0.998f, 0.9995f},
                                          {1, 1, 0.999f},
                                          {0.999f, 1, 1}})
    EXPECT_LT(distance(color_under_d65(fit_sigmoid(rgb)), rgb), 5e-4)
        << rgb[0] << " " << rgb[1] << " " << rgb[2];
}

TEST(FitSigmoid, GrayIsConstantAndExactAtTheEnds) {
  for (float gray : {0.0f, 1e-4f, 0.18f, 0.5f, 0.999f, 1.0f}) {
    const SigmoidPolynomial s = fit_sigmoid({gray, gray, gray});
    for (float lambda_nm : {360.0f, 555.0f, 830.0f})
      EXPECT_NEAR(s(lambda_nm), gray, 2e-7) << gray;
  }
  EXPECT_EQ(fit_sigmoid({0, 0, 0})(500), 0);
  EXPECT_EQ(fit_sigmoid({1, 1, 1})(500), 1);
}

TEST(FitSigmoid, RefusesWhatIsNoReflectance) {
  EXPECT_THROW(fit_sigmoid({0.5f, 1.01f, 0.5f}), Error);
  EXPECT_THROW(fit_sigmoid({-0.01f, 0.5f, 0.5f}), Error);
  EXPECT_THROW(fit_sigmoid({0.5f, 0.5f, std::nanf("")}), Error);
}

TEST(SigmoidPolynomial, MaximumBoundsEveryWavelength) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> coefficient(-5, 5);
  for (int i = 0; i < 200; ++i) {
    const SigmoidPolynomial s{coefficient(random), coefficient(random),
                              i % 10 == 0 ? 0 : coefficient(random)};
    float largest = 0;
    for (float lambda_nm = 360; lambda_nm <= 830; lambda_nm += 0.25f)
      largest = std::max(largest, s(lambda_nm));
    EXPECT_GE(s.max_value(), largest - 1e-6f);
    EXPECT_NEAR(s.max_value(), largest, 1e-4);
  }
}

TEST(SigmoidPolynomial, FourWavelengthsAtOnceAgreeWithOne) {
  const SigmoidPolynomial s = fit_sigmoid({0.8f, 0.1f, 0.3f});
  const Wavelengths w = sample_wavelengths(0.37f);
  for (int i = 0; i < 4; ++i)
    EXPECT_FLOAT_EQ(s(w)[i], s(w.lambda_nm[i]));
}

TEST(RgbToSpectrumTable, ColorsComeBack) {
  const auto& table = RgbToSpectrumTable::instance();
  std::mt19937 random(11);
  std::uniform_real_distribution<float> uniform(0, 1);
  double sum = 0;
  constexpr int n = 20000;
  for (int i = 0; i < n; ++i) {
    std::array<float, 3> rgb{uniform(random), uniform(random), uniform(random)};
    for (float& v : rgb) { // a quarter each: uniform, dark, bright, on a face of the cube
      if (i % 4 == 1) v = v * v * v;
      if (i % 4 == 2) v = 1 - v * v * v;
    }
    if (i % 4 == 3) rgb[i / 4 % 3] = static_cast<float>(i / 12 % 2);
    const double d = distance(color_under_d65(table(rgb)), rgb);
    sum += d;
    ASSERT_LT(d, 3e-3) << rgb[0] << " " << rgb[1] << " " << rgb[2];
  }
  EXPECT_LT(sum / n, 4e-4);
}

TEST(RgbToSpectrumTable, IsContinuousWhereTheLargestComponentChanges) {
  const auto& table = RgbToSpectrumTable::instance();
  for (float other : {0.0f, 0.2f, 0.6f})
    for (float v : {0.65f, 0.8f, 0.95f})
      for (int c = 0; c < 3; ++c) {
        std::array<float, 3> below{}, above{};
        below[c] = v;
        below[(c + 1) % 3] = v - 1e-5f;
        above[c] = v - 1e-5f;
        above[(c + 1) % 3] = v;
        below[(c + 2) % 3] = above[(c + 2) % 3] = other;
        for (float lambda_nm = 400; lambda_nm <= 700; lambda_nm += 20)
          EXPECT_NEAR(table(below)(lambda_nm), table(above)(lambda_nm), 0.02);
      }
}

TEST(RgbToSpectrumTable, AnyTextureValueGivesAReflectance) {
  const auto& table = RgbToSpectrumTable::instance();
  const float inf = std::numeric_limits<float>::infinity(), nan = std::nanf("");
  for (float a : {-1.0f, 0.0f, 1e-38f, 1e-7f, 0.5f, 1.0f, 7.0f, inf, -inf, nan})
    for (float b : {-1.0f, 0.0f, 1e-40f, 0.5f, 1.0f, inf, nan})
      for (const std::array<float, 3>& rgb : {std::array<float, 3>{a, b, 0.3f}, {b, a, 0}, {0.2f, a, b}})
        for (float lambda_nm : {360.0f, 600.0f, 830.0f}) {
          const float s = table(rgb)(lambda_nm);
          EXPECT_TRUE(s >= 0 && s <= 1) << a << " " << b << " " << s;
        }
  EXPECT_EQ(table({0, 0, 0})(500), 0);
  EXPECT_EQ(table({1, 1, 1})(500), 1);
}

TEST(RgbBasis, SumsToOneEverywhere) {
  for (float lambda_nm = 360; lambda_nm <= 830; lambda_nm += 1.7f) {
    const auto basis = rgb_basis(at(lambda_nm));
    EXPECT_NEAR(basis[0][0] + basis[1][0] + basis[2][0], 1, 2e-7);
    for (const auto& b : basis)
      EXPECT_TRUE(b[0] >= 0 && b[0] <= 1) << lambda_nm;
  }
}

TEST(RgbBasis, ColorsComeBack) {
  // Linear, so the three primaries stand for all colours. Mallett and Yuksel solved at 5 nm from 380 to 780
  // nm.
  for (int c = 0; c < 3; ++c) {
    std::array<float, 3> rgb{};
    rgb[c] = 1;
    EXPECT_LT(distance(color_under_d65([&](float l) { return rgb_basis(at(l))[c][0]; }), rgb), 2e-3) << c;
  }
}
