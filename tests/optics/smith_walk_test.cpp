#include "optics/smith_walk.h"

#include "core/quadrature.h"
#include "core/random.h"
#include "optics/microfacet.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

double random(int i, int d) { return unit_double(hash(5, i, d)); }

TEST(SmithWalk, BetaIsEulersFunction) {
  for (const double p : {1.0, 1.3, 2.5, 7.0, 300.0})
    for (const double q : {1.0, 1.02, 3.0, 40.0}) {
      const double exact = std::exp(std::lgamma(p) + std::lgamma(q) - std::lgamma(p + q));
      if (exact < 1e-30) continue;
      EXPECT_NEAR(beta(p, q) / exact, 1, 1e-5) << p << " " << q;
      EXPECT_NEAR(double(beta(float(p), float(q))) / exact, 1, 1e-3) << p << " " << q;
    }
  EXPECT_EQ(beta(1e9f, 1e9f), 0); // no overflow where nothing is left
}

/// Area seen and mean height of the normals seen, by quadrature over all facets.
template <class Distribution>
std::pair<double, double> seen_by_quadrature(const Distribution& d, const Vec3d& w) {
  const auto at = [&](const Vec3d& wm) {
    const double a = std::max(dot(w, wm), 0.0) * d.D(wm);
    return Vec2<double>{a, a * wm.z};
  };
  double area = 0, height = 0;
  for (const DirectionNode& n : hemisphere_rule(400, 400)) {
    const auto [a, h] = at(n.w);
    area += n.weight * a, height += n.weight * h;
  }
  return {area, height / area};
}

template <class Distribution>
void expect_facets_seen_from_anywhere(const Distribution& d) {
  for (const double theta : {30.0, 80.0, 95.0, 110.0, 130.0}) {
    const Vec3d w = spherical_direction(theta * pi / 180, 0.7);
    const auto [area, height] = seen_by_quadrature(d, w);
    EXPECT_NEAR(seen_area(d, w), area, 2e-3 * area + 1e-6) << theta;
    if (area < 1e-5) continue;
    constexpr int n = 20000;
    double mean = 0;
    for (int i = 0; i < n; ++i) {
      const Vec3d wm = d.sample_visible(w, {random(i, 0), random(i, 1)});
      EXPECT_GT(dot(w, wm), -1e-5);
      mean += wm.z / n;
    }
    EXPECT_NEAR(mean, height, 0.01) << theta;
  }
}

TEST(SmithWalk, FacetsAreSeenFromBelowTheHorizonToo) {
  expect_facets_seen_from_anywhere(Ggx<double>{0.8, 0.4});
  expect_facets_seen_from_anywhere(Beckmann<double>{0.9, 0.6});
}

TEST(SmithWalk, DepthFromTheOtherSideIsAnInvolution) {
  for (const double e : {0.01, 0.3, std::log(2.0), 4.0})
    EXPECT_NEAR(depth_from_other_side(depth_from_other_side(e)), e, 1e-12);
}

/// Of the light that enters along -wi, the part whose first facet lies in the open towards wo: G2 / G1(wi) of
/// correlated heights, 1 / (1 + Lambda_o + Lambda_i) over 1 / (1 + Lambda_i).
TEST(SmithWalk, MaskingAndShadowingFollowFromDepths) {
  const Ggx<double> d{0.7, 0.7};
  const Vec3d wi = spherical_direction(1.0, 0.0), wo = spherical_direction(1.2, 2.0);
  constexpr int n = 100000;
  double out = 0;
  for (int i = 0; i < n; ++i)
    out += escape_probability(next_facet(d, -wi, 0.0, random(i, 2)), free_path(d, wo)) / n;
  const double lo = d.lambda_cos(wo) / wo.z, li = d.lambda_cos(wi) / wi.z;
  EXPECT_NEAR(out, (1 + li) / (1 + lo + li), 4e-3);
}

} // namespace
} // namespace nacre
