#include "fit/screening.h"

#include "fit/fit.h"
#include "fit/synthetic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

std::vector<std::string> linear_labels(const std::string& model) {
  const MerlTable table = tabulate("lambert", 0, 0, {12, 10, 20});
  const Observations at = observe(table, {});
  const ParameterLayout layout(parse_material(model));
  const Residuals residuals(at, Metric::log, layout);
  std::vector<std::string> labels;
  const Screening screening(residuals);
  for (const int i : screening.linear())
    labels.push_back(layout.label(i));
  return labels;
}

TEST(Screening, FindsWhatAModelIsAffineIn) {
  using testing::ElementsAre;
  EXPECT_THAT(linear_labels("ggx_schlick+lambert"),
              ElementsAre("ggx_schlick.f0.r", "ggx_schlick.f0.g", "ggx_schlick.f0.b", "lambert.reflectance.r",
                          "lambert.reflectance.g", "lambert.reflectance.b"));
  EXPECT_THAT(linear_labels("ggx_conductor"), ElementsAre());
  EXPECT_THAT(linear_labels("low_smooth"), ElementsAre("low_smooth.A.r", "low_smooth.A.g", "low_smooth.A.b"));
}

TEST(Screening, SolvesForTheAffineParametersInEveryMetric) {
  const MaterialSpec truth =
      parse_material("ggx_schlick:f0=0.05/0.2/0.6,alpha=0.15+lambert:reflectance=0.3/0.1/0.02");
  const MerlTable table = tabulate(to_text(truth));
  const Observations at = observe(table, {});
  const ParameterLayout layout(parse_material("ggx_schlick:alpha=0.15+lambert"));
  for (const Metric metric : all_metrics) {
    const Residuals residuals(at, metric, layout);
    const Candidate solved = Screening(residuals).solve(layout.coordinates(layout.start()));
    const std::vector<double> expected = layout.coordinates(truth);
    for (int i = 0; i < layout.size(); ++i)
      EXPECT_NEAR(solved.coordinates[std::size_t(i)], expected[std::size_t(i)], 1e-3)
          << layout.label(i) << " " << metric_name(metric);
  }
}

// The model is wrong for the table, so there are several optima.
TEST(Screening, MakesAFitIndependentOfTheSeed) {
  const MerlTable table =
      tabulate("beckmann_conductor:eta=1.2,k=4,alpha_x=0.05,alpha_y=0.05+"
               "ggx_schlick:f0=0.4,alpha=0.4+oren_nayar:reflectance=0.2/0.1/0.05,sigma=0.8",
               0, 0, {30, 20, 20});
  for (const char* model : {"ggx_schlick+ggx_schlick+lambert", "ashikhmin_shirley+lambert"}) {
    double least = 1e30, most = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const double error = fit(table, {.model = model, .seed = seed}).errors.log;
      least = std::min(least, error);
      most = std::max(most, error);
    }
    EXPECT_LT(most, least * (1 + 1e-5)) << model; // what single precision resolves
  }
}

TEST(Fit, ASumIsNoWorseThanItsParts) {
  const MerlTable table =
      tabulate("ward:specular_reflectance=0.3,alpha_x=0.1,alpha_y=0.1+oren_nayar:sigma=0.6");
  const auto error = [&](const char* model) { return fit(table, {.model = model}).fit_error; };
  const double sum = error("ggx_schlick+beckmann_conductor+lambert");
  EXPECT_LE(sum, error("ggx_schlick+lambert") * (1 + 1e-6));
  EXPECT_LE(sum, error("beckmann_conductor+lambert") * (1 + 1e-6));
}

} // namespace
} // namespace nacre
