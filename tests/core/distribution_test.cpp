#include "core/distribution.h"

#include "core/error.h"
#include "core/random.h"
#include "core/statistics.h"

#include <gtest/gtest.h>
#include <limits>
#include <numeric>

namespace nacre {
namespace {

constexpr float below_one = 1.0f - 0x1p-24f;

TEST(Distribution1D, DensityIsProportionalToTheValues) {
  const std::vector<float> values = {1, 3, 0, 4, 2, 0.5f};
  const Distribution1D d{std::span<const float>(values)};
  EXPECT_DOUBLE_EQ(d.integral(), 10.5 / 6);
  double sum = 0;
  for (int i = 0; i < 6; ++i) {
    const double expected = values[i] / d.integral();
    EXPECT_NEAR(d.pdf((i + 0.5f) / 6), expected, 6 * 0x1p-24);
    EXPECT_NEAR(d.probability(i), expected / 6, 0x1p-24);
    sum += d.probability(i);
  }
  EXPECT_EQ(sum, 1.0);
  EXPECT_EQ(d.pdf(-0.1f), 0);
  EXPECT_EQ(d.pdf(1.1f), 0);
  EXPECT_EQ(d.pdf(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(Distribution1D, SamplesFallAsTheDensitySays) {
  const std::vector<float> values = {1, 3, 0, 4, 2, 0.5f, 7, 1e-3f};
  const Distribution1D d{std::span<const float>(values)};
  constexpr int n = 100000;
  std::vector<double> observed(32), expected(32);
  for (int i = 0; i < n; ++i)
    ++observed[static_cast<int>(d.sample(uniform(1, 0, i, 0)).x * 32)];
  for (int i = 0; i < 32; ++i)
    expected[i] = n * d.pdf((i + 0.5f) / 32) / 32;
  EXPECT_GT(chi_square_test(observed, expected).p, 0.01);
}

TEST(Distribution1D, SampleAgreesWithPdfAndNeverHitsAZeroCell) {
  for (std::uint64_t trial = 0; trial < 50; ++trial) {
    const int n = 1 + static_cast<int>(hash(trial) % 2000);
    std::vector<float> values(n);
    for (int i = 0; i < n; ++i) {
      const float r = uniform(trial, 1, i, 0);
      values[i] = r < 0.5f ? 0 : std::pow(10.0f, -20 + 40 * uniform(trial, 2, i, 0));
    }
    values[n / 2] = 1;
    const Distribution1D d{std::span<const float>(values)};
    std::vector<float> us = {0, 0x1p-24f, 0.5f, below_one, 1.0f};
    for (int i = 0; i < 2000; ++i)
      us.push_back(uniform(trial, 3, i, 0));
    for (int i = 0; i < n; i += 7)
      us.push_back(std::accumulate(values.begin(), values.begin() + i, 0.0) / (d.integral() * n));
    for (const float u : us) {
      const Distribution1D::Sample s = d.sample(u);
      ASSERT_TRUE(s.x >= 0 && s.x < 1) << s.x;
      ASSERT_GT(s.pdf, 0);
      ASSERT_GT(values[s.index], 0) << "cell " << s.index << " of " << n << " at u = " << u;
      ASSERT_EQ(s.pdf, d.pdf(s.x)) << "cell " << s.index << " of " << n << " at u = " << u;
    }
  }
}

TEST(Distribution1D, StaysInTheCellWhenRoundingWouldLeaveIt) {
  // u just below the end of a cell, where (index + share) / n rounds to the start of the next.
  for (const int n : {3, 1000, 4095, 100003}) {
    std::vector<float> values(n);
    for (int i = 0; i < n; i += 2)
      values[i] = 1;
    const Distribution1D d{std::span<const float>(values)};
    float end = 0;
    for (int i = 0; i < n; ++i) {
      end += d.probability(i); // exact: multiples of 2^-24
      if (values[i] == 0) continue;
      for (const float u : {end - d.probability(i), std::nextafter(end, 0.0f)}) {
        const Distribution1D::Sample s = d.sample(u);
        ASSERT_EQ(s.index, i) << "of " << n;
        ASSERT_EQ(s.pdf, d.pdf(s.x)) << "cell " << i << " of " << n;
      }
    }
  }
}

TEST(Distribution1D, ReachesEveryPositiveCellHoweverSmall) {
  std::vector<float> values(1000, 1e-30f);
  values[0] = 0;
  values[500] = 1e30f;
  values[999] = 0;
  const Distribution1D d{std::span<const float>(values)};
  for (int i = 0; i < 1000; ++i)
    EXPECT_EQ(d.probability(i) > 0, values[i] > 0) << i;
  EXPECT_GT(d.probability(500), 0.9999f);
  EXPECT_EQ(d.sample(0).index, 1);
  EXPECT_EQ(d.sample(below_one).index, 998);
}

TEST(Distribution1D, SamplingIsMonotone) {
  const std::vector<float> values = {1, 0, 0, 5, 2, 2, 0, 1};
  const Distribution1D d{std::span<const float>(values)};
  float last = 0;
  for (int i = 0; i <= 4096; ++i) {
    const float x = d.sample(static_cast<float>(i) / 4096).x;
    ASSERT_GE(x, last);
    last = x;
  }
}

TEST(Distribution1D, AllZeroIsUniform) {
  const std::vector<float> values(5, 0.0f);
  const Distribution1D d{std::span<const float>(values)};
  EXPECT_EQ(d.integral(), 0);
  for (int i = 0; i < 5; ++i)
    EXPECT_NEAR(d.pdf((i + 0.5f) / 5), 1, 5 * 0x1p-24);
  EXPECT_NEAR(d.sample(0.3f).x, 0.3f, 1e-6);
}

TEST(Distribution1D, LargestTableIsSampledWithinItsCells) {
  const std::vector<float> values(1 << 22, 1.0f);
  const Distribution1D d{std::span<const float>(values)};
  for (int i = 0; i < 1000; ++i) {
    const float u = uniform(1, 2, i, 0);
    EXPECT_EQ(d.sample(u).x, u);
    EXPECT_EQ(d.pdf(u), 1);
  }
}

TEST(Distribution1D, RefusesWhatIsNoDensity) {
  const auto build = [](std::vector<float> values) { return Distribution1D{std::span<const float>(values)}; };
  EXPECT_THROW(build({}), Error);
  EXPECT_THROW(build({1, -1}), Error);
  EXPECT_THROW(build({1, std::numeric_limits<float>::quiet_NaN()}), Error);
  EXPECT_THROW(build({1, std::numeric_limits<float>::infinity()}), Error);
  const std::vector<double> overflowing(3, 1e308);
  EXPECT_THROW(Distribution1D{std::span<const double>(overflowing)}, Error);
  EXPECT_NO_THROW(build({3e38f, 3e38f, 3e38f}));
}

TEST(Distribution2D, SamplesFallAsTheDensitySays) {
  constexpr int w = 8, h = 5, n = 200000;
  std::vector<float> values(w * h);
  for (int i = 0; i < w * h; ++i)
    values[i] = i % 7 == 0 || i / w == 2 ? 0 : static_cast<float>(i * i % 23);
  const Distribution2D d(values, w, h);
  std::vector<double> observed(w * h), expected(w * h);
  for (int i = 0; i < n; ++i) {
    const auto s = d.sample({uniform(1, 0, i, 0), uniform(1, 0, i, 1)});
    ASSERT_EQ(s.pdf, d.pdf(s.uv));
    const int cell = static_cast<int>(s.uv.y * h) * w + static_cast<int>(s.uv.x * w);
    ASSERT_GT(values[cell], 0);
    ++observed[cell];
  }
  double sum = 0;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const double density = d.pdf({(x + 0.5f) / w, (y + 0.5f) / h});
      EXPECT_NEAR(density, values[y * w + x] / d.integral(), 1e-5);
      expected[y * w + x] = n * density / (w * h);
      sum += density / (w * h);
    }
  EXPECT_NEAR(sum, 1, 1e-6);
  EXPECT_GT(chi_square_test(observed, expected).p, 0.01);
}

TEST(Distribution2D, FindsTheSunInADarkSky) {
  constexpr int w = 256, h = 128;
  std::vector<float> values(w * h, 1e-4f);
  values[20 * w + 30] = 1e6f;
  const Distribution2D d(values, w, h);
  int hits = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto s = d.sample({uniform(1, 0, i, 0), uniform(1, 0, i, 1)});
    hits += static_cast<int>(s.uv.x * w) == 30 && static_cast<int>(s.uv.y * h) == 20;
  }
  EXPECT_GT(hits, 990);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      ASSERT_GT(d.pdf({(x + 0.5f) / w, (y + 0.5f) / h}), 0);
}

TEST(Distribution2D, AllZeroIsUniform) {
  const std::vector<float> values(12, 0.0f);
  const Distribution2D d(values, 4, 3);
  EXPECT_NEAR(d.pdf({0.1f, 0.9f}), 1, 1e-6);
  const auto s = d.sample({below_one, below_one});
  EXPECT_LT(s.uv.x, 1);
  EXPECT_LT(s.uv.y, 1);
}

TEST(Distribution2D, RefusesSizesThatDisagree) {
  const std::vector<float> values(12, 1.0f);
  EXPECT_THROW(Distribution2D(values, 4, 4), Error);
  EXPECT_THROW(Distribution2D(values, 0, 3), Error);
  EXPECT_THROW(Distribution2D(values, -4, -3), Error);
  EXPECT_THROW(Distribution2D(values, std::numeric_limits<int>::max(), 3), Error);
}

} // namespace
} // namespace nacre
