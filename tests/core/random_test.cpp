#include "core/random.h"

#include "core/statistics.h"

#include <bit>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <vector>

namespace nacre {
namespace {

// The numbers met when one argument counts up and the others stay.
struct Axis {
  std::string name;
  std::function<float(std::uint64_t)> at;
};
std::vector<Axis> axes() {
  return {{"seed", [](std::uint64_t i) { return uniform(i, 5, 9, 2); }},
          {"pixel", [](std::uint64_t i) { return uniform(1, i, 0, 0); }},
          {"sample", [](std::uint64_t i) { return uniform(1, 77, i, 3); }},
          {"dimension", [](std::uint64_t i) { return uniform(1, 77, 4, i); }},
          {"all four", [](std::uint64_t i) { return uniform(i, i, i, i); }}};
}

TEST(UnitFloat, IsAMultipleOfTheGridAndNeverOne) {
  EXPECT_EQ(unit_float(0), 0.0f);
  EXPECT_EQ(unit_float(0xffffffffu), 1.0f - 0x1p-24f);
  EXPECT_LT(unit_double(~std::uint64_t{0}), 1.0);
  for (std::uint32_t i = 0; i < 10000; ++i) {
    const float x = uniform(3, i, 0, 0);
    EXPECT_EQ(x * 0x1p24f, std::floor(x * 0x1p24f));
    ASSERT_TRUE(x >= 0 && x < 1);
  }
}

TEST(Uniform, IsAFunctionOfItsArgumentsThatNeverChanges) {
  // Pinned: a change here changes every picture.
  static_assert(uniform(1, 2, 3, 4) == uniform(1, 2, 3, 4));
  EXPECT_EQ(mix_bits(0x9e3779b97f4a7c15u), 0xe220a8397b1dcdafu); // first output of SplitMix64 seeded with 0
  EXPECT_EQ(hash(0), 0xe220a8397b1dcdafu);
  EXPECT_EQ(hash(1, 2, 3), hash_step(hash(1, 2), 3));
  EXPECT_NE(uniform(1, 2, 3, 4), uniform(1, 3, 2, 4));
}

TEST(Uniform, FillsEqualBinsEvenlyAlongEveryArgument) {
  constexpr int bins = 256, n = 1 << 17;
  const std::vector<double> expected(bins, static_cast<double>(n) / bins);
  const double significance = sidak_significance(0.01, static_cast<int>(axes().size()));
  for (const Axis& axis : axes()) {
    std::vector<double> observed(bins);
    for (int i = 0; i < n; ++i)
      ++observed[static_cast<int>(axis.at(i) * bins)];
    const ChiSquareResult r = chi_square_test(observed, expected);
    EXPECT_GT(r.p, significance) << axis.name << ": statistic " << r.statistic;
    EXPECT_LT(r.p, 1 - significance) << axis.name << ": too even to be random, statistic " << r.statistic;
  }
}

TEST(Uniform, LowBitsFillEvenly) {
  constexpr int bins = 64, n = 1 << 16;
  const std::vector<double> expected(bins, static_cast<double>(n) / bins);
  for (const Axis& axis : axes()) {
    std::vector<double> observed(bins);
    for (int i = 0; i < n; ++i)
      ++observed[static_cast<int>(axis.at(i) * 0x1p24f) % bins];
    EXPECT_GT(chi_square_test(observed, expected).p, 0.002) << axis.name;
  }
}

TEST(Uniform, NeighboursAreIndependent) {
  constexpr int side = 16, n = 1 << 17;
  const std::vector<double> expected(side * side, static_cast<double>(n) / (side * side));
  const double significance = sidak_significance(0.01, 3 * static_cast<int>(axes().size()));
  for (const Axis& axis : axes())
    for (const int lag : {1, 2, 64}) {
      std::vector<double> observed(side * side);
      double correlation = 0;
      for (int i = 0; i < n; ++i) {
        const float a = axis.at(i), b = axis.at(i + lag);
        ++observed[static_cast<int>(a * side) * side + static_cast<int>(b * side)];
        correlation += (a - 0.5) * (b - 0.5) * 12 / n;
      }
      EXPECT_GT(chi_square_test(observed, expected).p, significance) << axis.name << " lag " << lag;
      // Under independence the estimate has standard deviation 1 / sqrt(n).
      EXPECT_LT(std::abs(correlation), 4 / std::sqrt(static_cast<double>(n))) << axis.name << " lag " << lag;
    }
}

TEST(Hash, FlipsHalfTheBitsWhenOneInputBitFlips) {
  for (int argument = 0; argument < 4; ++argument)
    for (int bit = 0; bit < 64; ++bit) {
      double flips = 0;
      constexpr int n = 200;
      for (std::uint64_t i = 0; i < n; ++i) {
        std::uint64_t a[4] = {i, 3 * i, 7, i};
        const std::uint64_t before = hash(a[0], a[1], a[2], a[3]);
        a[argument] ^= std::uint64_t{1} << bit;
        flips += std::popcount(before ^ hash(a[0], a[1], a[2], a[3]));
      }
      // Mean of n binomials (64, 1/2): deviation 4 / sqrt(n) = 0.28; 256 cases, five deviations.
      EXPECT_NEAR(flips / n, 32, 5 * 4 / std::sqrt(static_cast<double>(n))) << argument << " bit " << bit;
    }
}

TEST(Hash, DoesNotCollideOnAGridOfSmallArguments) {
  std::set<std::uint64_t> seen;
  for (int a = 0; a < 16; ++a)
    for (int b = 0; b < 16; ++b)
      for (int c = 0; c < 16; ++c)
        for (int d = 0; d < 16; ++d)
          seen.insert(hash(a, b, c, d));
  EXPECT_EQ(seen.size(), 65536u);
}

} // namespace
} // namespace nacre
