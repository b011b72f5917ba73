#include "core/statistics.h"

#include "core/error.h"
#include "core/random.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

namespace nacre {
namespace {

TEST(Gamma, MatchesClosedForms) {
  for (const double x : {0.0, 1e-6, 0.1, 0.9, 1.0, 2.5, 10.0, 60.0}) {
    EXPECT_NEAR(gamma_p(1, x), -std::expm1(-x), 1e-14) << x;
    EXPECT_NEAR(gamma_q(0.5, x), std::erfc(std::sqrt(x)), 1e-14) << x;
    EXPECT_NEAR(gamma_q(3, x), std::exp(-x) * (1 + x + x * x / 2), 1e-14) << x;
  }
  // Far tails to relative precision.
  EXPECT_NEAR(gamma_q(1, 300) / std::exp(-300.0), 1, 1e-12);
  EXPECT_NEAR(gamma_p(3, 1e-4) / (1e-12 / 6 * (1 - 0.75e-4)), 1, 1e-8);
}

TEST(Gamma, ObeysItsRecurrenceAndSumsToOne) {
  for (const double a : {0.1, 0.5, 1.7, 12.0, 99.0, 1e4})
    for (const double scale : {0.3, 0.9, 1.0, 1.1, 3.0}) {
      const double x = a * scale, front = std::exp(a * std::log(x) - x - std::lgamma(a + 1));
      EXPECT_NEAR(gamma_p(a + 1, x), gamma_p(a, x) - front, 1e-13 + 1e-15 * a) << a << " " << x; // A&S 6.5.21
      EXPECT_NEAR(gamma_p(a, x) + gamma_q(a, x), 1, 1e-13) << a << " " << x;
    }
}

TEST(Gamma, RefusesArgumentsOutsideItsDomain) {
  EXPECT_THROW(gamma_p(0, 1), Error);
  EXPECT_THROW(gamma_q(1, -1), Error);
  EXPECT_THROW(gamma_q(std::numeric_limits<double>::quiet_NaN(), 1), Error);
  EXPECT_THROW(chi_square_survival(1, 0), Error);
  EXPECT_EQ(gamma_q(2, std::numeric_limits<double>::infinity()), 0);
}

TEST(ChiSquareSurvival, MatchesTabulatedCriticalValues) {
  // Abramowitz and Stegun 1964, table 26.8, Q = 0.05 and 0.001.
  EXPECT_NEAR(chi_square_survival(3.84146, 1), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_survival(18.3070, 10), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_survival(124.342, 100), 0.05, 1e-6);
  EXPECT_NEAR(chi_square_survival(29.588, 10), 0.001, 1e-6);
}

TEST(Normal, MatchesTabulatedValues) {
  EXPECT_NEAR(normal_cdf(1.959963984540054), 0.975, 1e-15);
  EXPECT_NEAR(normal_two_sided_p(-1.959963984540054), 0.05, 1e-15);
  EXPECT_DOUBLE_EQ(normal_cdf(0), 0.5);
  EXPECT_NEAR(normal_cdf(-10) / 7.619853024160527e-24, 1, 1e-12); // the far tail keeps relative precision
}

TEST(Sidak, GivesTheFamilyItsSignificance) {
  EXPECT_DOUBLE_EQ(sidak_significance(0.01, 1), 0.01);
  for (const int n : {2, 50, 100000})
    EXPECT_NEAR(1 - std::pow(1 - sidak_significance(0.01, n), n), 0.01, 1e-10);
  EXPECT_THROW(sidak_significance(0.01, 0), Error);
  EXPECT_THROW(sidak_significance(1.5, 3), Error);
}

TEST(ChiSquareTest, MatchesACalculationByHand) {
  const std::vector<double> observed = {8, 12, 10}, expected = {10, 10, 10};
  const ChiSquareResult r = chi_square_test(observed, expected);
  EXPECT_DOUBLE_EQ(r.statistic, 0.8);
  EXPECT_EQ(r.degrees_of_freedom, 2);
  EXPECT_NEAR(r.p, std::exp(-0.4), 1e-14);
}

TEST(ChiSquareTest, PoolsCellsThatExpectTooFew) {
  // 1 + 2 + 1 expect 4: too few, so the 6 joins them; left are {10 of 10} and {10 of 12}.
  const std::vector<double> observed = {0, 10, 3, 1, 12}, expected = {1, 6, 2, 1, 10};
  const ChiSquareResult r = chi_square_test(observed, expected);
  EXPECT_EQ(r.degrees_of_freedom, 1);
  EXPECT_DOUBLE_EQ(r.statistic, 16.0 / 10 + 4.0 / 10);
}

TEST(ChiSquareTest, RefutesAnObservationWhereNoneCanBe) {
  const std::vector<double> expected = {0, 100, 100}, one = {1, 100, 99}, none = {0, 101, 99};
  EXPECT_EQ(chi_square_test(one, expected).p, 0);
  EXPECT_GT(chi_square_test(none, expected).p, 0.5);
}

TEST(ChiSquareTest, TestsNothingWithOneCell) {
  const std::vector<double> one = {3}, expected = {3};
  EXPECT_EQ(chi_square_test(one, expected).p, 1);
  EXPECT_EQ(chi_square_test({}, {}).degrees_of_freedom, 0);
}

TEST(ChiSquareTest, RefusesWhatAreNoCounts) {
  const std::vector<double> two = {1, 2}, three = {1, 2, 3};
  const std::vector<double> negative = {1, -2}, nan = {1, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_THROW(chi_square_test(two, three), Error);
  EXPECT_THROW(chi_square_test(two, negative), Error);
  EXPECT_THROW(chi_square_test(nan, two), Error);
}

TEST(ChiSquareTest, PValuesAreUniformUnderTheTruthAndSmallUnderABias) {
  constexpr int trials = 1000, bins = 20, n = 2000;
  std::vector<double> p_bins(10);
  int caught = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> fair(bins), biased(bins);
    for (int i = 0; i < n; ++i) {
      const float u = uniform(11, trial, i, 0);
      ++fair[static_cast<int>(u * bins)];
      ++biased[static_cast<int>(std::pow(u, 1.2f) * bins)];
    }
    const std::vector<double> expected(bins, static_cast<double>(n) / bins);
    ++p_bins[std::min(9, static_cast<int>(chi_square_test(fair, expected).p * 10))];
    caught += chi_square_test(biased, expected).p < 0.01;
  }
  EXPECT_GT(chi_square_test(p_bins, std::vector<double>(10, trials / 10.0)).p, 0.01);
  EXPECT_GT(caught, 950);
}

TEST(RunningMoments, MatchTheTwoPassFormulaAtALargeOffset) {
  RunningMoments all, left, right;
  constexpr int n = 1000;
  double mean = 0, squares = 0;
  const auto x = [](int i) { return 1e9 + uniform(1, 0, i, 0); };
  for (int i = 0; i < n; ++i) {
    all.add(x(i));
    (i < 300 ? left : right).add(x(i));
    mean += (x(i) - 1e9) / n;
  }
  for (int i = 0; i < n; ++i)
    squares += std::pow(x(i) - 1e9 - mean, 2);
  left.merge(right);
  left.merge(RunningMoments{});
  for (const RunningMoments& m : {all, left}) {
    EXPECT_EQ(m.count(), 1000u);
    EXPECT_NEAR(m.mean() - 1e9, mean, 1e-6);
    EXPECT_NEAR(m.variance(), squares / (n - 1), 1e-7);
    EXPECT_NEAR(m.standard_error(), std::sqrt(squares / (n - 1) / n), 1e-8);
  }
  EXPECT_EQ(RunningMoments{}.variance(), 0);
  RunningMoments empty;
  empty.merge(all);
  EXPECT_EQ(empty.mean(), all.mean());
}

} // namespace
} // namespace nacre
