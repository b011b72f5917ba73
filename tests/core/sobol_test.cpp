#include "core/sobol.h"

#include "core/statistics.h"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace nacre {
namespace {

// The request number `dimension` of each of `n` samples from `first` on.
template <class Sampler>
std::vector<Vec2f> points(std::uint64_t seed, std::uint64_t pixel, int dimension, std::uint32_t first,
                          int n) {
  std::vector<Vec2f> p;
  for (int i = 0; i < n; ++i) {
    Sampler sampler(seed, pixel, first + static_cast<std::uint32_t>(i));
    for (int d = 0; d < dimension; ++d)
      sampler.next_2d();
    p.push_back(sampler.next_2d());
  }
  return p;
}

// Is there exactly one of the 2^k points in each interval of 2^-i by 2^-(k-i)?
::testing::AssertionResult fills_elementary_intervals(const std::vector<Vec2f>& p, int k) {
  for (int i = 0; i <= k; ++i) {
    std::vector<int> count(p.size());
    for (const Vec2f& u : p) {
      const int x = static_cast<int>(std::ldexp(u.x, i)), y = static_cast<int>(std::ldexp(u.y, k - i));
      ++count[static_cast<std::size_t>((y << i) + x)];
    }
    for (const int c : count)
      if (c != 1)
        return ::testing::AssertionFailure() << c << " points in an interval, split " << i << "/" << k;
  }
  return ::testing::AssertionSuccess();
}

TEST(SobolSecondDigits, MatchesTheDirectionNumbers) {
  // Bratley and Fox 1988, primitive polynomial x + 1: v_1 = 1/2, v_j = v_{j-1} xor v_{j-1} / 2.
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const std::uint32_t index = i < 2500 ? i : static_cast<std::uint32_t>(hash(i));
    std::uint32_t x = 0, v = 0x80000000u;
    for (int bit = 0; bit < 32; ++bit, v ^= v >> 1)
      if (index >> bit & 1) x ^= v;
    ASSERT_EQ(reverse_bits(sobol_second_digits(index)), x) << index;
  }
}

TEST(ReverseBits, MovesBitIToBit31MinusI) {
  for (int i = 0; i < 32; ++i)
    EXPECT_EQ(reverse_bits(1u << i), 0x80000000u >> i);
}

TEST(ScrambleDigits, IsANestedScramble) {
  // A bit flipped flips itself and may change only those above it: that is Owen's tree of swaps.
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const auto x = static_cast<std::uint32_t>(hash(i, 0)), seed = static_cast<std::uint32_t>(hash(i, 1));
    for (int bit = 0; bit < 32; ++bit) {
      const std::uint32_t change = scramble_digits(x, seed) ^ scramble_digits(x ^ (1u << bit), seed);
      ASSERT_EQ(change & ((2u << bit) - 1u), 1u << bit);
    }
  }
}

TEST(SobolSampler, IsAZeroTwoSequence) {
  for (std::uint64_t pixel = 0; pixel < 8; ++pixel)
    for (int dimension = 0; dimension < 4; ++dimension)
      for (int k = 0; k <= 10; ++k)
        ASSERT_TRUE(fills_elementary_intervals(points<SobolSampler>(42, pixel, dimension, 0, 1 << k), k))
            << "pixel " << pixel << " dimension " << dimension << " k " << k;
}

TEST(SobolSampler, IsStratifiedInAnyAlignedRunOfSamples) {
  for (std::uint32_t block : {1u, 2u, 3u, 1000u})
    EXPECT_TRUE(fills_elementary_intervals(points<SobolSampler>(7, 3, 1, block << 8, 256), 8)) << block;
}

TEST(SobolSampler, StratifiesOneDimensionalRequests) {
  for (std::uint64_t pixel = 0; pixel < 16; ++pixel) {
    std::vector<int> count(1024);
    for (std::uint32_t i = 0; i < 1024; ++i) {
      SobolSampler sampler(1, pixel, i);
      sampler.next_2d();
      ++count[static_cast<std::size_t>(sampler.next_1d() * 1024)];
    }
    for (const int c : count)
      ASSERT_EQ(c, 1);
  }
}

TEST(SobolSampler, StaysBelowOne) {
  float largest = 0;
  for (std::uint32_t i = 0; i < 1u << 20; ++i) {
    const Vec2f u = SobolSampler(0, i & 15, i).next_2d();
    ASSERT_TRUE(u.x >= 0 && u.y >= 0);
    largest = std::max({largest, u.x, u.y});
  }
  EXPECT_LT(largest, 1.0f);
  EXPECT_GT(largest, 0.99999f);
}

