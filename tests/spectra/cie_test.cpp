#include "spectra/cie.h"

#include "spectra/illuminants.h"

#include <gtest/gtest.h>
#include <random>

using namespace nacre;

TEST(Cie1931, MatchesPublishedOneNanometreValues) {
  struct Row {
    float lambda_nm, x, y;
  };
  // CIE 018:2019, table 6; between the multiples of 5 nm ours is interpolated.
  for (const Row& row :
       {Row{401, 0.01570443f, 0.0004337147f}, Row{442, 0.3501474f, 0.02561024f},
        Row{501, 0.003777173f, 0.3384021f}, Row{555, 0.5120501f, 1.0f}, Row{557, 0.5446916f, 0.9993046f},
        Row{598, 1.0628068f, 0.6566744f}, Row{600, 1.0622f, 0.631f}}) {
    const auto value = cie_1931(row.lambda_nm);
    EXPECT_NEAR(value[0], row.x, 1e-4) << row.lambda_nm;
    EXPECT_NEAR(value[1], row.y, 1e-4) << row.lambda_nm;
  }
  EXPECT_FLOAT_EQ(cie_1931(445)[2], 1.7826f);
}

TEST(Cie1931, IsLinearBetweenNanometresAndZeroOutside) {
  const auto a = cie_1931(531), b = cie_1931(532), middle = cie_1931(531.5f);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(middle[c], 0.5f * (a[c] + b[c]), 1e-6);
    EXPECT_EQ(cie_1931(359.99f)[c], 0);
    EXPECT_EQ(cie_1931(830.01f)[c], 0);
    EXPECT_EQ(cie_1931(std::nanf(""))[c], 0);
  }
  EXPECT_GT(cie_1931(830)[0], 0);
}

TEST(Cie1931, IntegralMatchesTheCies) {
  // Sum of the CIE's 1 nm table: 106.8569. Equal-energy white has x = y = 1/3 to the accuracy of the tables.
  EXPECT_NEAR(cie_y_integral_nm, 106.8569, 2e-3);
  const XYZ flat = integrate_xyz([](float) { return 1.0; });
  EXPECT_NEAR(flat[1], 1, 1e-7);
  EXPECT_NEAR(chromaticity(flat).x, 1.0 / 3, 1e-4);
  EXPECT_NEAR(chromaticity(flat).y, 1.0 / 3, 1e-4);
}

namespace {
// Mean of the estimator over `n` random heroes and its distance from quadrature in standard errors, per
// component.
template <class F, class Turn>
std::array<double, 3> sigmas_off(F spectrum, Turn turn, int n) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::array<double, 3> mean{}, square{};
  for (int i = 0; i < n; ++i) {
    const Wavelengths w = turn(sample_wavelengths(uniform(random)));
    SampledSpectrum s;
    for (int c = 0; c < 4; ++c)
      s[c] = spectrum(w.lambda_nm[c]);
    const XYZ xyz = to_xyz(s, w);
    for (int c = 0; c < 3; ++c) {
      mean[c] += xyz[c] / n;
      square[c] += xyz[c] * xyz[c] / n;
    }
  }
  const XYZ truth = integrate_xyz(spectrum);
  std::array<double, 3> off;
  for (int c = 0; c < 3; ++c)
    off[c] = std::abs(mean[c] - truth[c]) / std::sqrt((square[c] - mean[c] * mean[c]) / n);
  return off;
}
} // namespace

TEST(ToXyz, EstimateIsUnbiased) {
  const auto light = [](float lambda_nm) {
    return unit_d65()(lambda_nm) * (0.5f + 0.4f * std::sin(lambda_nm / 30));
  };
  const auto all = sigmas_off(
      light, [](const Wavelengths& w) { return w; }, 200000);
  const auto hero = sigmas_off(light, hero_only, 200000);
  for (int c = 0; c < 3; ++c) { // 4 sigma: a false alarm once in 2,600 seeds; the seed is fixed
    EXPECT_LT(all[c], 4) << "component " << c;
    EXPECT_LT(hero[c], 4) << "component " << c << ", hero only";
  }
}

TEST(ToXyz, FlatSpectrumIsNearlyFreeOfNoise) {
  // Four stratified wavelengths through a density near ybar: the luminance of white varies little.
  for (float u : {0.01f, 0.1f, 0.2f})
    EXPECT_NEAR(to_xyz(SampledSpectrum(1.0f), sample_wavelengths(u))[1], 1, 0.2);
}
