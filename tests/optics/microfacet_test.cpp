// The laws of microfacet distributions, each by quadrature in double precision.
#include "optics/microfacet.h"

#include "core/quadrature.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

/// Integral over the hemisphere of normals with nodes dense where a distribution of this roughness has its
/// mass: slopes alpha tan(v) for v in (0, pi/2).
template <class F>
double integrate_normals(double alpha_x, double alpha_y, F f) {
  const QuadratureRule v = gauss_legendre(200, 0, pi / 2), phi = gauss_legendre(96, 0, 2 * pi);
  double sum = 0;
  for (std::size_t i = 0; i < v.node.size(); ++i)
    for (std::size_t j = 0; j < phi.node.size(); ++j) {
      const double r = std::tan(v.node[i]);
      const double sx = alpha_x * r * std::cos(phi.node[j]), sy = alpha_y * r * std::sin(phi.node[j]);
      const Vec3d wm = normalize(Vec3d{-sx, -sy, 1});
      const double slope_area = alpha_x * alpha_y * r * (1 + r * r); // dslope = slope_area dv dphi
      sum += v.weight[i] * phi.weight[j] * slope_area * wm.z * wm.z * wm.z * f(wm); // dwm = cos^3 dslope
    }
  return sum;
}

template <class D>
class DistributionLaws : public testing::Test {};
using Distributions = testing::Types<Ggx<double>, Beckmann<double>>;
TYPED_TEST_SUITE(DistributionLaws, Distributions);

constexpr std::pair<double, double> roughness[] = {{0.01, 0.01}, {0.1, 0.1},  {0.5, 0.5},
                                                   {1, 1},       {0.05, 0.4}, {1, 0.2}};

TYPED_TEST(DistributionLaws, ProjectedAreaIsOne) {
  for (const auto& [ax, ay] : roughness) {
    const TypeParam d{ax, ay};
    EXPECT_NEAR(integrate_normals(ax, ay, [&](const Vec3d& wm) { return d.D(wm) * wm.z; }), 1, 1e-6)
        << ax << " " << ay;
  }
}

// Heitz 2014, eq. 14: what is visible of the facets is the projected area of the surface.
TYPED_TEST(DistributionLaws, VisibleProjectedAreaIsConserved) {
  for (const auto& [ax, ay] : roughness)
    for (const double theta : {0.0, 0.3, 1.0, 1.4, 1.55}) {
      const TypeParam d{ax, ay};
      const Vec3d wo = spherical_direction(theta, 0.7);
      const double seen = integrate_normals(
          ax, ay, [&](const Vec3d& wm) { return smith_g1(d, wo) * std::max(0.0, dot(wo, wm)) * d.D(wm); });
      EXPECT_NEAR(seen, wo.z, 2e-4) << d.name << " alpha " << ax << " " << ay << " theta " << theta;
    }
}

// Heitz 2014, section 5.4: without shadowing, all light that meets visible facets leaves them.
TYPED_TEST(DistributionLaws, WeakWhiteFurnaceKeepsAllLight) {
  for (const auto& [ax, ay] : roughness)
    for (const double theta : {0.1, 0.8, 1.3}) {
      const TypeParam d{ax, ay};
      const Vec3d wo = spherical_direction(theta, 2.0);
      const double all = integrate_normals(ax, ay, [&](const Vec3d& wm) {
        const double c = std::max(0.0, dot(wo, wm)); // dwi = 4 c dwm
        return smith_g1(d, wo) * d.D(wm) / (4 * wo.z) * 4 * c;
      });
      EXPECT_NEAR(all, 1, 2e-3);
    }
}

TYPED_TEST(DistributionLaws, CorrelatedMaskingIsBetweenSeparableAndNone) {
  const TypeParam d{0.6, 0.3};
  for (const double theta : {0.2, 0.9, 1.5})
    for (const double phi : {0.0, 1.0, 3.0}) {
      const Vec3d wo = spherical_direction(theta, 0.0), wi = spherical_direction(1.2, phi);
      const double none = 1 / (4 * wo.z * wi.z);
      const double correlated = visibility(d, wo, wi, 0.0), separable = visibility(d, wo, wi, 1.0);
      EXPECT_LE(correlated, none);
      EXPECT_LE(separable, correlated);
      EXPECT_NEAR(separable / none, smith_g1(d, wo) * smith_g1(d, wi), 1e-12);
    }
}

TYPED_TEST(DistributionLaws, VisibleNormalsFaceTheView) {
  const TypeParam d{0.8, 0.2};
  for (const double theta : {0.0, 0.5, 1.5, 1.5707})
    for (int i = 0; i < 1000; ++i) {
      const Vec3d wo = spherical_direction(theta, 0.3);
      const Vec3d wm = d.sample_visible(wo, {(i + 0.5) / 1000, std::fmod(i * 0.6180339887, 1.0)});
      EXPECT_NEAR(length(wm), 1, 1e-12);
      EXPECT_GE(dot(wo, wm), -1e-6);
      EXPECT_GT(wm.z, 0);
    }
}

TEST(Beckmann, MaskingIsKnownAtTheLimits) {
  const Beckmann<double> d{0.5, 0.5};
  EXPECT_LT(d.lambda_cos({0, 0, 1}), 1e-100);
  // At grazing, Lambda cos tends to alpha / (2 sqrt(pi)).
  EXPECT_NEAR(d.lambda_cos({1, 0, 0}), 0.5 / (2 * std::sqrt(pi)), 1e-12);
  // Heitz 2014, eq. 82, at a = 1 / (alpha tan theta) = 1
  const double theta = std::atan(2.0);
  const double lambda = (std::erf(1.0) - 1) / 2 + std::exp(-1.0) / (2 * std::sqrt(pi));
  EXPECT_NEAR(d.lambda_cos(spherical_direction(theta, 0.0)), lambda * std::cos(theta), 1e-12);
}

TEST(Erfinv, InvertsErf) {
  for (double x = -3.5; x <= 3.5; x += 0.01)
    EXPECT_NEAR(erfinv(std::erf(x)), x, 2e-6 * std::max(1.0, std::abs(x)) + 1e-4 * (std::abs(x) > 3)) << x;
}

} // namespace
} // namespace nacre
