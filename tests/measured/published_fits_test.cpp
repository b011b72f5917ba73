#include "measured/published_fits.h"

#include "core/error.h"
#include "measured/synthetic_tables.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

const std::string data = NACRE_SOURCE_DIR "/../shared/data/";

TEST(PublishedFits, AreAHundredMaterialsWithPlausibleParameters) {
  const auto names = published_materials();
  EXPECT_EQ(names.size(), 100u);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), 100u);
  for (const PublishedFit& fit : published_fits()) {
    EXPECT_GT(fit.eta, 1) << fit.material;
    EXPECT_GT(fit.b, 0) << fit.material;
    EXPECT_GT(fit.c, 0) << fit.material;
    for (int c = 0; c < 3; ++c) {
      EXPECT_GE(fit.diffuse[c], 0) << fit.material;
      EXPECT_LE(fit.diffuse[c], 1) << fit.material;
      EXPECT_GT(fit.a[c], 0) << fit.material;
    }
  }
}

TEST(PublishedFits, NearestMaterialIsNamedForAMisspeltOne) {
  try {
    published_fit("alum-bronce");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("'alum-bronze'"));
  }
}

TEST(PublishedFits, ValueAtTheMirrorDirectionIsLambertPlusAFresnelOverPi) {
  // theta_h = 0: S = a and G = 1, so f = diffuse / pi + a F / (pi cos^2), with F(normal) =
  // ((eta-1)/(eta+1))^2.
  const PublishedFit& fit = published_fit("alum-bronze");
  const double f0 = sqr((fit.eta - 1) / (fit.eta + 1));
  EXPECT_NEAR(evaluate(fit, {0, 0, 0})[1], (fit.diffuse[1] + fit.a[1] * f0) / pi, 1e-12);
}

TEST(PublishedFits, TablesHaveTheFormatsResolutionTheFitsValuesAndHolesBelowTheHorizon) {
  const MerlTable& table = published_table("alum-bronze");
  EXPECT_EQ(encode_merl(table).size(), 34992012u);
  const PublishedFit& fit = published_fit("alum-bronze");
  for (int i = 0; i < 90; i += 7)
    for (int j = 0; j < 90; j += 11)
      for (int k = 0; k < 180; k += 13) {
        const auto node = table.node(i, j, k);
        EXPECT_EQ(table.is_hole(i, j, k), !above_horizon(node));
        if (above_horizon(node)) {
          EXPECT_FLOAT_EQ(table.cell(i, j, k)[0], static_cast<float>(evaluate(fit, node)[0]));
        }
      }
  EXPECT_GT(table.hole_count(), table.size() / 10);
}

TEST(PublishedFits, ParametersAreThoseOfTheSupplement) {
  std::ifstream file(data + "fits/low_lowmicrofacet_E2.json");
  if (!file) GTEST_SKIP() << "no published fits at " << data;
  const auto materials = nlohmann::json::parse(file)["materials"];
  ASSERT_EQ(materials.size(), published_fits().size());
  for (const PublishedFit& fit : published_fits()) {
    const auto& lobes = materials.at(std::string(fit.material));
    EXPECT_EQ(fit.diffuse, (lobes[0]["albedo"].get<std::array<double, 3>>())) << fit.material;
    EXPECT_EQ(fit.a, (lobes[1]["A"].get<std::array<double, 3>>())) << fit.material;
    EXPECT_EQ(fit.b, lobes[1]["B"]) << fit.material;
    EXPECT_EQ(fit.c, lobes[1]["C"]) << fit.material;
    EXPECT_EQ(fit.eta, lobes[1]["eta"]) << fit.material;
  }
}

TEST(PublishedFits, ValuesAgreeWithAnIndependentProgram) {
  std::ifstream file(data + "reference/bbm_fits.csv");
  if (!file) GTEST_SKIP() << "no reference values at " << data;
  std::string line;
  int compared = 0;
  while (std::getline(file, line)) {
    if (line.rfind("low_lowmicrofacet_E2,", 0) != 0) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::string set, material;
    double theta_i, theta_o, phi;
    std::array<double, 3> expected;
    ASSERT_TRUE(words >> set >> material >> theta_i >> theta_o >> phi >> expected[0] >> expected[1] >>
                expected[2]);
    const auto angles = half_difference(spherical_direction(theta_o * pi / 180, 0.0),
                                        spherical_direction(theta_i * pi / 180, phi * pi / 180));
    const auto found = evaluate(published_fit(material), angles);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(found[c], expected[c], 1e-6 * expected[c]) << line; // printed with 9 digits
    ++compared;
  }
  EXPECT_GE(compared, 1000);
}

} // namespace
} // namespace nacre
