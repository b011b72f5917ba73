#include "optics/rough_transmittance.h"

#include "core/quadrature.h"
#include "core/random.h"
#include "optics/fresnel.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

const RoughTransmittance& ggx() { return RoughTransmittance::table<Ggx>(); }

TEST(RoughTransmittance, OfASmoothInterfaceIsFresnels) {
  for (const double eta : {1.1, 1.5, 2.3})
    for (const double c : {1.0, 0.8, 0.5, 0.3, 0.1})
      EXPECT_NEAR(ggx().outside(c, 0.0, eta), 1 - fresnel_dielectric(c, eta).reflectance, 4e-3)
          << c << " " << eta;
}

TEST(RoughTransmittance, InsideOfASmoothInterfaceIsWalshsAverage) {
  for (const double eta : {1.05, 1.313636364, 1.5, 2.5})
    EXPECT_NEAR(ggx().diffuse_reflectance_inside(0.0, eta), fresnel_dielectric_average_inside(eta), 4e-3)
        << eta;
}

/// Mean of what the table is made of over n x n visible normals: reflected, transmitted.
std::array<double, 2> reference(double cos_theta, double alpha, double eta, int n) {
  const Ggx<double> d{alpha, alpha};
  const Vec3d wo{std::sqrt(1 - cos_theta * cos_theta), 0, cos_theta};
  std::array<double, 2> sum{};
  for (int i = 0; i < n * n; ++i) {
    const Vec3d wm = d.sample_visible(wo, {(i / n + 0.5) / n, (i % n + 0.5) / n});
    const auto fresnel = fresnel_dielectric(dot(wo, wm), eta);
    const Vec3d wi = reflect(wo, wm), wt = wm * (dot(wo, wm) / eta + fresnel.cos_t) - wo * (1 / eta);
    if (wi.z > 0) sum[0] += fresnel.reflectance * smith_g1(d, wi) / (n * n);
    if (wt.z < 0) sum[1] += (1 - fresnel.reflectance) * smith_g1(d, -wt) / (n * n);
  }
  return sum;
}

TEST(RoughTransmittance, IsWithinTheStatedErrorBetweenNodes) {
  const auto random = [](int i, int dimension) { return unit_double(hash(5, i, dimension)); };
  const auto alpha = [&](int i) { return std::max(1e-3, sqr(random(i, 1))); };
  const auto eta = [&](int i) { return 1.05 + 1.45 * random(i, 2); };
  double mean = 0;
  constexpr int points = 400;
  for (int i = 0; i < points; ++i) {
    const double c = std::max(0.05, sqr(random(i, 0)));
    const double error = std::abs(ggx().outside(c, alpha(i), eta(i)) - reference(c, alpha(i), eta(i), 48)[1]);
    EXPECT_LT(error, 0.015) << c << " " << alpha(i) << " " << eta(i);
    mean += error / points;
  }
  EXPECT_LT(mean, 0.002);
  for (int i = 0; i < 20; ++i) {
    const double inside = integrate(composite_gauss_legendre(8, 12, 0, 1), [&](double mu) {
      return 2 * mu * reference(mu, alpha(i), 1 / eta(i), 32)[0];
    });
    EXPECT_NEAR(ggx().diffuse_reflectance_inside(alpha(i), eta(i)), inside, 0.008)
        << alpha(i) << " " << eta(i);
  }
}

TEST(RoughTransmittance, NodesInsideResolveTheKinkOfTotalReflection) {
  // By 128 x 64 x 64 nodes. The part that is not reflected, 0.22, divides the light of the base.
  EXPECT_NEAR(ggx().diffuse_reflectance_inside(25.0 / 121, 2.5), 0.7768, 0.004);
}

TEST(RoughTransmittance, KeepsItsDerivativesAtTheUpperEndsOfTheDomain) {
  using D = Dual<double, 2>;
  const auto slopes = [](double alpha, double eta) {
    return ggx().outside(D(0.5), D::variable(alpha, 0), D::variable(eta, 1)).d;
  };
  const auto end = slopes(1, 2.5), inside = slopes(0.9999, 2.4999);
  EXPECT_NEAR(end[0], inside[0], 1e-2 * std::abs(inside[0]));
  EXPECT_NEAR(end[1], inside[1], 1e-2 * std::abs(inside[1]));
}

TEST(RoughTransmittance, FallsWithRoughnessByWhatMultipleBouncesWouldCarry) {
  double last = 1;
  for (const double alpha : {0.01, 0.1, 0.3, 0.6, 1.0}) {
    const double T = ggx().outside(0.6, alpha, 1.5);
    EXPECT_LT(T, last);
    EXPECT_GT(T, 0.4);
    last = T;
  }
}

TEST(RoughTransmittance, IsTheSameForPacksAndDoubles) {
  // One interface for all lanes, and one for each.
  for (const bool alike : {true, false}) {
    std::array<float, pack_width> c, alpha, eta;
    for (std::size_t l = 0; l < pack_width; ++l) {
      const float at = float(l) / float(pack_width - 1);
      c[l] = at;
      alpha[l] = alike ? 0.37f : 0.05f + 0.95f * at;
      eta[l] = alike ? 1.6f : 2.5f - 1.4f * at;
    }
    const Pack a = load(alpha.data()), e = load(eta.data());
    const Pack outside = ggx().outside(load(c.data()), a, e), inside = ggx().diffuse_reflectance_inside(a, e);
    for (std::size_t l = 0; l < pack_width; ++l) {
      EXPECT_NEAR(lane(outside, l), ggx().outside(double(c[l]), double(alpha[l]), double(eta[l])), 1e-5);
      EXPECT_NEAR(lane(inside, l), ggx().diffuse_reflectance_inside(double(alpha[l]), double(eta[l])), 1e-5);
    }
  }
}

} // namespace
} // namespace nacre
