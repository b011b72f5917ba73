#include "fit/residuals.h"

#include "bsdf/models/ggx_schlick.h"
#include "bsdf/models/lambert.h"
#include "fit/jet.h"
#include "fit/synthetic.h"
#include "fit/uncertainty.h"

#include <gtest/gtest.h>
#include <numeric>

namespace nacre {
namespace {

constexpr auto truth = "ggx_schlick:f0=0.05/0.2/0.6,alpha=0.15+lambert:reflectance=0.3/0.1/0.02";

struct Evaluated {
  std::vector<double> r, jacobian;
};
Evaluated evaluate(const Residuals& residuals, const std::vector<double>& x) {
  const std::size_t rows = std::size_t(residuals.num_residuals());
  Evaluated e{std::vector<double>(rows), std::vector<double>(rows * x.size())};
  const double* parameters = x.data();
  double* jacobians = e.jacobian.data();
  EXPECT_TRUE(residuals.Evaluate(&parameters, e.r.data(), &jacobians));
  std::vector<double> alone(rows);
  EXPECT_TRUE(residuals.Evaluate(&parameters, alone.data(), nullptr));
  for (std::size_t i = 0; i < rows; ++i)
    EXPECT_NEAR(alone[i], e.r[i], 1e-6 * (std::abs(e.r[i]) + 0.01));
  return e;
}

TEST(Observations, WeightsMeasureTheSpaceOfDirectionPairs) {
  // dwo dwi over wo, wi above the surface is (2 pi)^2, over all wi and half vectors above it twice that: half
  // of the weights of a full table, which sum to n_phi_d, lies above the horizon. 1/n is the jagged edge.
  const MerlTable full = MerlTable::tabulate(60, 60, 60, [](double, double, double) {
    return std::array{1.0, 1.0, 1.0};
  });
  for (const int step : {1, 2, 3}) {
    const Observations o =
        observe(full, {.theta_h_step = step, .theta_d_step = step, .phi_d_step = step, .max_theta_deg = 90});
    const double kept = std::ceil(60.0 / step);
    EXPECT_NEAR(std::accumulate(o.weight.begin(), o.weight.end(), 0.0) / kept, 0.5, 0.02 * step);
  }
}

TEST(Observations, SkipHolesAndGrazingAngles) {
  const MerlTable table = tabulate("lambert");
  const Observations o = observe(table, {});
  EXPECT_GT(o.count, table.size() / 4);
  EXPECT_LT(o.count, table.size() - table.hole_count());
  EXPECT_EQ(o.wo[0].size() % pack_width, 0u);
  const float cut = float(std::cos(80 * pi / 180));
  for (std::size_t i = 0; i < o.count; ++i) {
    EXPECT_GT(o.wo[2][i], cut * 0.99999f);
    EXPECT_GT(o.wi[2][i], cut * 0.99999f);
  }
}

TEST(MetricErrors, MatchAHandComputedCase) {
  // Two measured nodes: at theta_h = theta_d = 0 both directions are the normal; (0, 1) has theta_d = 45 deg,
  // so both directions are at 45 deg. A table of 2 x 2 x 1 has faces at theta_h: 0, (1/4)^2 90 deg, 90 deg
  // and theta_d: 0, 22.5 deg, 90 deg.
  const double m0 = 0.5, m1 = 0.2, rho = 0.6;
  const MerlTable table = MerlTable::tabulate(2, 2, 1, [&](double theta_h, double theta_d, double) {
    const double m = theta_h > 0 ? -1 : theta_d > 0 ? m1 : m0;
    return std::array{m, m, m};
  });
  const MetricErrors e = metric_errors(table, parse_material("lambert:reflectance=0.6"));
  EXPECT_EQ(e.nodes, 2u);
  // The face in theta_h is the same for both nodes and drops out.
  const double w0 = std::pow(std::sin(22.5 * pi / 180), 2), w1 = 1 - w0, f = rho / pi, c = std::sqrt(0.5);
  const double d0 = f - m0, d1 = (f - m1) * c;
  EXPECT_NEAR(e.cosine, std::sqrt((w0 * d0 * d0 + w1 * d1 * d1) / (w0 + w1)), 1e-6);
  const double l0 = std::log(1 + f) - std::log(1 + m0), l1 = std::log(1 + f * c) - std::log(1 + m1 * c);
  EXPECT_NEAR(e.log, std::sqrt((w0 * l0 * l0 + w1 * l1 * l1) / (w0 + w1)), 1e-6);
}

TEST(Residuals, SquareToTheMetricsError) {
  const MerlTable table = tabulate(truth, 0.2, 1);
  const MaterialSpec material = parse_material("ggx_schlick:f0=0.1,alpha=0.3+lambert:reflectance=0.2");
  const ParameterLayout layout(material);
  const Observations all = observe(table, {});
  for (const Metric metric : all_metrics) {
    const Residuals residuals(all, metric, layout);
    const auto e = evaluate(residuals, layout.coordinates(material));
    const double sum = std::inner_product(e.r.begin(), e.r.end(), e.r.begin(), 0.0);
    const double error = metric_errors(table, material).of(metric);
    EXPECT_NEAR(std::sqrt(sum), error, 1e-6 * error);
  }
}

/// The same residual through ceres::Jet in double and the models of three channels.
TEST(Residuals, JacobianIsThatOfJets) {
  const MerlTable table = tabulate(truth, 0.2, 1, {12, 10, 20});
  const MaterialSpec material =
      parse_material("ggx_schlick:f0=0.1/0.3/0.5,alpha=0.2+lambert:reflectance=0.2/0.3/0.1");
  const ParameterLayout layout(material);
  const Observations at = observe(table, {});
  const std::vector<double> x = layout.coordinates(material);
  ASSERT_EQ(x.size(), 7u);
  const double sum = std::accumulate(at.weight.begin(), at.weight.end(), 0.0);
  using R = ceres::Jet<double, 7>;
  GgxSchlick<R, 3> ggx;
  for (int c = 0; c < 3; ++c)
    ggx.f0[c] = R(x[std::size_t(c)], c);
  ggx.alpha = exp(R(x[3], 3)); // a wide positive domain: its coordinate is the logarithm
  Lambert<R, 3> lambert;
  for (int c = 0; c < 3; ++c)
    lambert.reflectance[c] = R(x[std::size_t(4 + c)], 4 + c);

  for (const Metric metric : {Metric::cosine, Metric::log}) {
    const Evaluated e = evaluate(Residuals(at, metric, layout), x);
    for (std::size_t n = 0; n < at.count; ++n) {
      const auto direction = [&](const std::array<std::vector<float>, 3>& w) {
        return Vec3<R>{R(w[0][n]), R(w[1][n]), R(w[2][n])};
      };
      const Vec3<R> wo = direction(at.wo), wi = direction(at.wi);
      const auto f = ggx.eval(wo, wi) + lambert.eval(wo, wi);
      for (std::size_t c = 0; c < 3; ++c) {
        const double cos_i = at.wi[2][n], measured = at.f[c][n] * cos_i;
        const R y = f[int(c)] * cos_i;
        const R r = std::sqrt(at.weight[n] / (3 * sum)) *
                    (metric == Metric::log ? log(1.0 + y) - std::log1p(measured) : y - measured);
        const std::size_t row = c * at.count + n;
        // Single precision against double: differences of order 1e-6 of the terms that the residual is made
        // of.
        ASSERT_NEAR(e.r[row], r.a, 1e-5 * (std::abs(r.a) + std::sqrt(at.weight[n] / (3 * sum)) * y.a));
        for (int k = 0; k < 7; ++k)
          ASSERT_NEAR(e.jacobian[row * 7 + std::size_t(k)], r.v[k], 1e-4 * (std::abs(r.v[k]) + r.v.norm()))
              << layout.label(k) << " node " << n;
      }
    }
  }
}

TEST(Residuals, JacobianIsTheSlopeOfTheResiduals) {
  const MerlTable table = tabulate(truth, 0.2, 1, {12, 10, 20});
  const Observations at = observe(table, {});
  for (const char* model : {"ggx_conductor:eta=1.2,k=4,alpha_x=0.3,alpha_y=0.3+lambert", "ggx_plastic",
                            "beckmann_conductor+oren_nayar", "ggx_schlick+ggx_schlick:alpha=0.5+lambert"}) {
    SCOPED_TRACE(model);
    const MaterialSpec material = parse_material(model);
    const ParameterLayout layout(material);
    const std::vector<double> x = layout.coordinates(material);
    const Residuals residuals(at, Metric::log, layout);
    const Evaluated e = evaluate(residuals, x);
    for (std::size_t k = 0; k < x.size(); ++k) {
      // Residuals are single precision, 1e-7: a step of 3e-3 balances that with its own square.
      const double h = 3e-3 * std::max(std::abs(x[k]), 0.3);
      auto above = x, below = x;
      above[k] += h;
      below[k] -= h;
      const Evaluated a = evaluate(residuals, above), b = evaluate(residuals, below);
      double difference = 0, size = 0;
      for (std::size_t row = 0; row < e.r.size(); ++row) {
        const double exact = e.jacobian[row * x.size() + k];
        difference += sqr((a.r[row] - b.r[row]) / (2 * h) - exact);
        size += sqr(exact);
      }
      EXPECT_GT(size, 0) << layout.label(int(k));
      EXPECT_LT(std::sqrt(difference / size), 2e-3) << layout.label(int(k));
    }
  }
}

TEST(Uncertainty, OfAStraightLineIsThatOfTextbooks) {
  // y = a + b t at t = -1, 0, 1 with residuals 1, -2, 1: sigma^2 = 6, var a = 6/3, var b = 6/2.
  const std::vector<double> r{1, -2, 1}, jacobian{1, -1, 1, 0, 1, 1};
  const Uncertainty u = estimate_uncertainty(r, jacobian, {false, false});
  EXPECT_NEAR(u.uniform_noise_error[0], std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(u.uniform_noise_error[1], std::sqrt(3.0), 1e-12);
  // Robust: (1/9) (1 + 4 + 1) 3/1 and (1/4) (1 + 1) 3/1.
  EXPECT_NEAR(u.standard_error[0], std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(u.standard_error[1], std::sqrt(1.5), 1e-12);
  EXPECT_NEAR(u.covariance[0], 2, 1e-12);
  EXPECT_NEAR(u.covariance[3], 1.5, 1e-12);
  // (1/3) sum of r^2 t (1/2) 3/1 = 0: the outer residuals are alike.
  EXPECT_NEAR(u.covariance[1], 0, 1e-12);
  EXPECT_TRUE(u.identifiable[0] && u.identifiable[1]);
  // With b held, a has two degrees of freedom more to share the same residuals.
  const Uncertainty held = estimate_uncertainty(r, jacobian, {false, true});
  EXPECT_NEAR(held.uniform_noise_error[0], 1, 1e-12);
  EXPECT_TRUE(std::isnan(held.standard_error[1]));
  EXPECT_TRUE(std::isnan(held.covariance[1]) && std::isnan(held.covariance[2]));
}

TEST(Uncertainty, WithoutEffectIsNotIdentifiable) {
  const std::vector<double> r{1, -2, 1}, jacobian{1, 0, 1, 0, 1, 0};
  const Uncertainty u = estimate_uncertainty(r, jacobian, {false, false});
  EXPECT_TRUE(u.identifiable[0]);
  EXPECT_FALSE(u.identifiable[1]);
  EXPECT_EQ(u.partner[1], -1);
}

} // namespace
} // namespace nacre
