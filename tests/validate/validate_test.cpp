// Every model of the list keeps the laws it claims; and each law catches a model that was broken on purpose.
#include "validate/validate.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

const LawResult& law(const ValidationReport& report, std::string_view name) {
  for (const LawResult& l : report.laws)
    if (l.law == name) return l;
  throw std::runtime_error("no law " + std::string(name));
}

ValidateOptions quick() {
  ValidateOptions options;
  options.samples = 20000;
  options.directions = 4000;
  return options;
}

/// Materials that stand for a model: its defaults, rough and smooth ends, strong absorption, both signs of
/// log eta.
std::vector<std::string> materials_of(const ModelInfo& model) {
  std::vector<std::string> texts{model.name};
  const auto add = [&](const char* values) { texts.push_back(fmt::format("{}:{}", model.name, values)); };
  const auto has = [&](std::string_view p) {
    return std::any_of(model.parameters.begin(), model.parameters.end(),
                       [&](const auto& q) { return q.name == p; });
  };
  if (has("alpha_x") && has("alpha_y")) {
    add("alpha_x=0.02,alpha_y=0.3");
    add("alpha_x=1,alpha_y=1");
  }
  if (has("alpha")) {
    add("alpha=0.01");
    add("alpha=1");
  }
  if (has("eta") && has("k")) add("eta=0.14/0.4/1.5,k=4/2.4/1.9");
  if (model.laws.transmits) add("eta=0.6");
  if (has("sigma") && has("reflectance")) add("sigma=0.2,reflectance=1");
  if (has("reflectance")) add("reflectance=1/0.5/0");
  if (has("diffuse_reflectance") && has("eta")) add("diffuse_reflectance=1,eta=1.9");
  return texts;
}

class ModelLaws : public testing::TestWithParam<std::string> {};

TEST_P(ModelLaws, AreKeptAsClaimed) {
  const ModelInfo& model = find_model(GetParam());
  for (const std::string& text : materials_of(model)) {
    const ValidationReport report = validate(parse_material(text), quick());
    for (const LawResult& l : report.laws) {
      if (l.law == "energy conservation" && model.laws.energy_gain > 0) {
        EXPECT_LE(l.worst - l.error, model.laws.energy_gain) << text;
        continue;
      }
      EXPECT_TRUE(l.verdict == Verdict::holds) << text << ": " << l.law << " " << l.worst << " +- " << l.error
                                               << " at " << l.where << "\n  " << l.command;
    }
  }
}

std::vector<std::string> model_names() {
  std::vector<std::string> names;
  for (const ModelInfo& m : model_infos())
    names.push_back(m.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(List, ModelLaws, testing::ValuesIn(model_names()),
                         [](const auto& instance) { return instance.param; });

TEST(Validate, OrenNayarsGainIsFoundAtGrazing) {
  const ValidationReport report = validate(parse_material("oren_nayar:reflectance=1,sigma=0.2"), quick());
  const LawResult& energy = law(report, "energy conservation");
  EXPECT_EQ(energy.verdict, Verdict::violated);
  EXPECT_NEAR(energy.worst, 0.015, 0.003);
}

TEST(Validate, ASumOfLobesKeepsTheLawsOfItsParts) {
  for (const char* text :
       {"ggx_conductor:specular_reflectance=0.5,alpha_x=0.05+lambert:reflectance=0.4",
        "smooth_conductor:specular_reflectance=0.3+beckmann_conductor:specular_reflectance=0.5",
        "smooth_plastic:diffuse_reflectance=0.2,specular_reflectance=0.5+oren_nayar:reflectance=0.2"})
    for (const LawResult& l : validate(parse_material(text), quick()).laws)
      EXPECT_TRUE(l.verdict == Verdict::holds)
          << text << ": " << l.law << " " << l.worst << " at " << l.where;
}

// The usual sum of a coat and a base gives both the light that Fresnel reflects at grazing angles.
TEST(Validate, SchlickOverLambertGainsEnergyAtGrazing) {
  const ValidationReport report =
      validate(parse_material("ggx_schlick:f0=0.3,alpha=0.05+lambert:reflectance=0.4"), quick());
  EXPECT_TRUE(law(report, "energy conservation").verdict == Verdict::violated);
}

TEST(Validate, AlbedoOfLambertIsItsReflectance) {
  const ValidationReport report = validate(parse_material("lambert:reflectance=0.8/0.5/0.2"), quick());
  for (const AlbedoSample& a : report.albedo) {
    EXPECT_NEAR(a.albedo[0], 0.8, 1e-5);
    EXPECT_NEAR(a.albedo[2], 0.2, 1e-5);
  }
}

TEST(Validate, RoughMetalLosesTheEnergyOfMultipleBounces) {
  // White GGX at alpha = 1 keeps about half of the light from 60 degrees; at 0.1 nearly all.
  const auto at = [&](const std::string& text, double theta) {
    for (const AlbedoSample& a : validate(parse_material(text), quick()).albedo)
      if (std::abs(a.theta_deg - theta) < 0.1) return a.albedo[0];
    return -1.0;
  };
  EXPECT_GT(at("ggx_schlick:f0=1,alpha=0.05", 45), 0.99);
  EXPECT_LT(at("ggx_schlick:f0=1,alpha=1", 60), 0.65);
}

} // namespace
} // namespace nacre
