#include "measured/material_as_measurement.h"

#include "core/error.h"
#include "measured/inspection.h"
#include "measured/measured_albedo.h"
#include "measured/synthetic_tables.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

TEST(MaterialAsMeasurement, HasTheValuesOfTheMaterial) {
  const MaterialSpec spec = parse_material("ggx_conductor:alpha_x=0.2,alpha_y=0.3+0.5*lambert");
  const MaterialAsMeasurement measured(spec);
  const auto bsdf = make_bsdf<double>(spec);
  const MeasuredSamples samples = measured.samples();
  ASSERT_GT(samples.size(), 1000u);
  for (std::size_t n = 0; n < samples.size(); n += 97) {
    const auto vec = [](const Vec3f& w) { return Vec3d{w.x, w.y, w.z}; };
    const auto f = bsdf.eval(vec(samples.wo[n]), vec(samples.wi[n]));
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(samples.f[3 * n + c], f[int(c)], 1e-4 * (1e-3 + f[int(c)]));
  }
}

TEST(MaterialAsMeasurement, FindsIsotropyAndSides) {
  const auto of = [](const char* text) { return MaterialAsMeasurement(parse_material(text)); };
  EXPECT_TRUE(of("ggx_conductor:alpha_x=0.1,alpha_y=0.1").is_isotropic());
  EXPECT_FALSE(of("ggx_conductor:alpha_x=0.1,alpha_y=0.2").is_isotropic());
  EXPECT_TRUE(of("lambert").sides().reflects_front);
  EXPECT_FALSE(of("lambert").sides().reflects_back);
  EXPECT_FALSE(of("lambert").sides().transmits());
  const MeasuredSides glass = of("ggx_dielectric:alpha_x=0.2,alpha_y=0.2").sides();
  EXPECT_TRUE(glass.reflects_front && glass.reflects_back && glass.transmits_to_front &&
              glass.transmits_to_back);
  EXPECT_THROW(of("smooth_conductor"), Error);
}

TEST(MaterialAsMeasurement, WeightsOfSamplesIntegrateOverPairsOfDirections) {
  // The mean of cos theta_o cos theta_i over pairs of directions of the upper hemisphere is 1/4.
  const MeasuredSamples samples = MaterialAsMeasurement(parse_material("lambert")).samples();
  double sum = 0, weights = 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    sum += samples.weight[n] * double(samples.wo[n].z) * double(samples.wi[n].z);
    weights += samples.weight[n];
  }
  EXPECT_NEAR(sum / weights, 0.25, 0.01); // cells at the horizon count whole or not at all
}

TEST(Inspection, CoverageSeesWhatIsMissing) {
  const MerlTable table =
      MerlTable::tabulate(90, 90, 180, [](double h, double d, double phi) -> std::array<double, 3> {
        const auto pair = directions(HalfDifference<double>{h, d, phi});
        const bool measured = std::min(pair.wo.z, pair.wi.z) > std::cos(70 * pi / 180);
        return measured ? std::array{0.1, 0.1, 0.1} : std::array{-1.0, -1.0, -1.0};
      });
  const auto maps = coverage(table);
  ASSERT_EQ(maps.size(), 1u);
  for (int o = 0; o < CoverageMap::bins; ++o)
    for (int i = 0; i < CoverageMap::bins; ++i) {
      const double share = maps[0].share[std::size_t(o)][std::size_t(i)];
      if (std::max(o, i) < 13) { // up to 65 degrees
        EXPECT_EQ(share, 1) << o << " " << i;
      }
      if (std::max(o, i) > 14) { // from 75 degrees: a node's distance further than what is measured
        EXPECT_EQ(share, 0) << o << " " << i;
      }
    }
  EXPECT_NEAR(maps[0].whole, sqr(1 - std::cos(70 * pi / 180)), 0.05);
}

TEST(Inspection, ReciprocityErrorIsThatOfTheFormula) {
  const MaterialAsMeasurement reciprocal(parse_material("ggx_conductor:alpha_x=0.3,alpha_y=0.3"));
  EXPECT_LT(reciprocity_error(reciprocal).worst, 1e-4);
  const MerlTable handed =
      MerlTable::tabulate(6, 6, 360, [](double, double d, double phi) -> std::array<double, 3> {
        const double f = 1 + 0.5 * std::sin(phi) * std::sin(d);
        return {f, f, f};
      });
  const ReciprocityError error = reciprocity_error(handed);
  EXPECT_GT(error.pairs, 19000u);
  EXPECT_GT(error.worst, 0.5); // (1.5 - 0.5) / 1 at most
  EXPECT_LE(error.worst, 1.0);
  EXPECT_GT(error.mean, 0.1);
}

TEST(Albedo, OfWhatLetsLightThroughIsThatOfItsSides) {
  const MaterialAsMeasurement glass(parse_material("ggx_dielectric:alpha_x=0.3,alpha_y=0.3,eta=1.5"));
  const auto albedo = directional_albedo(glass, spherical_direction(0.4, 0.3));
  EXPECT_NEAR(albedo.reflected[0], 0.045, 0.01); // Fresnel's 4 % at the normal
  // Uniform radiance inside leaves diluted by 1/eta^2; facets lose some to second bounces.
  EXPECT_NEAR(albedo.transmitted[0], (1 - albedo.reflected[0]) / sqr(1.5), 0.02);
}

} // namespace
} // namespace nacre
