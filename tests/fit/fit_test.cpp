#include "fit/fit.h"

#include "core/error.h"
#include "core/parallel.h"
#include "fit/synthetic.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

const FittedParameter& find(const FitResult& result, const std::string& label) {
  for (const FittedParameter& p : result.parameters)
    if (p.label == label) return p;
  throw std::runtime_error("no parameter " + label);
}

std::string message_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

struct Known {
  std::string model, truth;
};

TEST(Fit, RecoversKnownParametersWithoutNoise) {
  const std::vector<Known> cases{
      {"lambert", "lambert:reflectance=0.2/0.5/0.9"},
      {"oren_nayar", "oren_nayar:reflectance=0.3/0.5/0.1,sigma=0.4"},
      {"ggx_schlick+lambert", "ggx_schlick:f0=0.05/0.2/0.6,alpha=0.08+lambert:reflectance=0.3/0.1/0.02"},
      {"ggx_schlick+lambert", "ggx_schlick:f0=0.8/0.5/0.3,alpha=0.6+lambert:reflectance=0.05"},
      {"ggx_schlick+lambert", "ggx_schlick:f0=0.04,alpha=0.01+lambert:reflectance=0.4/0.5/0.6"},
      {"ggx_conductor", "ggx_conductor:eta=0.2/0.9/1.4,k=3.9/2.4/1.6,alpha_x=0.3,alpha_y=0.3"},
      {"beckmann_conductor+lambert",
       "beckmann_conductor:eta=1.5,k=7,alpha_x=0.2,alpha_y=0.2+lambert:reflectance=0.1"},
      {"ggx_plastic", "ggx_plastic:diffuse_reflectance=0.5/0.3/0.1,eta=1.6,alpha=0.15"}};
  for (const Known& known : cases) {
    SCOPED_TRACE(known.truth);
    const MaterialSpec truth = parse_material(known.truth);
    const MerlTable table = tabulate(known.truth);
    for (const Metric metric : {Metric::cosine, Metric::log}) {
      SCOPED_TRACE(metric_name(metric));
      const FitResult result = fit(table, {.model = known.model, .metric = metric, .starts = 8});
      // The table and the residuals are single precision; 1e-3 of the domain or of the value is far above
      // that and far below what distinguishes materials.
      for (const FittedParameter& p : result.parameters) {
        const double expected = value_in(truth, p);
        EXPECT_NEAR(p.value, expected, 1e-3 * std::max(expected, 0.05)) << p.label;
      }
      EXPECT_LT(result.errors.of(metric), 1e-4);
    }
  }
}

TEST(Fit, NoiseMovesParametersByTheirStandardErrors) {
  const std::string truth = "ggx_schlick:f0=0.05/0.2/0.6,alpha=0.15+lambert:reflectance=0.3/0.1/0.02";
  const MaterialSpec material = parse_material(truth);
  for (const Metric metric : {Metric::cosine, Metric::log}) {
    double sum2 = 0;
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const FitResult result = fit(tabulate(truth, 0.02, seed), {.metric = metric, .starts = 3});
      for (const FittedParameter& p : result.parameters) {
        ASSERT_TRUE(p.identifiable) << p.label;
        ASSERT_FALSE(p.at_bound) << p.label;
        const double z = (p.value - value_in(material, p)) / p.standard_error;
        // Of 112 normal numbers the largest is above 4.5 with a probability of 1e-3.
        EXPECT_LT(std::abs(z), 4.5) << metric_name(metric) << " seed " << seed << " " << p.label;
        sum2 += z * z;
        ++count;
      }
    }
    // 56 squared normal numbers have mean 1 with deviation sqrt(2/56) = 0.19.
    EXPECT_GT(sum2 / count, 0.4) << metric_name(metric);
    EXPECT_LT(sum2 / count, 1.8) << metric_name(metric);
  }
}

