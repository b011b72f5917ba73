#include "core/error.h"
#include "core/random.h"
#include "core/statistics.h"
#include "measured/marginal_warp.h"

#include <cmath>
#include <gtest/gtest.h>

namespace nacre {
namespace {

double random(int i, int d) { return unit_double(hash(23, i, d)); }

constexpr std::size_t width = 9, height = 7;
const std::vector<float> a_nodes{-1, 0, 2}, b_nodes{0.5f, 1.5f};

/// Six slices of peaks and of cells, rows and columns of 0.
MarginalWarp uneven_warp() {
  std::vector<float> values;
  for (int s = 0; s < 6; ++s)
    for (std::size_t y = 0; y < height; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const double r = random(s, int(y * width + x));
        values.push_back(y == 2 || x == 3 || r < 0.2 ? 0.0f : float(std::pow(r, 6) * 1000));
      }
  return MarginalWarp(width, height, values);
}

TEST(MarginalWarp, BlendIsLinearBetweenNodesAndConstantBeyond) {
  const SliceBlend inside = blend_slices(a_nodes, 1.0, b_nodes, 0.75);
  ASSERT_EQ(inside.count, 4u);
  const std::size_t slices[] = {2, 3, 4, 5};
  const double weights[] = {0.375, 0.125, 0.375, 0.125};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(inside.slice[k], slices[k]);
    EXPECT_NEAR(inside.weight[k], weights[k], 1e-15);
  }
  for (const double below : {-5.0, std::nan("")}) {
    const SliceBlend end = blend_slices(a_nodes, below, b_nodes, below);
    EXPECT_EQ(end.count, 1u);
    EXPECT_EQ(end.slice[0], 0u);
  }
  const SliceBlend above = blend_slices(a_nodes, 7, b_nodes, 7);
  EXPECT_EQ(above.count, 1u);
  EXPECT_EQ(above.slice[0], 5u);
  EXPECT_EQ(blend_slices({a_nodes.data(), 1}, 3, b_nodes, 1.5).slice[0], 1u);
}

TEST(MarginalWarp, InvertUndoesSample) {
  const MarginalWarp warp = uneven_warp();
  for (int i = 0; i < 20000; ++i) {
    const SliceBlend blend = blend_slices(a_nodes, 4 * random(i, 0) - 1.5, b_nodes, 2 * random(i, 1));
    const Vec2d u{random(i, 2), random(i, 3)};
    const auto there = warp.sample(u, blend);
    const auto back = warp.invert(there.at, blend);
    // Where the density is nearly 0 the place is known to the root of the rounding alone; u then is as good.
    EXPECT_NEAR(back.at.x, u.x, 1e-9);
    EXPECT_NEAR(back.at.y, u.y, 1e-9);
    EXPECT_NEAR(back.pdf, there.pdf, 1e-6 * there.pdf + 1e-6);
    EXPECT_NEAR(back.pdf, warp.pdf(there.at, blend), 1e-12 * back.pdf);
  }
}

TEST(MarginalWarp, JacobianOfSampleIsOneOverItsDensity) {
  const MarginalWarp warp = uneven_warp();
  int compared = 0;
  for (int i = 0; i < 3000; ++i) {
    const SliceBlend blend = blend_slices(a_nodes, 3 * random(i, 0) - 1, b_nodes, 2 * random(i, 1));
    const Vec2d p{random(i, 2), random(i, 3)};
    const double h = 1e-6;
    const BilinearCell low({p.x - h, p.y - h}, width, height), high({p.x + h, p.y + h}, width, height);
    if (low.x != high.x || low.y != high.y || p.x < h || p.y < h || p.x > 1 - h || p.y > 1 - h) continue;
    const auto right = warp.invert({p.x + h, p.y}, blend).at, left = warp.invert({p.x - h, p.y}, blend).at;
    const auto up = warp.invert({p.x, p.y + h}, blend).at, down = warp.invert({p.x, p.y - h}, blend).at;
    const double jacobian =
        ((right.x - left.x) * (up.y - down.y) - (right.y - left.y) * (up.x - down.x)) / (4 * h * h);
    const double pdf = warp.pdf(p, blend);
    EXPECT_NEAR(jacobian, pdf, 1e-5 * pdf + 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 2900);
}

TEST(MarginalWarp, SamplesFollowTheDensity) {
  const MarginalWarp warp = uneven_warp();
  for (const auto& [a, b] : {std::pair{-1.0, 0.5}, std::pair{0.7, 1.1}, std::pair{2.0, 0.8}}) {
    const SliceBlend blend = blend_slices(a_nodes, a, b_nodes, b);
    const int n = 200000, bins = 16;
    std::vector<double> found(bins * bins), expected(bins * bins);
    for (int i = 0; i < n; ++i) {
      const Vec2d p = warp.sample({random(i, 4), random(i, 5)}, blend).at;
      ++found[std::min(int(p.y * bins), bins - 1) * bins + std::min(int(p.x * bins), bins - 1)];
    }
    // Nodes lie at multiples of 1/48 of a bin's side: the midpoint rule is exact for each bilinear piece.
    const int fine = 48;
    for (int y = 0; y < bins * fine; ++y)
      for (int x = 0; x < bins * fine; ++x)
        expected[(y / fine) * bins + x / fine] +=
            n * warp.pdf({(x + 0.5) / (bins * fine), (y + 0.5) / (bins * fine)}, blend) /
            (bins * bins * fine * fine);
    EXPECT_GT(chi_square_test(found, expected).p, sidak_significance(1e-4, 3));
  }
}

TEST(MarginalWarp, CornersAndTablesOfZeroAreHarmless) {
  const MarginalWarp zero(3, 2, std::vector<float>(6));
  for (const double x : {0.0, 0.3, 1.0, -4.0, std::nan("")})
    for (const double y : {0.0, 0.6, 1.0, 9.0, std::nan("")}) {
      const auto p = zero.sample({x, y}, {});
      EXPECT_EQ(p.pdf, 1);
      EXPECT_TRUE(p.at.x >= 0 && p.at.x <= 1 && p.at.y >= 0 && p.at.y <= 1);
      const auto q = uneven_warp().sample({x, y}, {});
      EXPECT_TRUE(q.at.x >= 0 && q.at.x <= 1 && q.at.y >= 0 && q.at.y <= 1 && std::isfinite(q.pdf));
    }
  EXPECT_THROW(MarginalWarp(1, 6, std::vector<float>(6)), Error);
  EXPECT_THROW(MarginalWarp(2, 2, std::vector<float>{1, 2, -1, 0}), Error);
  EXPECT_THROW(MarginalWarp(2, 2, std::vector<float>{1, 2, std::nanf(""), 0}), Error);
}

} // namespace
} // namespace nacre
