// Parameters of a user's .brdf file from tables that were made with it.
#include "bsdf/user_shader.h"
#include "core/file.h"
#include "core/scratch_folder.h"
#include "fit/batch.h"
#include "fit/fit.h"
#include "fit/fit_store.h"
#include "fit/residuals.h"
#include "fit/synthetic.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

using testing::HasSubstr;

constexpr std::array<int, 3> small{24, 12, 24};

class UserModelFit : public testing::Test {
protected:
  UserModelFit() { write_file_atomically(file(), user_shader::cloth()); }
  std::string file() const { return folder_ / "cloth.brdf"; }

  ScratchFolder folder_;
};

TEST_F(UserModelFit, TheTruthComesBackFromATableMadeWithIt) {
  const std::string truth = file() + ":base=0.2/0.4/0.1,gloss=0.12,level=0.7,tint=0.8";
  const FitResult fitted = fit(tabulate(truth, 0, 0, small), {.model = file(), .starts = 4});
  const auto& values = fitted.material.lobes[0].values;
  const auto expected = parse_material(truth).lobes[0].values;
  for (std::size_t p = 0; p < values.size(); ++p)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(values[p][c], expected[p][c], 1e-4) << p;
  EXPECT_EQ(fitted.parameters.size(), 6u); // not the switch
  EXPECT_EQ(fitted.parameters[3].label, "cloth.brdf.gloss");
  // What is written is the fit.
  const MaterialSpec again = material_from_json(to_json(fitted), "memory.json");
  EXPECT_EQ(again.lobes[0].values, values);
}

TEST_F(UserModelFit, TheTruthLiesWithinTheIntervalsOfNoisyTables) {
  int held = 0;
  constexpr int cases = 4;
  for (int n = 0; n < cases; ++n) {
    const double u = 0.25 * n;
    const std::string truth = fmt::format("{}:base=0.2/{}/0.1,gloss={},level={},tint=0.4", file(),
                                          0.3 + 0.3 * u, 0.1 + 0.4 * u, 1 - 0.6 * u);
    const MaterialSpec expected = parse_material(truth);
    const FitResult fitted =
        fit(tabulate(truth, 0.05, std::uint64_t(n), {24, 18, 36}),
            {.model = file(), .metric = Metric::relative, .starts = 4, .theta_d_step = 1, .phi_d_step = 1});
    bool all = true;
    for (const FittedParameter& p : fitted.parameters) {
      const double value = expected.lobes[0].values[expected.lobes[0].user->info().parameter_index(p.name)]
                                                   [std::size_t(std::max(p.channel, 0))];
      all = all && value >= p.interval_lo && value <= p.interval_hi;
    }
    held += all;
  }
  EXPECT_EQ(held, cases); // 99 % each
}

TEST_F(UserModelFit, TakesPartInSums) {
  // The tint at 0: then the file's lobe is white, and a Lambertian and the base are the same thing.
  const std::string truth = file() + ":base=0,gloss=0.2,level=0.6,tint=0+lambert:reflectance=0.3/0.2/0.5";
  ParameterRules rules;
  rules.fixed = {{"base", 0.0}, {"tint", 0.0}};
  const FitResult fitted =
      fit(tabulate(truth, 0, 0, small), {.model = file() + "+lambert", .starts = 4, .rules = rules});
  EXPECT_NEAR(fitted.material.lobes[0].values[1][0], 0.2, 1e-4);
  EXPECT_NEAR(fitted.material.lobes[0].values[2][0], 0.6, 1e-4);
  EXPECT_NEAR(fitted.material.lobes[1].values[0][2], 0.5, 1e-4);
}

// The hue makes each channel depend on all of the base.
TEST_F(UserModelFit, JacobianOfAShaderThatMixesChannelsIsThatOfDifferences) {
  const MerlTable table = tabulate("ggx_schlick:alpha=0.3+lambert", 0, 0, {12, 6, 8});
  const ParameterLayout layout(parse_material(file() + ":tint=0.7,gloss=0.4+oren_nayar:sigma=0.3"));
  NodeSelection every;
  const Observations nodes = observe(table, every);
  for (const Metric metric : {Metric::log, Metric::relative}) {
    const Residuals residuals(nodes, metric, layout);
    const std::size_t rows = std::size_t(residuals.num_residuals()), width = std::size_t(layout.size());
    std::vector<double> x = layout.coordinates(layout.start()), r(rows), jacobian(rows * width);
    const double* at = x.data();
    double* rows_of = jacobian.data();
    ASSERT_TRUE(residuals.Evaluate(&at, r.data(), &rows_of));
    for (std::size_t k = 0; k < width; ++k) {
      std::vector<double> lower(rows), upper(rows), y = x;
      const double h = 2e-3;
      const double* moved = y.data();
      y[k] = x[k] - h;
      ASSERT_TRUE(residuals.Evaluate(&moved, lower.data(), nullptr));
      y[k] = x[k] + h;
      ASSERT_TRUE(residuals.Evaluate(&moved, upper.data(), nullptr));
      double size = 0, difference = 0;
      for (std::size_t i = 0; i < rows; ++i) {
        const double slope = (upper[i] - lower[i]) / (2 * h);
        size += sqr(slope), difference += sqr(slope - jacobian[i * width + k]);
      }
      EXPECT_GT(size, 0) << layout.label(int(k));
      // Single precision over 2h, and the third derivative times h^2 / 6.
      EXPECT_LT(std::sqrt(difference), 5e-3 * std::sqrt(size)) << layout.label(int(k));
    }
  }
}

TEST_F(UserModelFit, ASwitchIsNotFreed) {
  ParameterRules rules;
  rules.freed = {"sharp"};
  EXPECT_THAT(message_of<Error>([&] { ParameterLayout(parse_material(file()), rules); }),
              HasSubstr("sharp is a switch"));
  rules.freed.clear();
  rules.fixed = {{"glos", 0.3}};
  EXPECT_THAT(message_of<Error>([&] { ParameterLayout(parse_material(file()), rules); }),
              HasSubstr("did you mean 'gloss'"));
}

// A database keeps what it has for the same file, and knows that an edited one is another.
TEST_F(UserModelFit, ABatchFitsAnEditedFileAnew) {
  write_file_atomically(folder_ / "t.binary",
                        encode_merl(tabulate("lambert:reflectance=0.4", 0, 0, {8, 6, 8})));
  FitOptions options;
  options.starts = 1, options.refined = 1;
  FitStore store(folder_ / "fits.sqlite");
  const auto run = [&] { return fit_all({folder_ / "t.binary"}, {file()}, options, store, true); };
  EXPECT_EQ(run().done, 1u);
  EXPECT_EQ(run().skipped, 1u);
  std::string edited = user_shader::cloth();
  write_file_atomically(file(), edited.replace(edited.find("base / PI"), 9, "base * 0.3"));
  EXPECT_EQ(run().done, 1u);
  EXPECT_EQ(store.all().size(), 2u);
}

} // namespace
} // namespace nacre
