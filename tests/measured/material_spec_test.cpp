// Materials as people write them: text and JSON, and what is said when they are wrong.
#include "measured/material_spec.h"

#include "core/error.h"
#include "core/random.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

std::string message_of(const std::string& text) {
  try {
    parse_material(text);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(MaterialSpec, TextNamesModelsAndValues) {
  const MaterialSpec m = parse_material("ggx_schlick:f0=0.9/0.6/0.3,alpha=0.2+lambert:reflectance=0.1");
  ASSERT_EQ(m.lobes.size(), 2u);
  EXPECT_EQ(m.lobes[0].values[0], (std::array<double, 3>{0.9, 0.6, 0.3}));
  EXPECT_EQ(m.lobes[0].values[1][0], 0.2);
  EXPECT_EQ(m.lobes[1].values[0], (std::array<double, 3>{0.1, 0.1, 0.1}));
}

TEST(MaterialSpec, WhatIsNotNamedIsTheDefault) {
  const MaterialSpec m = parse_material("oren_nayar");
  const ModelInfo& info = find_model("oren_nayar");
  for (std::size_t i = 0; i < info.parameters.size(); ++i)
    EXPECT_EQ(m.lobes[0].values[i][0], info.parameters[i].initial);
}

TEST(MaterialSpec, TextAndJsonReadBackToTheSameMaterial) {
  for (const char* text :
       {"lambert:reflectance=0.25/0.5/1", "ggx_schlick:f0=0.04,alpha=0.001+lambert:reflectance=0",
        "0.3*lambert+1.7e-5*oren_nayar:sigma=0.2+0*phong"}) {
    const MaterialSpec m = parse_material(text);
    const MaterialSpec from_text = parse_material(to_text(m));
    const MaterialSpec from_json = material_from_json(to_json(m), "memory");
    for (std::size_t l = 0; l < m.lobes.size(); ++l) {
      EXPECT_EQ(m.lobes[l].values, from_text.lobes[l].values);
      EXPECT_EQ(m.lobes[l].weight, from_text.lobes[l].weight);
      EXPECT_EQ(m.lobes[l].weight, from_json.lobes[l].weight);
      EXPECT_EQ(m.lobes[l].values, from_json.lobes[l].values);
    }
  }
}

// As %g and most programs write large numbers.
TEST(MaterialSpec, ThePlusOfAnExponentIsNoNextLobe) {
  const MaterialSpec m =
      parse_material("low_smooth:A=1e+3/2.E+2/5,B=1.5e+05+1e+0*lambert+lambert:reflectance=1e-1");
  ASSERT_EQ(m.lobes.size(), 3u);
  EXPECT_EQ(m.lobes[0].values[0], (std::array<double, 3>{1000, 200, 5}));
  EXPECT_EQ(m.lobes[0].values[1][0], 1.5e5);
  EXPECT_EQ(m.lobes[2].values[0][0], 0.1);
}

TEST(MaterialSpec, AlphaIsBothAlphas) {
  EXPECT_EQ(parse_material("ggx_conductor:alpha=0.3").lobes[0].values,
            parse_material("ggx_conductor:alpha_x=0.3,alpha_y=0.3").lobes[0].values);
  EXPECT_THAT(message_of("ggx_conductor:alpha=0.3,alpha_y=0.1"),
              testing::HasSubstr("alpha_y is given twice"));
  EXPECT_THAT(message_of("ggx_conductor:alpha=2"), testing::HasSubstr("alpha_x = 2 lies outside its domain"));
  EXPECT_THAT(message_of("lambert:alpha=1"), testing::HasSubstr("no parameter 'alpha'"));
}

// Not the metal of the default k with the index of glass.
TEST(MaterialSpec, GlassDoesNotAbsorb) {
  const LobeSpec lobe = parse_material("ggx_conductor:glass=BK7").lobes[0];
  const ModelInfo& model = model_info(lobe);
  EXPECT_NEAR(lobe.values[model.parameter_index("eta")][1], 1.52, 0.01);
  EXPECT_EQ(lobe.values[model.parameter_index("k")], (std::array<double, 3>{0, 0, 0}));
}

TEST(MaterialSpec, ErrorsNameTheMistakeAndTheNearestName) {
  EXPECT_THAT(message_of("ggx_schlick:metal=Au"), testing::HasSubstr("metal sets eta and k"));
  EXPECT_THAT(message_of("lambertt"), testing::HasSubstr("did you mean 'lambert'"));
  EXPECT_THAT(message_of("lambert:reflectence=1"), testing::HasSubstr("did you mean 'reflectance'"));
  EXPECT_THAT(message_of("lambert:reflectance=2"), testing::HasSubstr("outside its domain [0, 1]"));
  EXPECT_THAT(message_of("lambert:reflectance=abc"), testing::HasSubstr("expected a number, found 'abc'"));
  EXPECT_THAT(message_of("lambert:reflectance=nan"), testing::HasSubstr("expected a number"));
  EXPECT_THAT(message_of("lambert:reflectance=1/2"), testing::HasSubstr("one number or three"));
  EXPECT_THAT(message_of("lambert:reflectance"), testing::HasSubstr("PARAM=VALUE"));
  EXPECT_THAT(message_of("lambert+lambert+lambert+lambert+lambert"), testing::HasSubstr("1 to 4 lobes"));
  EXPECT_THAT(message_of("x*lambert:reflectance=1"),
              testing::HasSubstr("weight of lambert: expected a number, found 'x'"));
  EXPECT_THAT(message_of("-1*lambert"), testing::HasSubstr("weight = -1 lies outside its domain"));
  EXPECT_THAT(message_of("2*lambertt"), testing::HasSubstr("did you mean 'lambert'"));
  EXPECT_THAT(message_of("2*"), testing::HasSubstr("unknown model"));
  EXPECT_THAT(message_of("nowhere/there.binary"), testing::HasSubstr("nowhere/there.binary"));
}

TEST(MaterialSpec, ASumEvaluatesToTheSumOfItsLobes) {
  const Vec3d wo = spherical_direction(0.5, 0.0), wi = spherical_direction(0.7, 2.5);
  const auto value = [&](const char* text) {
    return make_bsdf<double>(parse_material(text)).eval(wo, wi)[1];
  };
  EXPECT_NEAR(value("ggx_schlick:alpha=0.4+lambert:reflectance=0.3"),
              value("ggx_schlick:alpha=0.4") + value("lambert:reflectance=0.3"), 1e-15);
  EXPECT_NEAR(value("0.25*ggx_schlick:alpha=0.4+2*lambert:reflectance=0.3"),
              0.25 * value("ggx_schlick:alpha=0.4") + 2 * value("lambert:reflectance=0.3"), 1e-15);
}

TEST(MaterialSpec, DamagedJsonIsAnErrorOrAMaterialNeverACrash) {
  const std::string good = to_json(parse_material("ggx_schlick:f0=0.9/0.6/0.3+lambert")).dump();
  int refused = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string bad = good;
    for (int k = 0; k <= i % 3; ++k)
      bad[hash(1, i, k) % bad.size()] = char(hash(2, i, k) % 256);
    if (i % 5 == 0) bad.resize(hash(3, i) % bad.size());
    try {
      material_from_json(nlohmann::json::parse(bad), "memory");
    } catch (const Error&) {
      ++refused;
    } catch (const nlohmann::json::parse_error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
}

} // namespace
} // namespace nacre
