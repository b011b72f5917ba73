// Each law catches a model that was broken on purpose.
#include "validate/validate.h"

#include "measured/function_bsdf.h"

#include <array>
#include <cstdio>
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

TEST(Validate, OrenNayarsGainIsFoundAtGrazing) {
  const ValidationReport report = validate(parse_material("oren_nayar:reflectance=1,sigma=0.2"), quick());
  const LawResult& energy = law(report, "energy conservation");
  EXPECT_EQ(energy.verdict, Verdict::violated);
  EXPECT_NEAR(energy.worst, 0.015, 0.003);
}

// Ward's original gains where the viewer looks along the rough axis: the material says which that is.
TEST(Validate, AGainAcrossTheGrainIsFoundWhicheverWayItRuns) {
  for (const char* text : {"ward:specular_reflectance=0.8,alpha_x=0.05,alpha_y=1",
                           "ward:specular_reflectance=0.8,alpha_x=1,alpha_y=0.05"}) {
    const LawResult energy = law(validate(parse_material(text), quick()), "energy conservation");
    EXPECT_EQ(energy.verdict, Verdict::violated) << text;
    EXPECT_GT(energy.worst, 0.6) << text;
    EXPECT_NE(energy.where.find("phi_o"), std::string::npos) << energy.where;
    EXPECT_NE(energy.command.find("--phi-o"), std::string::npos) << energy.command;
  }
}

TEST(Validate, AGainAtOneAzimuthAloneIsFound) {
  Scattering gaining = Scattering::of(parse_material("lambert:reflectance=0.5"));
  const auto lambert = gaining.eval;
  gaining.eval = [lambert](const Vec3d& wo, const Vec3d& wi) { // reciprocal, and half a turn is no symmetry
    const auto lobe = [](const Vec3d& w) { return sqr(std::max(-w.x - w.y, 0.0)); };
    return lambert(wo, wi) * (1 + 4 * lobe(wo) * lobe(wi));
  };
  gaining.sample = [sample = gaining.sample, eval = gaining.eval](const Vec3d& wo, double u_lobe,
                                                                  Vec2<double> u) {
    auto s = sample(wo, u_lobe, u);
    s.f = eval(wo, s.wi);
    return s;
  };
  const ValidationReport report = validate(gaining, "planted", {}, quick());
  EXPECT_EQ(law(report, "energy conservation").verdict, Verdict::violated);
  EXPECT_EQ(law(report, "reciprocity").verdict, Verdict::holds);
}

TEST(Validate, WhatIsTheSameAllAroundIsJudgedAtOneAzimuth) {
  for (const char* text : {"oren_nayar:reflectance=1", "ggx_conductor:alpha=0.001", "ggx_dielectric:eta=1.5"})
    for (const LawResult& l : validate(parse_material(text), quick()).laws)
      EXPECT_EQ(l.where.find("phi_o"), std::string::npos) << text << ": " << l.law << " " << l.where;
}

TEST(Validate, ASumOfLobesKeepsTheLawsOfItsParts) {
  for (const char* text :
       {"ggx_conductor:specular_reflectance=0.5,alpha_x=0.05+lambert:reflectance=0.4",
        "smooth_conductor:specular_reflectance=0.3+beckmann_conductor:specular_reflectance=0.5",
        "smooth_plastic:diffuse_reflectance=0.2,specular_reflectance=0.5+oren_nayar:reflectance=0.2"})
    for (const LawResult& l : validate(parse_material(text), quick()).laws)
      EXPECT_TRUE(l.verdict != Verdict::violated)
          << text << ": " << l.law << " " << l.worst << " at " << l.where;
}

