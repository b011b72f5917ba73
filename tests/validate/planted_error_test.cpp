// Each law catches the error it is there for: a good model is broken on purpose, one way at a time.
#include "validate/validate.h"

#include <gtest/gtest.h>
#include <limits>

namespace nacre {
namespace {

Scattering good() {
  return Scattering::of(make_bsdf<double>(parse_material("ggx_schlick:f0=0.9,alpha=0.3")));
}

/// The laws that a model breaks.
std::vector<std::string> broken_laws(const Scattering& model) {
  ValidateOptions options;
  options.samples = 20000;
  options.directions = 4000;
  std::vector<std::string> names;
  for (const LawResult& law : validate(model, "planted", {}, options).laws)
    if (law.verdict == Verdict::violated) names.push_back(law.law);
  return names;
}

bool catches(const Scattering& model, const std::string& law) {
  const auto names = broken_laws(model);
  return std::find(names.begin(), names.end(), law) != names.end();
}

TEST(PlantedError, NoneIsFoundInAGoodModel) { EXPECT_TRUE(broken_laws(good()).empty()); }

TEST(PlantedError, CosineInTheValueBreaksReciprocity) {
  Scattering m = good();
  m.eval = [g = good()](const Vec3d& wo, const Vec3d& wi) { return g.eval(wo, wi) * wi.z; };
  EXPECT_TRUE(catches(m, "reciprocity"));
}

TEST(PlantedError, MissingPiBreaksEnergyConservation) {
  const Scattering lambert = Scattering::of(make_bsdf<double>(parse_material("lambert:reflectance=0.8")));
  Scattering m = lambert;
  m.eval = [lambert](const Vec3d& wo, const Vec3d& wi) { return lambert.eval(wo, wi) * pi; };
  EXPECT_TRUE(catches(m, "energy conservation"));
}

TEST(PlantedError, MissingFactorOfTheHalfVectorBreaksThePdf) {
  Scattering m = good(); // dwm/dwi = 1 / (4 wo.wm), with the 4 forgotten
  m.pdf = [g = good()](const Vec3d& wo, const Vec3d& wi) { return 4 * g.pdf(wo, wi); };
  m.sample = [g = good()](const Vec3d& wo, double u_lobe, Vec2<double> u) {
    auto s = g.sample(wo, u_lobe, u);
    s.pdf *= 4;
    return s;
  };
  EXPECT_TRUE(catches(m, "pdf normalisation"));
  EXPECT_TRUE(catches(m, "albedo by sampling"));
}

TEST(PlantedError, OtherRoughnessInTheSamplerBreaksTheChiSquareTest) {
  Scattering m = good();
  const Scattering other = Scattering::of(make_bsdf<double>(parse_material("ggx_schlick:f0=0.9,alpha=0.33")));
  m.sample = [g = good(), other](const Vec3d& wo, double u_lobe, Vec2<double> u) {
    auto s = other.sample(wo, u_lobe, u);
    if (s.pdf > 0) s.f = g.eval(wo, s.wi), s.pdf = g.pdf(wo, s.wi);
    return s;
  };
  EXPECT_TRUE(catches(m, "chi-square of directions"));
}

TEST(PlantedError, SampleThatDisagreesWithEvalIsFound) {
  Scattering m = good();
  m.sample = [g = good()](const Vec3d& wo, double u_lobe, Vec2<double> u) {
    auto s = g.sample(wo, u_lobe, u);
    s.f = s.f * 1.001;
    return s;
  };
  EXPECT_TRUE(catches(m, "sample agrees with eval and pdf"));
}

TEST(PlantedError, NegativeValueIsFound) {
  Scattering m = good();
  m.eval = [g = good()](const Vec3d& wo, const Vec3d& wi) {
    return g.eval(wo, wi) - Spectrum<double, 3>(1e-4);
  };
  EXPECT_TRUE(catches(m, "positivity"));
}

TEST(PlantedError, NanAtTheHorizonIsFound) {
  Scattering m = good();
  m.eval = [g = good()](const Vec3d& wo, const Vec3d& wi) {
    return wi.z == 0 ? Spectrum<double, 3>(std::numeric_limits<double>::quiet_NaN()) : g.eval(wo, wi);
  };
  EXPECT_TRUE(catches(m, "finiteness"));
}

// A judge does not fall over what it judges.
TEST(PlantedError, ADensityThatIsNegativeOrNoNumberIsFoundAndNotStumbledOver) {
  for (const double wrong : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    Scattering m = good();
    m.pdf = [g = good(), wrong](const Vec3d& wo, const Vec3d& wi) {
      return wi.z > 0.5 ? g.pdf(wo, wi) * wrong : g.pdf(wo, wi);
    };
    EXPECT_TRUE(catches(m, wrong < 0 ? "positivity" : "finiteness"));
    EXPECT_TRUE(catches(m, "chi-square of directions"));
  }
}

TEST(PlantedError, AlbedoThatIsNoNumberBreaksEnergyConservation) {
  Scattering m = good();
  m.eval = [g = good()](const Vec3d& wo, const Vec3d& wi) {
    return g.eval(wo, wi) * (wi.z > 0.3 ? std::numeric_limits<double>::quiet_NaN() : 1);
  };
  EXPECT_TRUE(catches(m, "energy conservation"));
}

} // namespace
} // namespace nacre
