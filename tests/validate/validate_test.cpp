// Each law catches a model that was broken on purpose.
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
