#include "core/statistics.h"

#include "core/error.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numeric>
#include <vector>

namespace nacre {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// x^a e^-x / Gamma(a).
double gamma_front(double a, double x) { return std::exp(a * std::log(x) - x - std::lgamma(a)); }

/// P(a, x) by its power series, for x < a + 1.
double gamma_series(double a, double x) {
  double term = 1 / a, sum = term;
  for (double n = a + 1; term > sum * epsilon * 0.1; ++n)
    sum += term *= x / n;
  return sum * gamma_front(a, x);
}

/// Q(a, x) by its continued fraction in Lentz's evaluation, for x >= a + 1.
double gamma_fraction(double a, double x) {
  constexpr double tiny = 1e-300;
  double b = x + 1 - a, c = 1 / tiny, d = 1 / b, h = d;
  for (double i = 1;; ++i) {
    const double an = -i * (i - a);
    b += 2;
    d = an * d + b;
    if (std::abs(d) < tiny) d = tiny;
    c = b + an / c;
    if (std::abs(c) < tiny) c = tiny;
    d = 1 / d;
    h *= d * c;
    if (std::abs(d * c - 1) < 4 * epsilon) return h * gamma_front(a, x);
  }
}

void check_gamma_domain(double a, double x) {
  if (!(a > 0 && a <= 1e12 && x >= 0))
    throw Error(
        fmt::format("incomplete gamma function at ({}, {}), expected 0 < a <= 1e12 and x >= 0", a, x));
}

} // namespace

double gamma_p(double a, double x) {
  check_gamma_domain(a, x);
  if (x == 0) return 0;
  if (std::isinf(x)) return 1;
  return x < a + 1 ? gamma_series(a, x) : 1 - gamma_fraction(a, x);
}

double gamma_q(double a, double x) {
  check_gamma_domain(a, x);
  if (x == 0) return 1;
  if (std::isinf(x)) return 0;
  return x < a + 1 ? 1 - gamma_series(a, x) : gamma_fraction(a, x);
}

double chi_square_survival(double statistic, double degrees_of_freedom) {
  if (!(degrees_of_freedom >= 1))
    throw Error(
        fmt::format("chi-square with {} degrees of freedom, expected at least 1", degrees_of_freedom));
  return gamma_q(degrees_of_freedom / 2, statistic / 2);
}

double normal_cdf(double z) { return 0.5 * std::erfc(-z * std::sqrt(0.5)); }
double normal_two_sided_p(double z) { return std::erfc(std::abs(z) * std::sqrt(0.5)); }

double sidak_significance(double family, int tests) {
  if (!(family > 0 && family < 1) || tests < 1)
    throw Error(fmt::format("significance {} over {} tests, expected one in (0, 1) and at least one test",
                            family, tests));
  return -std::expm1(std::log1p(-family) / tests);
}

ChiSquareResult chi_square_test(std::span<const double> observed, std::span<const double> expected,
                                double min_expected) {
  if (observed.size() != expected.size())
    throw Error(
        fmt::format("chi-square test: {} observed counts but {} expected", observed.size(), expected.size()));
  bool impossible = false;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    const auto is_count = [](double x) { return x >= 0 && std::isfinite(x); };
    if (!is_count(observed[i]) || !is_count(expected[i]))
      throw Error(
          fmt::format("chi-square test: cell {} has {} observed and {} expected, not finite counts >= 0", i,
                      observed[i], expected[i]));
    impossible = impossible || (expected[i] == 0 && observed[i] > 0);
  }

  std::vector<std::size_t> order(observed.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto i, auto j) { return expected[i] < expected[j]; });

  double statistic = 0, pooled_observed = 0, pooled_expected = 0;
  int cells = 0;
  const auto count_cell = [&](double o, double e) {
    statistic += (o - e) * (o - e) / e;
    ++cells;
  };
  std::size_t next = 0;
  for (; next < order.size(); ++next) {
    const double e = expected[order[next]];
    const bool pool_is_full = pooled_expected == 0 || pooled_expected >= min_expected;
    if (e > 0 && e >= min_expected && pool_is_full) break;
    pooled_observed += observed[order[next]];
    pooled_expected += e;
  }
  if (pooled_expected > 0) count_cell(pooled_observed, pooled_expected);
  for (; next < order.size(); ++next)
    count_cell(observed[order[next]], expected[order[next]]);

  const int freedom = std::max(cells - 1, 0);
  if (impossible) return {std::numeric_limits<double>::infinity(), freedom, 0};
  if (freedom == 0) return {statistic, 0, 1};
  return {statistic, freedom, chi_square_survival(statistic, freedom)};
}

void RunningMoments::add(double x) {
  ++count_;
  const double before = x - mean_;
  mean_ += before / static_cast<double>(count_);
  squares_ += before * (x - mean_);
}

void RunningMoments::merge(const RunningMoments& other) {
  if (other.count_ == 0) return;
  const double n = static_cast<double>(count_), m = static_cast<double>(other.count_),
               gap = other.mean_ - mean_;
  mean_ += gap * m / (n + m);
  squares_ += other.squares_ + gap * gap * n * m / (n + m);
  count_ += other.count_;
}

double RunningMoments::variance() const {
  return count_ < 2 ? 0 : squares_ / static_cast<double>(count_ - 1);
}

double RunningMoments::standard_error() const {
  return count_ == 0 ? 0 : std::sqrt(variance() / static_cast<double>(count_));
}

} // namespace nacre