TEST(Fit, NoNeighbourIsBetterWhereTheModelIsWrong) {
  // Residuals stay large: the case in which Gauss and Newton's method alone stops far from the optimum.
  const MerlTable table = tabulate("beckmann_conductor:eta=3,k=0,alpha_x=0.3,alpha_y=0.3+oren_nayar:sigma=1");
  for (const char* model : {"ggx_schlick+lambert", "ggx_conductor+lambert"})
    for (const Metric metric : {Metric::cosine, Metric::log}) {
      // The grid of the fit is the whole table, so that the error over it can be asked for at other
      // parameters.
      const FitResult best =
          fit(table, {.model = model, .metric = metric, .starts = 4, .theta_d_step = 1, .phi_d_step = 1});
      EXPECT_TRUE(best.converged) << best.message;
      EXPECT_NEAR(best.fit_error, best.errors.of(metric), 1e-5 * best.fit_error);
      for (const FittedParameter& p : best.parameters)
        for (const double sign : {-1.0, 1.0}) {
          const double step = p.at_bound ? 1e-2 * (p.hi - p.lo) : p.standard_error;
          MaterialSpec moved = best.material;
          LobeSpec& lobe = moved.lobes[std::size_t(p.lobe)];
          const auto& declared = model_info(lobe).parameters;
          for (std::size_t k = 0; k < declared.size(); ++k)
            if (declared[k].name == p.name || declared[k].name == p.tied)
              for (int c = 0; c < 3; ++c)
                if (p.channel < 0 || p.channel == c)
                  lobe.values[k][std::size_t(c)] = std::clamp(p.value + sign * step, p.lo, p.hi);
          EXPECT_GE(metric_errors(table, moved).of(metric), best.errors.of(metric) * (1 - 1e-7))
              << model << " " << p.label << " " << p.value << " " << sign * step;
        }
    }
}

TEST(Fit, StaysInsideBoundsAndSaysSo) {
  // A body twice as bright as a white one, with a peak outside every domain.
  const MerlTable table = MerlTable::tabulate(30, 30, 60, [](double, double, double) {
    return std::array{2 / pi, 0.5 / pi, 0.25 / pi};
  });
  const FitResult result = fit(table, {.model = "lambert"});
  const FittedParameter& red = find(result, "lambert.reflectance.r");
  EXPECT_EQ(red.value, 1);
  EXPECT_TRUE(red.at_bound);
  EXPECT_TRUE(std::isnan(red.standard_error));
  EXPECT_FALSE(find(result, "lambert.reflectance.g").at_bound);
  EXPECT_NEAR(find(result, "lambert.reflectance.g").value, 0.5, 1e-5);

  const FitResult two = fit(table, {.model = "ggx_schlick+oren_nayar", .starts = 12});
  for (const FittedParameter& p : two.parameters) {
    EXPECT_GE(p.value, p.lo) << p.label;
    EXPECT_LE(p.value, p.hi) << p.label;
  }
}

TEST(Fit, ParametersThatTradeOffAreFlaggedWithTheirPartner) {
  const MerlTable table = tabulate("lambert:reflectance=0.6/0.5/0.4");
  const FitResult result =
      fit(table, {.model = "lambert:reflectance=0.3+lambert:reflectance=0.2", .starts = 1});
  for (const char channel : {'r', 'g', 'b'}) {
    const FittedParameter& p = find(result, fmt::format("lambert#1.reflectance.{}", channel));
    EXPECT_FALSE(p.identifiable) << p.label;
    EXPECT_TRUE(std::isnan(p.standard_error)) << p.label;
    EXPECT_EQ(p.partner, fmt::format("lambert#2.reflectance.{}", channel));
  }
  EXPECT_LT(result.errors.log, 1e-6);
}

TEST(Fit, ThreadsAndRepetitionDoNotChangeTheResult) {
  const MerlTable table = tabulate("ggx_schlick:f0=0.1/0.2/0.6,alpha=0.15+lambert:reflectance=0.3", 0.1, 5);
  std::vector<nlohmann::json> results;
  for (const int threads : {1, 2, 2}) {
    set_thread_count(threads);
    nlohmann::json json = to_json(fit(table, {.starts = 6, .seed = 3}));
    json["fit"].erase("seconds");
    results.push_back(json);
  }
  set_thread_count(0);
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[1], results[2]);
}

