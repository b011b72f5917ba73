#pragma once
// Statistics for tests of samplers and for estimates with their uncertainty.

#include <cstdint>
#include <span>

namespace nacre {

/// Regularised incomplete gamma functions P(a, x) and Q = 1 - P, to about 1e-13 for a up to 100; the error
/// grows in proportion to a.
/// @param a in (0, 1e12]  @param x >= 0  @throws Error outside the domain
/// Source: Abramowitz and Stegun 1964, 6.5.29 (series) and 6.5.31 (continued fraction).
double gamma_p(double a, double x);
double gamma_q(double a, double x);

/// Probability that a chi-square variable exceeds `statistic`. @throws Error if degrees_of_freedom < 1
double chi_square_survival(double statistic, double degrees_of_freedom);

/// Standard normal cumulative distribution.
double normal_cdf(double z);
/// Probability that a standard normal variable is further from 0 than z.
double normal_two_sided_p(double z);

/// The significance at which each of `tests` independent tests is run so that all pass with probability 1 -
/// family. Source: Sidak 1967, Rectangular Confidence Regions for the Means of Multivariate Normal
/// Distributions.
double sidak_significance(double family, int tests);

struct ChiSquareResult {
  double statistic;
  int degrees_of_freedom; ///< cells left after pooling, less one
  double p;               ///< probability of a statistic at least as large if `expected` is the truth
};
/// Pearson's test of counts against expected counts. All cells that expect fewer than `min_expected` are
/// pooled into one, which takes in further cells from the smallest up until it expects enough. An observation
/// in a cell that expects exactly 0 refutes `expected`: infinite statistic, p = 0. If fewer than two cells
/// remain nothing is tested: 0 degrees of freedom, p = 1. Expected counts should sum to the number of
/// observations.
/// @throws Error if the sizes differ or a number is negative or not finite
ChiSquareResult chi_square_test(std::span<const double> observed, std::span<const double> expected,
                                double min_expected = 5);

/// Mean and variance of a stream in one pass. Source: Welford 1962; merging: Chan et al. 1979.
class RunningMoments {
public:
  void add(double x);
  void merge(const RunningMoments& other);
  std::uint64_t count() const { return count_; }
  double mean() const { return mean_; }
  /// Unbiased sample variance; 0 for fewer than two numbers.
  double variance() const;
  /// Standard deviation of the mean.
  double standard_error() const;

private:
  std::uint64_t count_ = 0;
  double mean_ = 0, squares_ = 0; ///< squares_: sum of squared deviations from the mean
};

} // namespace nacre
