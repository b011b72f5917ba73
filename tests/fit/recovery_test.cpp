// Known random parameters come back, from noisy tables with MERL's sampling, within the stated uncertainty.

#include "fit/fit.h"
#include "fit/synthetic.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

/// A random material: parameters even in the coordinate of the fit over the middle nine tenths of their
/// range.
MaterialSpec random_truth(const ParameterLayout& layout, std::uint64_t seed) {
  std::vector<double> x;
  for (int i = 0; i < layout.size(); ++i) {
    const double u = 0.05 + 0.9 * unit_double(hash(seed, i, 77));
    x.push_back(layout[i].coordinate_lo() + u * (layout[i].coordinate_hi() - layout[i].coordinate_lo()));
  }
  return layout.material(x);
}

struct Coverage {
  int cases = 0, held = 0;     ///< all truths of a case within their intervals at once
  int determined = 0, all = 0; ///< parameters with a bounded interval
  std::string missed;
};

/// @param bounds  narrower than the domain where it holds materials that no one would measure; the fit itself
/// does not know them
Coverage recover(const std::string& model, const std::vector<ParameterRules::Bound>& bounds, Metric metric,
                 double noise, int cases, std::array<int, 3> size) {
  ParameterRules rules;
  rules.bounds = bounds;
  const ParameterLayout layout(parse_material(model), rules);
  Coverage coverage;
  for (int i = 0; i < cases; ++i) {
    MaterialSpec truth = random_truth(layout, std::uint64_t(i));
    const auto key = [&](std::size_t lobe) { // lobes of one model come back in the order of their roughness
      for (int k = 0; k < layout.size(); ++k)
        if (layout[k].lobe == int(lobe) && layout[k].channel < 0)
          return truth.lobes[lobe].values[std::size_t(layout[k].parameter)][0];
      return 0.0;
    };
    for (std::size_t a = 0; a < truth.lobes.size(); ++a)
      for (std::size_t b = a + 1; b < truth.lobes.size(); ++b)
        if (truth.lobes[a].model == truth.lobes[b].model && key(a) > key(b))
          std::swap(truth.lobes[a], truth.lobes[b]);
    const std::uint64_t seed = hash(std::hash<std::string>()(model), i);
    const MerlTable table = tabulate(to_text(truth), noise, seed, size);
    const FitResult result =
        fit(table, {.model = model, .metric = metric, .starts = 8, .theta_d_step = 1, .phi_d_step = 1});
    bool held = true;
    for (const FittedParameter& p : result.parameters) {
      const double value = value_in(truth, p);
      ++coverage.all;
      coverage.determined += p.interval_hi - p.interval_lo < 0.999 * (p.hi - p.lo);
      if (value >= p.interval_lo && value <= p.interval_hi) continue;
      held = false;
      coverage.missed +=
          fmt::format("  case {} {}: {:.6g} not in [{:.6g}, {:.6g}] fitted {:.6g}, error {:.3g}\n", i,
                      p.label, value, p.interval_lo, p.interval_hi, p.value, result.errors.of(metric));
    }
    ++coverage.cases;
    coverage.held += held;
  }
  return coverage;
}

const std::vector<std::pair<std::string, std::vector<ParameterRules::Bound>>>& representative() {
  static const std::vector<std::pair<std::string, std::vector<ParameterRules::Bound>>> list{
      {"lambert", {}},
      {"oren_nayar", {}},
      {"ggx_schlick+lambert", {{"f0", 0.02, 1}, {"alpha", 0.02, 0.7}}},
      {"ward+lambert", {{"specular_reflectance", 0.02, 1}, {"alpha_x", 0.02, 0.5}}},
      {"blinn_phong+lambert", {{"specular_reflectance", 0.02, 1}, {"exponent", 5, 5000}}},
      {"ashikhmin_shirley+lambert", {{"f0", 0.02, 1}, {"n_u", 5, 5000}}},
      {"ggx_conductor+lambert", {{"eta", 0.2, 4}, {"k", 1, 7}, {"alpha_x", 0.03, 0.6}}},
      {"ggx_plastic", {{"eta", 1.3, 2}, {"alpha", 0.03, 0.6}}},
      {"low_microfacet+lambert", {{"A", 5, 500}, {"B", 50, 50000}, {"C", 0.3, 2}, {"eta", 1.2, 3}}},
      {"cook_torrance+lambert", {{"eta", 1.2, 3}, {"m", 0.03, 0.5}}},
      {"ggx_schlick+ggx_schlick+lambert",
       {{"f0", 0.05, 1}, {"ggx_schlick#1.alpha", 0.03, 0.12}, {"ggx_schlick#2.alpha", 0.25, 0.7}}},
      {"beckmann_conductor+ggx_schlick+lambert",
       {{"eta", 0.2, 4}, {"k", 1, 7}, {"alpha_x", 0.03, 0.15}, {"f0", 0.05, 1}, {"alpha", 0.25, 0.7}}},
  };
  return list;
}

void expect_recovery(const Coverage& c, const std::string& model) {
  SCOPED_TRACE(model);
  fmt::print("{}: {} of {} cases held, {} of {} parameters determined\n", model, c.held, c.cases,
             c.determined, c.all);
  EXPECT_GE(c.held, 0.95 * c.cases) << c.missed;
  // Intervals as wide as the domain hold everything: they must be rare.
  EXPECT_GE(c.determined, 0.95 * c.all);
}

// All intervals of a case hold at once with 99 %. Of 16 cases 2 or more are missed with a probability of
// 0.011 a model; the seeds are fixed.
TEST(Recovery, OfRandomMaterialsIsWithinTheStatedUncertainty) {
  for (const auto& [model, bounds] : representative())
    if (model == "ggx_schlick+lambert" || model == "oren_nayar")
      for (const Metric metric : all_metrics)
        expect_recovery(recover(model, bounds, metric, 0.02, 16, {30, 30, 30}), model);
}

TEST(LongRecovery, HoldsInNineteenOfTwentyCasesForEachModel) {
  for (const auto& [model, bounds] : representative())
    expect_recovery(recover(model, bounds, Metric::log, 0.02, 200, {30, 30, 60}), model);
}

TEST(LongRecovery, HoldsOnTablesOfFullResolution) {
  for (const auto& [model, bounds] : representative())
    if (model == "ggx_schlick+lambert")
      expect_recovery(recover(model, bounds, Metric::log, 0.05, 60, {90, 90, 180}), model);
}

} // namespace
} // namespace nacre
