// The pieces of facet models against the public shaders of Disney's BRDF Explorer, run by a GLSL compiler.
#include "optics/fresnel_approximations.h"
#include "optics/microfacet.h"

#include "bsdf/reference_table.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

constexpr const char* absent = "no reference values beside the project";

/// Relative error of a shader's D in float: its denominator is a difference of numbers near 1, each of which
/// is off by a few roundings, squared. At the least (cos_m^2 (alpha^2 - 1) + 1).
double rounding(double cos_m, double alpha) {
  return 2 * 8 * 6e-8 / (cos_m * cos_m * (alpha * alpha - 1) + 1) + 1e-6;
}

TEST(PublicShaders, GgxNormalsAreWalters) {
  const auto rows = reference_table::read("brdf_files.csv", "d_ggx.brdf");
  if (rows.empty()) GTEST_SKIP() << absent;
  ASSERT_EQ(rows.size(), 25u);
  const Ggx<double> facets{0.1, 0.1};
  for (const auto& row : rows) {
    const Vec3d wm = normalize(row.wo + row.wi);
    EXPECT_NEAR(facets.D(wm), row.f[0], rounding(wm.z, 0.1) * row.f[0]) << row.text();
  }
}

// Its defaults: red 0.1 + 0.5 D F, no masking and no 4 cos cos; 0.1 is not over pi.
TEST(PublicShaders, FacetsWithSchlicksFresnelAreThoseOfTheComparison) {
  const auto rows = reference_table::read("brdf_files.csv", "compare.brdf");
  if (rows.empty()) GTEST_SKIP() << absent;
  ASSERT_EQ(rows.size(), 25u);
  const Ggx<double> facets{0.02, 0.02};
  for (const auto& row : rows) {
    const Vec3d wm = normalize(row.wo + row.wi);
    const double lobe = 0.5 * facets.D(wm) * fresnel_schlick(dot(row.wi, wm), 0.01);
    const double tolerance = rounding(wm.z, 0.02) * lobe;
    EXPECT_NEAR(0.1 + lobe, row.f[0], tolerance + 1e-7) << row.text();
    EXPECT_NEAR(lobe, row.f[1], tolerance) << row.text();
  }
}

} // namespace
} // namespace nacre