// Steep facets across the grain mirror nothing upwards for a viewer above, and a diffuse lobe's samples hide
// the edge of a sharp one; the integrals must meet both, or a good surface would be condemned.
TEST(Validate, BrushedAndPolishedSurfacesKeepTheLawsOfFacets) {
  for (const char* text :
       {"ggx_conductor:alpha_x=0.001,alpha_y=1", "beckmann_conductor:alpha_x=0.01,alpha_y=0.5",
        "beckmann_conductor:alpha_x=0.2,alpha_y=0.001", "beckmann_plastic:alpha=0.001",
        "ggx_dielectric:glass=BK7,alpha=0.4"}) {
    const ValidationReport report = validate(parse_material(text), quick());
    for (const char* name : {"normalisation of D", "projected area of visible facets", "weak white furnace",
                             "albedo by sampling", "chi-square of directions"})
      EXPECT_TRUE(law(report, name).verdict == Verdict::holds)
          << text << ": " << name << " " << law(report, name).worst << " at " << law(report, name).where;
  }
}

/// The other laws in passing: masking by quadrature makes them slow.
ValidationReport facets_alone(const Scattering& surface) {
  ValidateOptions options;
  options.samples = 2000;
  options.directions = 100;
  return validate(surface, "facets", {}, options);
}

// Facets of distributions with long tails stand nearly upright, many beyond the range of floats: what the
// quadrature cannot ask is its error, no fault of the surface.
TEST(Validate, LongTailsOfSteepFacetsAreNotCondemned) {
  for (const char* text :
       {"student_t_conductor:gamma=1.51,alpha=0.1", "exponential_power_conductor:p=0.2,beta_x=1,beta_y=1",
        "exponential_power_conductor:p=0.2,beta_x=0.01,beta_y=1", "gtr_conductor:gamma=1.5,alpha=0.5"}) {
    const ValidationReport report = facets_alone(Scattering::of(parse_material(text)));
    for (const char* name : {"normalisation of D", "projected area of visible facets", "weak white furnace"})
      EXPECT_TRUE(law(report, name).verdict == Verdict::holds)
          << text << ": " << name << " " << law(report, name).worst << " +- " << law(report, name).error
          << " at " << law(report, name).where;
  }
}

// Nor does the error excuse a fault: 1 % too much masking, for which a tail no longer than that of GGX is no
// excuse.
TEST(Validate, AFaultOfFacetsIsFoundUnderATail) {
  for (const char* text : {"student_t_conductor:gamma=2,alpha=0.3", "exponential_power_conductor:p=0.3",
                           "ggx_conductor:alpha_x=0.01,alpha_y=0.8"}) {
    Scattering surface = Scattering::of(parse_material(text));
    ASSERT_EQ(surface.facets.size(), 1u);
    surface.facets[0].G1 = [G1 = surface.facets[0].G1](const Vec3d& w, const Vec3d& wm) {
      return 0.99 * G1(w, wm);
    };
    const ValidationReport report = facets_alone(surface);
    EXPECT_EQ(law(report, "projected area of visible facets").verdict, Verdict::violated) << text;
    EXPECT_EQ(law(report, "weak white furnace").verdict, Verdict::violated) << text;
    EXPECT_EQ(law(report, "normalisation of D").verdict, Verdict::holds) << text;
  }
}

// The scaling of OpenPBR's layers is not reciprocal; glass without layers is, on both sides of the horizon.
TEST(Validate, GlassOfOpenPbrIsReciprocal) {
  for (const char* text : {"openpbr:transmission_weight=1", "openpbr_thin:transmission_weight=1"}) {
    ValidateOptions options = quick();
    options.samples = 1000;
    const MaterialSpec glass = parse_material(text);
    const LawResult reciprocal =
        law(validate(Scattering::of(glass), text, Sides::of(glass), options), "reciprocity");
    EXPECT_EQ(reciprocal.verdict, Verdict::holds) << reciprocal.worst << "  " << reciprocal.command;
    const auto bsdf = make_bsdf<double>(parse_material(text));
    for (const double z : {0.0, -0.0}) // in the surface nothing is scattered
      for (const Vec3d& w :
           {Vec3d{0.6, 0, 0.8}, Vec3d{0.6, 0, -0.8}, Vec3d{-1, 0, 0.0}, Vec3d{-1, 0, -0.0}}) {
        EXPECT_EQ(max_component(bsdf.eval({1, 0, z}, w)), 0) << text;
        EXPECT_EQ(max_component(bsdf.eval(w, {1, 0, z})), 0) << text;
      }
  }
}

