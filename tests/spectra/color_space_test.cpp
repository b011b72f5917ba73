#include "spectra/color_space.h"

#include <gtest/gtest.h>

using namespace nacre;

namespace {
void expect_matrix(const Matrix3& m, const std::array<std::array<double, 3>, 3>& published,
                   double tolerance) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(m.rows[i][j], published[i][j], tolerance) << "row " << i << " column " << j;
}
} // namespace

TEST(ColorSpace, SrgbMatricesMatchTheStandard) {
  // IEC 61966-2-1 prints four decimals, from a white rounded likewise.
  expect_matrix(srgb_to_xyz, {{{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}}},
                1e-4);
  expect_matrix(xyz_to_srgb,
                {{{3.2406, -1.5372, -0.4986}, {-0.9689, 1.8758, 0.0415}, {0.0557, -0.2040, 1.0570}}}, 5e-4);
}

TEST(ColorSpace, Ap1MatrixMatchesTheAcademysDigits) {
  // Academy S-2014-004, AP1 to XYZ, relative to the ACES white.
  expect_matrix(rgb_to_xyz(acescg_primaries),
                {{{0.6624541811, 0.1340042065, 0.1561876870},
                  {0.2722287168, 0.6740817658, 0.0536895174},
                  {-0.0055746495, 0.0040607335, 1.0103391003}}},
                1e-9);
}

TEST(ColorSpace, SrgbToAcescgMatchesPublishedDigits) {
  // Bradford-adapted matrices as the ACES configurations of OpenColorIO print them.
  expect_matrix(
      srgb_to_acescg,
      {{{0.613097, 0.339523, 0.047379}, {0.070194, 0.916354, 0.013452}, {0.020616, 0.109570, 0.869815}}},
      2e-6);
  expect_matrix(acescg_to_srgb,
                {{{1.705051, -0.621792, -0.083259},
                  {-0.130256, 1.140805, -0.010548},
                  {-0.024003, -0.128969, 1.152972}}},
                2e-6);
}

TEST(ColorSpace, WhiteIsWhiteInEverySpace) {
  const RGB white = xyz_to_acescg * (srgb_to_xyz * RGB{1, 1, 1});
  for (double v : white)
    EXPECT_NEAR(v, 1, 1e-12);
  EXPECT_NEAR(srgb_luminance({1, 1, 1}), 1, 1e-12);
  EXPECT_NEAR(acescg_luminance_weights[0] + acescg_luminance_weights[1] + acescg_luminance_weights[2], 1,
              1e-12);
}

TEST(ColorSpace, InverseUndoesTheMatrix) {
  expect_matrix(xyz_to_srgb * srgb_to_xyz, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 1e-14);
  expect_matrix(acescg_to_xyz * xyz_to_acescg, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, 1e-14);
}
