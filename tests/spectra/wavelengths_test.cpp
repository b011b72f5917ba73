#include "spectra/wavelengths.h"

#include <gtest/gtest.h>

using namespace nacre;

TEST(Wavelengths, DensityIntegratesToOneOverTheWholeRange) {
  double sum = 0;
  constexpr int n = 47000; // midpoint rule: error of order 1e-9
  for (int i = 0; i < n; ++i)
    sum += static_cast<double>(wavelength_pdf(lambda_min_nm + 470.0f * (static_cast<float>(i) + 0.5f) / n)) *
           470 / n;
  EXPECT_NEAR(sum, 1, 1e-5); // float densities
  EXPECT_GT(wavelength_pdf(lambda_min_nm), 1e-4f);
  EXPECT_GT(wavelength_pdf(lambda_max_nm), 1e-4f);
  EXPECT_EQ(wavelength_pdf(359.9f), 0);
  EXPECT_EQ(wavelength_pdf(830.1f), 0);
}

TEST(Wavelengths, DensityIsTheDerivativeOfTheSample) {
  for (int i = 1; i < 200; ++i) {
    const float u = static_cast<float>(i) / 800, h = 1e-3f; // below 1/4, so no rotation wraps
    const Wavelengths before = sample_wavelengths(u - h), at = sample_wavelengths(u),
                      after = sample_wavelengths(u + h);
    if (u < h || u + h >= 0.25f) continue;
    for (int c = 0; c < 4; ++c) {
      const float slope = (after.lambda_nm[c] - before.lambda_nm[c]) / (2 * h);
      EXPECT_NEAR(slope * at.pdf[c], 1, 2e-3) << "u " << u << " wavelength " << c;
    }
  }
}

TEST(Wavelengths, FourTouchTheEndsAndEachQuarterHoldsOne) {
  EXPECT_NEAR(sample_wavelengths(0).lambda_nm[0], lambda_min_nm, 1e-3);
  EXPECT_NEAR(sample_wavelengths(0.99999994f).lambda_nm[0], lambda_max_nm, 1e-3);
  const Wavelengths quarters = sample_wavelengths(0);
  for (float u : {0.03f, 0.31f, 0.5f, 0.77f, 0.9999f}) {
    const Wavelengths w = sample_wavelengths(u);
    for (int c = 0; c < 4; ++c) {
      EXPECT_GE(w.lambda_nm[c], lambda_min_nm);
      EXPECT_LE(w.lambda_nm[c], lambda_max_nm);
      EXPECT_FLOAT_EQ(w.pdf[c], wavelength_pdf(w.lambda_nm[c]));
    }
    std::array<int, 4> count{};
    for (float lambda : w.lambda_nm) {
      int quarter = 3;
      while (quarter > 0 && lambda < quarters.lambda_nm[quarter])
        --quarter;
      ++count[quarter];
    }
    EXPECT_EQ(count, (std::array<int, 4>{1, 1, 1, 1})) << "u " << u;
  }
}

TEST(Wavelengths, HeroOnlyIsIdempotent) {
  const Wavelengths once = hero_only(sample_wavelengths(0.4f)), twice = hero_only(once);
  EXPECT_EQ(once.pdf, twice.pdf);
  EXPECT_EQ(once.pdf[1], 0);
  EXPECT_FLOAT_EQ(once.pdf[0], sample_wavelengths(0.4f).pdf[0] / 4);
}