// A violation's command, given to a shell, gives the program the same material and directions again.
TEST(Validate, CommandsNameTheMaterialAsItWasGivenAndTheDirectionsToTheLastDigit) {
  MaterialSpec material = parse_material("oren_nayar_full:reflectance=1");
  material.name = "of a file";
  material.argument = "it's a $(file).json";
  Scattering wrong = Scattering::of(material);
  const ValidationReport report = validate(material, quick());
  EXPECT_EQ(report.material, "of a file");
  for (const LawResult& l : report.laws)
    if (l.law == "energy conservation") {
      EXPECT_EQ(l.command.rfind("nacre eval 'it'\\''s a $(file).json' --theta-o", 0), 0u) << l.command;
    }
  const auto good = wrong.eval;
  wrong.eval = [good](const Vec3d& wo, const Vec3d& wi) { return good(wo, wi) * wi.z; };
  const LawResult reciprocal = law(validate(wrong, "x", {}, quick()), "reciprocity");
  ASSERT_TRUE(reciprocal.wo && reciprocal.wi);
  double w[6];
  ASSERT_EQ(std::sscanf(reciprocal.command.c_str(), "nacre eval x --wo=%lf,%lf,%lf --wi=%lf,%lf,%lf", w,
                        w + 1, w + 2, w + 3, w + 4, w + 5),
            6)
      << reciprocal.command;
  const Vec3d &wo = *reciprocal.wo, &wi = *reciprocal.wi;
  EXPECT_EQ(std::to_array(w), (std::array{wo.x, wo.y, wo.z, wi.x, wi.y, wi.z}));
}

// Pictures take a negative value as 0; a judge must not, and a lobe beside it must not hide it all.
TEST(Validate, NegativeValuesOfShadersAndMeasurementsAreFound) {
  const auto model = UserModel::parse("analytic\n::begin shader\n"
                                      "vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n"
                                      "  return vec3(0.3, 0.3 - 0.6 * dot(L, N) * dot(V, N), 0.3);\n"
                                      "}\n::end shader\n",
                                      "negative.brdf");
  const MaterialSpec shader{"negative.brdf", {user_lobe(model, model->initial_values())}};
  LobeSpec table;
  table.measured = std::make_shared<FunctionBsdf>([](const Vec3d& wo, const Vec3d& wi) {
    return std::array{0.3, 0.3 - 0.6 * wo.z * wi.z, 0.3};
  });
  MaterialSpec sum = shader;
  sum.lobes.push_back(default_lobe(model_index("lambert")));
  sum.lobes.back().values[0] = {0.1, 0.1, 0.1};
  const Vec3d up{0, 0, 1};
  for (const MaterialSpec& material : {shader, MaterialSpec{"table", {table}}, sum}) {
    const double expected = material.lobes.size() == 2 ? -0.3 + 0.1 / pi : -0.3;
    const Scattering judged = Scattering::of(material);
    EXPECT_NEAR(judged.eval(up, up)[1], expected, 1e-6) << material.name;
    EXPECT_GE(make_bsdf<double>(material).eval(up, up)[1], 0) << material.name; // as a renderer has it
  }
  ValidateOptions options;
  options.samples = 2000;
  options.directions = 1000;
  const LawResult positive = law(validate(shader, options), "positivity");
  EXPECT_EQ(positive.verdict, Verdict::violated);
  EXPECT_NEAR(positive.worst, -0.3, 1e-6);
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
