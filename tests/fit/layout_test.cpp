#include "fit/layout.h"

#include "core/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

std::vector<std::string> labels(const ParameterLayout& layout) {
  std::vector<std::string> all;
  for (int i = 0; i < layout.size(); ++i)
    all.push_back(layout.label(i));
  return all;
}

std::string error_of(const std::string& model, const ParameterRules& rules) {
  try {
    ParameterLayout(parse_material(model), rules);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(ParameterLayout, TiesBothAxesOfAnIsotropicMaterial) {
  using testing::ElementsAre;
  EXPECT_THAT(labels(ParameterLayout(parse_material("ashikhmin_dbrdf"))),
              ElementsAre("ashikhmin_dbrdf.f0.r", "ashikhmin_dbrdf.f0.g", "ashikhmin_dbrdf.f0.b",
                          "ashikhmin_dbrdf.alpha_x"));
  EXPECT_EQ(ParameterLayout(parse_material("ashikhmin_shirley")).size(), 4); // n_u, n_v
  EXPECT_EQ(ParameterLayout(parse_material("lafortune")).size(), 3 * 4);     // cx, cy of each channel
  EXPECT_EQ(ParameterLayout(parse_material("ashikhmin_dbrdf"), {.isotropic = false}).size(), 5);
  for (const auto& [model, anisotropies] :
       {std::pair{"disney_2012", 1}, {"disney_2015", 1}, {"gltf", 1}, {"openpbr", 1}}) {
    const ParameterLayout tied(parse_material(model)), free(parse_material(model), {.isotropic = false});
    EXPECT_EQ(tied.size() + anisotropies, free.size()) << model;
    EXPECT_THAT(labels(tied), testing::Not(testing::Contains(testing::HasSubstr("anisotrop")))) << model;
  }
  EXPECT_THAT(labels(ParameterLayout(parse_material("disney_2012"), {.freed = {"anisotropic"}})),
              testing::Contains("disney_2012.anisotropic"));
}

TEST(ParameterLayout, RulesThatContradictEachOtherAreRefused) {
  ParameterRules bounded, freed;
  bounded.fixed = freed.fixed = {{"alpha", 0.3}};
  bounded.bounds = {{"alpha", 0.1, 0.2}};
  freed.freed = {"alpha"};
  EXPECT_THAT(error_of("ggx_schlick", bounded), testing::HasSubstr("fixed and bounded"));
  EXPECT_THAT(error_of("ggx_schlick", freed), testing::HasSubstr("fixed and freed"));
}

TEST(ParameterLayout, SharesFreesFixesAndBoundsByName) {
  using testing::ElementsAre;
  ParameterRules rules;
  rules.shared = {"f0"};
  rules.freed = {"cook_torrance_schlick.specular_reflectance"};
  rules.fixed = {{"reflectance", 0.25}};
  rules.bounds = {{"m", 0.1, 0.3}};
  const ParameterLayout layout(parse_material("cook_torrance_schlick:m=0.9+lambert"), rules);
  EXPECT_THAT(labels(layout), ElementsAre("cook_torrance_schlick.f0", "cook_torrance_schlick.m",
                                          "cook_torrance_schlick.specular_reflectance.r",
                                          "cook_torrance_schlick.specular_reflectance.g",
                                          "cook_torrance_schlick.specular_reflectance.b"));
  const MaterialSpec material = layout.material(layout.coordinates(layout.start()));
  EXPECT_EQ(material.lobes[1].values[0], (std::array{0.25, 0.25, 0.25}));
  EXPECT_NEAR(material.lobes[0].values[1][0], 0.3, 1e-12); // the start, moved inside
  for (int i = 0; i < layout.size(); ++i)
    for (int channel = 0; channel < 3; ++channel) {
      if (layout[i].channel >= 0 && layout[i].channel != channel) continue;
      EXPECT_EQ(layout.index(layout[i].lobe, layout[i].parameter, channel), i);
    }
}

TEST(ParameterLayout, NumbersLobesOfOneModel) {
  ParameterRules rules;
  rules.fixed = {{"ggx_schlick#2.alpha", {}}};
  const ParameterLayout layout(parse_material("ggx_schlick+ggx_schlick:alpha=0.5"), rules);
  EXPECT_THAT(labels(layout), testing::Contains("ggx_schlick#1.alpha"));
  EXPECT_THAT(labels(layout), testing::Not(testing::Contains("ggx_schlick#2.alpha")));
  EXPECT_EQ(layout.start().lobes[1].values[1][0], 0.5);
}

TEST(ParameterLayout, RulesThatMeanNothingAreErrors) {
  using testing::HasSubstr;
  ParameterRules misspelt, outside, upside_down, nothing, fixed_outside;
  misspelt.shared = {"alhpa"};
  outside.bounds = {{"alpha", 0.1, 3}};
  upside_down.bounds = {{"alpha", 0.3, 0.1}};
  nothing.fixed = {{"f0", {}}, {"alpha", {}}};
  fixed_outside.fixed = {{"alpha", 2.0}};
  EXPECT_THAT(error_of("ggx_schlick", misspelt), HasSubstr("'alpha'"));
  EXPECT_THAT(error_of("ggx_schlick", outside), HasSubstr("[0.001, 1]"));
  EXPECT_THAT(error_of("ggx_schlick", upside_down), HasSubstr("ascending"));
  EXPECT_THAT(error_of("ggx_schlick", nothing), HasSubstr("no parameter is left"));
  EXPECT_THAT(error_of("ggx_schlick", fixed_outside), HasSubstr("found 2"));
}

} // namespace
} // namespace nacre