TEST(Fit, IsotropicDataTieRoughnessUnlessAskedNotTo) {
  const std::string truth = "ggx_conductor:eta=1,k=6,alpha_x=0.3,alpha_y=0.3";
  const MerlTable table = tabulate(truth);
  const FitResult tied = fit(table, {.model = "ggx_conductor", .starts = 4});
  EXPECT_EQ(find(tied, "ggx_conductor.alpha_x").tied, "alpha_y");
  EXPECT_EQ(tied.parameters.size(), 7u);
  const FitResult free = fit(table, {.model = "ggx_conductor", .starts = 4, .isotropic = false});
  EXPECT_EQ(free.parameters.size(), 8u);
  EXPECT_NEAR(find(free, "ggx_conductor.alpha_x").value, 0.3, 1e-3);
  EXPECT_NEAR(find(free, "ggx_conductor.alpha_y").value, 0.3, 1e-3);
}

TEST(Fit, ResultReadsBackAsTheMaterial) {
  const FitResult result =
      fit(tabulate("ggx_schlick:f0=0.1/0.2/0.6,alpha=0.15+lambert:reflectance=0.3"), {.starts = 2});
  const nlohmann::json json = nlohmann::json::parse(to_json(result).dump());
  const MaterialSpec back = material_from_json(json, "fit.json");
  ASSERT_EQ(back.lobes.size(), 2u);
  for (std::size_t l = 0; l < 2; ++l)
    EXPECT_EQ(back.lobes[l].values, result.material.lobes[l].values);
  EXPECT_EQ(json.at("fit").at("parameters").size(), result.parameters.size());
  EXPECT_EQ(json.at("fit").at("metric"), "log");
}

TEST(Fit, SwitchesStayAsGiven) {
  const std::string truth = "ggx_conductor:eta=1,k=6,alpha_x=0.5,alpha_y=0.5,separable=1";
  const FitResult result = fit(tabulate(truth), {.model = "ggx_conductor:separable=1", .starts = 4});
  EXPECT_LT(result.errors.log, 1e-5);
  for (const FittedParameter& p : result.parameters)
    EXPECT_NE(p.name, "separable");
}

TEST(Fit, WhatCannotBeFittedIsAnError) {
  using testing::HasSubstr;
  const MerlTable table = tabulate("lambert:reflectance=0.5");
  const MerlTable holes = MerlTable::tabulate(10, 10, 20, [](double, double, double) {
    return std::array{-1.0, -1.0, -1.0};
  });
  const auto error = [&](const MerlTable& t, FitOptions o) { return message_of([&] { fit(t, o); }); };
  EXPECT_THAT(error(holes, {}), HasSubstr("0 measured values"));
  EXPECT_THAT(message_of([&] { metric_errors(holes, parse_material("lambert")); }),
              HasSubstr("nothing was measured"));
  EXPECT_THAT(error(table, {.model = "smooth_conductor"}), HasSubstr("mirror direction"));
  EXPECT_THAT(error(table, {.model = "lambert+smooth_conductor"}), HasSubstr("smooth_conductor"));
  EXPECT_THAT(error(table, {.model = "ggx_shlick"}), HasSubstr("ggx_schlick"));
  EXPECT_THAT(error(table, {.model = "lambert+lambert+lambert+lambert+lambert"}), HasSubstr("1 to 4 lobes"));
  EXPECT_THAT(error(table, {.model = "walk_ggx_conductor"}), HasSubstr("estimate by chance"));
  EXPECT_THAT(error(table, {.starts = 0}), HasSubstr("starts"));
  EXPECT_THAT(error(table, {.refined = 0}), HasSubstr("refines"));
  EXPECT_THAT(error(table, {.max_theta_deg = 0}), HasSubstr("cut"));
  EXPECT_THAT(error(table, {.max_theta_deg = std::nan("")}), HasSubstr("cut"));
  EXPECT_THAT(error(table, {.theta_d_step = -1}), HasSubstr("steps"));
  EXPECT_THAT(error(table, {.max_iterations = 0}), HasSubstr("iteration"));
  EXPECT_THAT(error(table, {.screened = 0}), HasSubstr("screens"));
  EXPECT_THAT(error(table, {.channel = 3}), HasSubstr("channel"));
  EXPECT_THAT(error(table, {.confidence = 1}), HasSubstr("confidence"));
  EXPECT_THAT(message_of([] { parse_metric("lgo"); }), HasSubstr("log"));
  EXPECT_THAT(message_of([] { parse_loss("hubber"); }), HasSubstr("huber"));
}

} // namespace
} // namespace nacre
