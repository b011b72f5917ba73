#include "spectra/illuminants.h"

#include "core/error.h"
#include "spectra/cie.h"

#include <gtest/gtest.h>
#include <numbers>

using namespace nacre;

TEST(Illuminants, DaylightMatchesTheStandardTables) {
  struct Row {
    float lambda_nm, d65, d50;
  };
  // CIE 015:2018, tables 5 and 6, which print six figures.
  for (const Row& row :
       {Row{360, 46.6383f, 23.9419f}, Row{365, 49.3637f, 25.4537f}, Row{400, 82.7549f, 49.3081f},
        Row{450, 117.008f, 87.2472f}, Row{500, 109.354f, 95.7237f}, Row{560, 100, 100},
        Row{700, 71.6091f, 91.6035f}, Row{830, 60.3125f, 74.4417f}}) {
    EXPECT_NEAR(illuminant_d65()(row.lambda_nm), row.d65, 1e-3) << row.lambda_nm;
    EXPECT_NEAR(illuminant_d50()(row.lambda_nm), row.d50, 1e-2) << row.lambda_nm;
  }
}

TEST(Illuminants, ChromaticitiesMatchTheStandard) {
  const auto expect = [](const DenseSpectrum& s, double x, double y) {
    const Chromaticity c = chromaticity(integrate_xyz(s));
    EXPECT_NEAR(c.x, x, 2e-5);
    EXPECT_NEAR(c.y, y, 2e-5);
  };
  expect(illuminant_a(), 0.44757, 0.40745);
  expect(illuminant_d65(), 0.31272, 0.32903);
  expect(illuminant_d50(), 0.34567, 0.35851);
}

TEST(Illuminants, UnitD65IsSrgbWhite) {
  EXPECT_NEAR(integrate_xyz(unit_d65())[1], 1, 1e-6);
  // sRGB rounds the white to four decimals: 3e-4 in blue.
  for (double v : xyz_to_srgb* integrate_xyz(unit_d65()))
    EXPECT_NEAR(v, 1, 5e-4);
}

TEST(Illuminants, DaylightRefusesTemperaturesOutsideItsFormula) {
  EXPECT_THROW(cie_daylight(3999), Error);
  EXPECT_THROW(cie_daylight(25001), Error);
  EXPECT_THROW(cie_daylight(std::nan("")), Error);
  const Chromaticity cold =
      chromaticity(integrate_xyz(cie_daylight(10000))); // the formula's own x_D, M1, M2 rounded
  EXPECT_NEAR(cold.x, 0.27880, 3e-4);
  EXPECT_NEAR(cold.y, 0.29203, 3e-4);
}

TEST(Blackbody, ObeysStefanBoltzmann) {
  for (double t : {1000.0, 2856.0, 6504.0, 20000.0}) {
    double sum = 0;
    constexpr int n = 4000; // trapezoidal in the logarithm of the wavelength
    const double first = std::log(1e5 / t), last = std::log(1e10 / t), h = (last - first) / n;
    for (int i = 0; i <= n; ++i) {
      const double lambda_nm = std::exp(first + i * h);
      sum += blackbody(lambda_nm, t) * lambda_nm * h;
    }
    const double stefan_boltzmann = 5.670374419e-8; // CODATA 2018
    EXPECT_NEAR(sum * std::numbers::pi / (stefan_boltzmann * t * t * t * t), 1, 1e-6) << t;
  }
}

TEST(Blackbody, PeaksWhereWienSays) {
  const double peak_nm = 2.897771955e6 / 5772;
  EXPECT_NEAR(blackbody_normalized(peak_nm, 5772), 1, 1e-12);
  EXPECT_LT(blackbody_normalized(peak_nm * 1.01, 5772), 1);
  EXPECT_LT(blackbody_normalized(peak_nm * 0.99, 5772), 1);
  EXPECT_EQ(blackbody(360, 1), 0); // the exponential overflows
}

TEST(Blackbody, ChromaticityLiesOnThePlanckianLocus) {
  // Planckian locus at 6504 K: Wyszecki and Stiles 1982, between 6500 K (0.3135, 0.3237) and its neighbours.
  const Chromaticity c =
      chromaticity(integrate_xyz([](float l) { return blackbody(static_cast<double>(l), 6504); }));
  EXPECT_NEAR(c.x, 0.3135, 1e-4);
  EXPECT_NEAR(c.y, 0.3236, 1e-4);
}
