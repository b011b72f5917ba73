#include "fit/robust_loss.h"

#include "fit/fit.h"
#include "fit/residuals.h"
#include "fit/synthetic.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

constexpr std::array kinds{LossKind::squares, LossKind::huber, LossKind::soft_l1, LossKind::cauchy};

TEST(RobustLoss, IsTheSquareForSmallResidualsAndLessForLarge) {
  for (const LossKind kind : kinds) {
    const RobustLoss loss{kind, 1};
    EXPECT_NEAR(loss.at(1e-6).rho, 1e-6, 1e-11);
    EXPECT_NEAR(loss.at(1e-6).slope, 1, 1e-5);
    if (kind != LossKind::squares) {
      EXPECT_LT(loss.at(100).rho, 20) << loss_name(kind);
    }
    for (const double s : {0.3, 0.9, 1.5, 30.0}) {
      const double h = 1e-5 * s;
      EXPECT_NEAR(loss.at(s).slope, (loss.at(s + h).rho - loss.at(s - h).rho) / (2 * h), 1e-8)
          << loss_name(kind);
      EXPECT_NEAR(loss.at(s).curvature, (loss.at(s + h).slope - loss.at(s - h).slope) / (2 * h), 1e-6)
          << loss_name(kind);
    }
    EXPECT_EQ(parse_loss(loss_name(kind)), kind);
  }
}

TEST(Residuals, GradientIsTheSlopeOfTheCostInEveryMetricAndLoss) {
  const MerlTable table = tabulate("ggx_schlick:f0=0.05/0.2/0.6,alpha=0.15+lambert:reflectance=0.3/0.1/0.02",
                                   0.2, 1, {20, 10, 20});
  const Observations at = observe(table, {});
  const MaterialSpec material =
      parse_material("ggx_schlick:f0=0.1/0.3/0.5,alpha=0.2+lambert:reflectance=0.2/0.3/0.1");
  const ParameterLayout layout(material);
  const std::vector<double> x = layout.coordinates(material);
  for (const Metric metric : all_metrics)
    for (const LossKind kind : kinds) {
      const Residuals residuals(at, metric, layout, {kind, 0.05});
      CostSlope slope;
      ASSERT_TRUE(residuals.slope(x, slope));
      EXPECT_NEAR(slope.cost, residuals.cost(x), 1e-6 * slope.cost);
      for (std::size_t k = 0; k < x.size(); ++k) {
        const double h = 3e-3 * std::max(std::abs(x[k]), 0.3); // residuals are single precision
        auto above = x, below = x;
        above[k] += h;
        below[k] -= h;
        const double difference = (residuals.cost(above) - residuals.cost(below)) / (2 * h);
        EXPECT_NEAR(slope.gradient[Eigen::Index(k)], difference, 5e-3 * slope.gradient.norm())
            << metric_name(metric) << " " << loss_name(kind) << " " << layout.label(int(k));
      }
    }
}

TEST(Fit, RobustLossesDoNotFollowOutliers) {
  // A fiftieth of the nodes is twenty times too bright: dust, or a reflection in the instrument.
  const std::string truth = "ggx_schlick:f0=0.2,alpha=0.2+lambert:reflectance=0.3";
  const MerlTable clean = tabulate(truth, 0.02, 1);
  std::vector<MerlTable::Cell> cells(clean.cells().begin(), clean.cells().end());
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (hash(std::uint64_t(9), i) % 50 == 0)
      for (std::size_t c = 0; c < 3; ++c)
        cells[i][c] *= 20;
  const MerlTable dusty(30, 30, 60, cells);
  const auto error_of_diffuse = [&](LossKind kind) {
    const FitResult r = fit(dusty, {.starts = 4, .loss = {kind, 0}});
    double worst = 0;
    for (const FittedParameter& p : r.parameters)
      if (p.model == "lambert") worst = std::max(worst, std::abs(p.value - 0.3));
    return worst;
  };
  const double squares = error_of_diffuse(LossKind::squares);
  EXPECT_GT(squares, 0.03);
  for (const LossKind kind : {LossKind::huber, LossKind::soft_l1, LossKind::cauchy})
    EXPECT_LT(error_of_diffuse(kind), 0.1 * squares) << loss_name(kind);
}

} // namespace
} // namespace nacre
