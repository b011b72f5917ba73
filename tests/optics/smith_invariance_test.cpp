#include "optics/smith_invariance.h"

#include "core/quadrature.h"
#include "core/random_stream.h"
#include "optics/microfacet.h"
#include "optics/smith_walk.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

/// Albedos of the second, third and all later bounces.
LaterBounces<double> later_albedo(const Vec3d& wo, double alpha) {
  const Ggx<double> d{alpha, alpha};
  LaterBounces<double> sum{};
  for (const DirectionNode& n : hemisphere_rule(96, 48)) {
    const auto f = SmithInvariance::table().later_bounces(wo, n.w, alpha);
    const double scale = 4 * visibility(d, wo, n.w, 0.0) * n.w.z * n.weight;
    sum.second += f.second * scale, sum.third += f.third * scale, sum.all += f.all * scale;
  }
  return sum;
}

/// Shares of light that leave a white surface after the first, second and third bounce, by walking.
std::array<double, 4> leaving_after(const Vec3d& wo, double alpha, int n) {
  const Ggx<double> d{alpha, alpha};
  std::array<double, 4> share{};
  for (int i = 0; i < n; ++i) {
    RandomStream<double> random(unit_double(hash(3, i)), Vec2<double>{alpha, wo.z});
    Vec3d r = -wo;
    double depth = next_facet(d, r, 0.0, random.next());
    std::size_t bounces = 0;
    while (depth > 0 && bounces < 100) {
      r = reflect(-r, d.sample_visible(-r, random.next_2d()));
      ++bounces;
      depth = next_facet(d, r, depth, random.next());
    }
    if (bounces < 4) share[bounces] += 1.0 / n;
  }
  return share;
}

TEST(SmithInvariance, EachBounceIsThatOfTheRandomWalk) {
  for (const double alpha : {0.25, 0.6, 1.0})
    for (const double theta : {20.0, 65.0}) {
      const Vec3d wo = spherical_direction(theta * pi / 180, 0.0);
      constexpr int n = 60000; // standard error 0.002
      const auto walked = leaving_after(wo, alpha, n);
      const auto solved = later_albedo(wo, alpha);
      EXPECT_NEAR(solved.second, walked[2], 0.008) << alpha << " " << theta;
      EXPECT_NEAR(solved.third, walked[3], 0.008) << alpha << " " << theta;
      EXPECT_NEAR(solved.all, 1 - walked[1], 0.008) << alpha << " " << theta;
    }
}

/// The first bounce of the walk is single scattering, whose albedo is G2 / G1 averaged over visible normals.
TEST(SmithInvariance, FirstBounceOfTheWalkIsSingleScattering) {
  const double alpha = 0.6;
  const Ggx<double> d{alpha, alpha};
  const Vec3d wo = spherical_direction(0.9, 0.0);
  double E = 0;
  const QuadratureRule rule = composite_gauss_legendre(16, 8, 0, 1);
  for (std::size_t j = 0; j < rule.node.size(); ++j)
    for (int i = 0; i < 64; ++i) {
      const Vec3d wi = reflect(wo, d.sample_visible(wo, {(i + 0.5) / 64, rule.node[j]}));
      if (wi.z > 0)
        E += rule.weight[j] / 64 * 4 * (wo.z + d.lambda_cos(wo)) * wi.z * visibility(d, wo, wi, 0.0);
    }
  EXPECT_NEAR(leaving_after(wo, alpha, 60000)[1], E, 0.008);
}

TEST(SmithInvariance, IsSymmetricAndPositive) {
  for (int i = 0; i < 500; ++i) {
    const auto u = [&](int d) { return unit_double(hash(9, i, d)); };
    const Vec3d a = spherical_direction(u(0) * pi / 2, u(1) * 7),
                b = spherical_direction(u(2) * pi / 2, u(3) * 7);
    const auto ab = SmithInvariance::table().later_bounces(a, b, u(4));
    const auto ba = SmithInvariance::table().later_bounces(b, a, u(4));
    EXPECT_NEAR(ab.all, ba.all, 1e-5 * ab.all + 1e-9);
    EXPECT_GE(ab.second, 0);
    EXPECT_GE(ab.third, 0);
    EXPECT_GE(ab.all, ab.second * 0.98); // the orders are balanced together
  }
}

TEST(LaterBounces, ReflectanceWeighsEachOrder) {
  const LaterBounces<double> mirrors{0.3, 0.1, 0.45}; // 0.3, 0.1, then falling by a third each
  EXPECT_NEAR(mirrors.with_reflectance(1.0, 1.0), 0.45, 1e-5);
  EXPECT_EQ(mirrors.with_reflectance(0.0, 0.5), 0);
  const double rho = 0.5, falling = 1 - 0.1 / 0.15;
  EXPECT_NEAR(mirrors.with_reflectance(rho * rho, rho), 0.25 * 0.3 + 0.125 * 0.1 / (1 - rho * falling), 1e-6);
}

} // namespace
} // namespace nacre
