#include "core/quadrature.h"

#include "core/error.h"
#include "core/spectrum.h"

#include <gtest/gtest.h>
#include <limits>
#include <numeric>

namespace nacre {
namespace {

TEST(GaussLegendre, IsExactForPolynomialsOfDegreeTwiceNLessOne) {
  for (int n = 1; n <= 40; ++n) {
    const QuadratureRule rule = gauss_legendre(n);
    for (int degree = 0; degree <= 2 * n - 1; ++degree) {
      const double got = integrate(rule, [&](double x) { return std::pow(x, degree); });
      EXPECT_NEAR(got, degree % 2 ? 0 : 2.0 / (degree + 1), 1e-14) << n << " nodes, degree " << degree;
    }
  }
  // One degree more is not exact: the test above can fail.
  EXPECT_GT(std::abs(integrate(gauss_legendre(3), [](double x) { return std::pow(x, 6); }) - 2.0 / 7), 1e-3);
}

TEST(GaussLegendre, MatchesTheClosedFormOfThreeNodes) {
  const QuadratureRule rule = gauss_legendre(3);
  EXPECT_NEAR(rule.node[0], -std::sqrt(0.6), 1e-16);
  EXPECT_EQ(rule.node[1], 0);
  EXPECT_NEAR(rule.weight[0], 5.0 / 9, 1e-15);
  EXPECT_NEAR(rule.weight[1], 8.0 / 9, 1e-15);
}

TEST(GaussLegendre, StaysAccurateForManyNodes) {
  for (const int n : {100, 1001, 10000}) {
    const QuadratureRule rule = gauss_legendre(n, 0, 3);
    EXPECT_NEAR(std::accumulate(rule.weight.begin(), rule.weight.end(), 0.0), 3, 1e-11) << n;
    EXPECT_TRUE(std::is_sorted(rule.node.begin(), rule.node.end())) << n;
    EXPECT_NEAR(integrate(rule, [](double x) { return std::exp(x); }), std::exp(3.0) - 1, 1e-10) << n;
  }
}

TEST(GaussLegendre, RefusesNodeCountsOutOfRange) {
  EXPECT_THROW(gauss_legendre(0), Error);
  EXPECT_THROW(gauss_legendre(-3), Error);
  EXPECT_THROW(gauss_legendre(1000000), Error);
  EXPECT_THROW(composite_gauss_legendre(4, 0, 0, 1), Error);
  EXPECT_THROW(composite_gauss_legendre(10000, 1000000, 0, 1), Error);
  EXPECT_THROW(hemisphere_rule(0, 4), Error);
  EXPECT_THROW(hemisphere_rule(1000000, 1000000), Error);
}

TEST(CompositeGaussLegendre, ConvergesAtTheRuleOrder) {
  const auto error = [](int panels) {
    const QuadratureRule rule = composite_gauss_legendre(2, panels, 0, 1);
    return std::abs(integrate(rule, [](double x) { return std::exp(x); }) - (std::exp(1.0) - 1));
  };
  EXPECT_NEAR(std::log2(error(8) / error(16)), 4, 0.05); // two nodes: order 4
}

TEST(Hemisphere, IntegratesPolynomialsOfTheDirectionExactly) {
  const auto integral = [](auto f) { return integrate_hemisphere(f, 8, 16); };
  EXPECT_NEAR(integral([](Vec3d) { return 1.0; }), 2 * pi, 1e-13);
  EXPECT_NEAR(integral([](Vec3d w) { return w.z; }), pi, 1e-13);
  EXPECT_NEAR(integral([](Vec3d w) { return w.x * w.x; }), 2 * pi / 3, 1e-13);
  EXPECT_NEAR(integral([](Vec3d w) { return w.x * w.y; }), 0, 1e-13);
  EXPECT_NEAR(integral([](Vec3d w) { return w.y; }), 0, 1e-13);
  EXPECT_NEAR(integral([](Vec3d w) { return w.x * w.x * w.y * w.y; }), 2 * pi / 15, 1e-13);
}

TEST(Hemisphere, IntegratesPerChannel) {
  using S = Spectrum<double, 3>;
  const S sum = integrate_hemisphere(
      [](Vec3d w) {
        S s(w.z);
        s[2] = 1;
        return s;
      },
      8, 8);
  EXPECT_NEAR(sum[0], pi, 1e-13);
  EXPECT_NEAR(sum[2], 2 * pi, 1e-13);
}

TEST(Adaptive, KronrodRuleIsExactToDegree22) {
  // One application, no refinement; degree 23 is odd, 24 the first that fails.
  const AdaptiveOptions once{.max_depth = 0};
  for (int degree = 0; degree <= 23; ++degree) {
    const auto f = [&](double x) { return std::pow(x, degree); };
    EXPECT_NEAR(integrate_adaptive(f, -1, 1, once).value, degree % 2 ? 0 : 2.0 / (degree + 1), 2e-15)
        << degree;
    EXPECT_NEAR(integrate_adaptive(f, 0, 1, once).value, 1.0 / (degree + 1), 2e-15) << degree;
  }
  // The embedded Gauss rule, exact to degree 13: no difference to report.
  EXPECT_LT(integrate_adaptive([](double x) { return std::pow(x, 13); }, 0, 1, once).error, 1e-15);
  EXPECT_GT(integrate_adaptive([](double x) { return std::pow(x, 14); }, -1, 1, once).error, 1e-8);
}

TEST(Adaptive, MeetsItsToleranceOnHardIntegrands) {
  const AdaptiveOptions options{.absolute = 1e-9, .relative = 0};
  const double peak =
      integrate_adaptive([](double x) { return 1e-3 / (x * x + 1e-6); }, -1, 2, options).value;
  EXPECT_NEAR(peak, std::atan(2e3) + std::atan(1e3), 1e-9);
  EXPECT_NEAR(integrate_adaptive([](double x) { return std::sqrt(x); }, 0, 1, options).value, 2.0 / 3, 1e-9);
  const auto step = [](double x) { return x < 0.3 ? 1.0 : 0.0; };
  const AdaptiveResult r = integrate_adaptive(step, 0, 1, {.absolute = 1e-6, .relative = 0, .max_depth = 30});
  EXPECT_NEAR(r.value, 0.3, 1e-6);
  EXPECT_LE(std::abs(r.value - 0.3), r.error + 1e-12);
}

TEST(Adaptive, MinimumDepthFindsWhatTheNodesMiss) {
  const auto needle = [](double x) { return std::exp(-std::pow((x - 0.1234) / 1e-4, 2)); };
  const double truth = std::sqrt(pi) * 1e-4;
  EXPECT_LT(integrate_adaptive(needle, 0, 1).value, 0.1 * truth);
  EXPECT_NEAR(integrate_adaptive(needle, 0, 1, {.absolute = 1e-12, .min_depth = 9}).value, truth, 1e-10);
}

TEST(Adaptive, EndsAtOnceOnNaN) {
  int calls = 0;
  const auto f = [&](double) {
    ++calls;
    return std::numeric_limits<double>::quiet_NaN();
  };
  EXPECT_TRUE(std::isnan(integrate_adaptive(f, 0, 1).value));
  EXPECT_EQ(calls, 15);
}

TEST(Adaptive2d, IntegratesAPeakAndAQuarterDisk) {
  const auto gaussian = [](double x, double y) {
    return std::exp(-(std::pow(x - 0.3, 2) + std::pow(y - 0.6, 2)) / (2 * 0.02 * 0.02));
  };
  const auto r =
      integrate_adaptive_2d(gaussian, {0, 0}, {1, 1}, {.absolute = 1e-9, .relative = 1e-8, .min_depth = 3});
  EXPECT_NEAR(r.value, 2 * pi * 0.02 * 0.02, 1e-9);
  const auto disk = [](double x, double y) { return x * x + y * y < 1 ? 1.0 : 0.0; };
  EXPECT_NEAR(
      integrate_adaptive_2d(disk, {0, 0}, {1, 1}, {.absolute = 1e-3, .relative = 0, .max_depth = 12}).value,
      pi / 4, 1e-3);
  EXPECT_EQ(integrate_adaptive_2d(disk, {0, 0}, {0, 1}).value, 0);
}

} // namespace
} // namespace nacre