TEST(SobolSampler, OneSampleIsUniformOverPixelsAndSeeds) {
  constexpr int side = 16, n = 1 << 16;
  const std::vector<double> expected(side * side, static_cast<double>(n) / (side * side));
  const auto check = [&](auto point, const char* over) {
    std::vector<double> observed(side * side);
    for (std::uint64_t i = 0; i < n; ++i) {
      const Vec2f u = point(i);
      ++observed[static_cast<int>(u.y * side) * side + static_cast<int>(u.x * side)];
    }
    const ChiSquareResult r = chi_square_test(observed, expected);
    EXPECT_GT(r.p, 0.002) << over << ": statistic " << r.statistic;
  };
  check([](std::uint64_t i) { return SobolSampler(1, i, 0).next_2d(); }, "pixels");
  check([](std::uint64_t i) { return SobolSampler(i, 5, 3).next_2d(); }, "seeds");
}

TEST(SobolSampler, RequestsAreIndependentOfOneAnother) {
  // x of one request against x of the next, pooled over pixels: unshuffled copies would correlate.
  constexpr int side = 16, samples = 64, pixels = 1024;
  std::vector<double> observed(side * side);
  for (std::uint64_t pixel = 0; pixel < pixels; ++pixel)
    for (std::uint32_t i = 0; i < samples; ++i) {
      SobolSampler sampler(9, pixel, i);
      const float a = sampler.next_1d(), b = sampler.next_1d();
      ++observed[static_cast<int>(a * side) * side + static_cast<int>(b * side)];
    }
  const std::vector<double> expected(side * side, static_cast<double>(pixels) * samples / (side * side));
  EXPECT_GT(chi_square_test(observed, expected).p, 0.002);
}

TEST(SobolSampler, ConvergesFasterThanIndependentSamples) {
  // A smooth integrand: scrambled nets reach n^-3/2, independent samples n^-1/2 (Owen 1997).
  const auto rms = [](auto sampler_of, int n) {
    RunningMoments squares;
    for (std::uint64_t pixel = 0; pixel < 64; ++pixel) {
      double sum = 0;
      for (int i = 0; i < n; ++i) {
        const Vec2f u = sampler_of(pixel, static_cast<std::uint32_t>(i)).next_2d();
        sum += std::exp(-u.x * u.y);
      }
      // Integral of exp(-x y) over the unit square = sum over k of (-1)^k / (k! (k+1)^2).
      squares.add(std::pow(sum / n - 0.7965995992970532, 2));
    }
    return std::sqrt(squares.mean());
  };
  const auto sobol = [](std::uint64_t p, std::uint32_t i) { return SobolSampler(1, p, i); };
  const auto independent = [](std::uint64_t p, std::uint32_t i) { return IndependentSampler(1, p, i); };
  const double sobol_rate = std::log(rms(sobol, 16) / rms(sobol, 1024)) / std::log(64.0);
  const double independent_rate = std::log(rms(independent, 16) / rms(independent, 1024)) / std::log(64.0);
  EXPECT_GT(sobol_rate, 1.3);
  EXPECT_NEAR(independent_rate, 0.5, 0.1);
}

TEST(IndependentSampler, IsTheCountedRandomNumbers) {
  IndependentSampler sampler(3, 1 << 20, 17);
  EXPECT_EQ(sampler.next_1d(), uniform(3, 1 << 20, 17, 0));
  const Vec2f u = sampler.next_2d();
  EXPECT_EQ(u.x, uniform(3, 1 << 20, 17, 1));
  EXPECT_EQ(u.y, uniform(3, 1 << 20, 17, 2));
}

TEST(Samplers, ADimensionSetGivesTheSameNumbersWhateverCameBefore) {
  SobolSampler a(1, 2, 3), b(1, 2, 3);
  a.next_2d();
  a.next_1d();
  b.set_dimension(2);
  EXPECT_EQ(a.dimension(), 2u);
  EXPECT_EQ(a.next_1d(), b.next_1d());
  IndependentSampler c(1, 2, 3), d(1, 2, 3);
  c.next_2d();
  d.set_dimension(2);
  EXPECT_EQ(c.next_1d(), d.next_1d());
}

} // namespace
} // namespace nacre
