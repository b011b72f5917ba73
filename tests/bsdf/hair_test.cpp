// Facts of the hair model that no generic law knows.
#include "bsdf/models/hair.h"
#include "core/quadrature.h"
#include "core/random.h"
#include "core/warp.h"

#include <cmath>
#include <gtest/gtest.h>

namespace nacre {
namespace {

using Grey = Spectrum<double, 1>;
using Hair1 = Hair<double, 1>;

double random(int i, int d) { return unit_double(hash(31, i, d)); }
Vec3d random_direction(int i, int d) {
  return square_to_sphere(Vec2<double>{random(i, d), random(i, d + 1)});
}

Hair1 fibre(double sigma_a, double beta_m, double beta_n, double h, double tilt = 0.035) {
  return {{}, Grey(sigma_a), Grey(1), beta_m, beta_n, tilt, 1.55, h};
}

/// Integral over the sphere of f |cos_i|, by quadrature in the fibre's own angles.
template <class F>
double over_sphere(F f, int n_theta = 64, int n_phi = 128) {
  double sum = 0;
  const QuadratureRule rule = composite_gauss_legendre(n_theta / 4, 4, -pi / 2, pi / 2);
  for (std::size_t i = 0; i < rule.node.size(); ++i)
    for (int j = 0; j < n_phi; ++j) {
      const double theta = rule.node[i], phi = 2 * pi * (j + 0.5) / n_phi;
      sum += rule.weight[i] * 2 * pi / n_phi * std::cos(theta) *
             f(Vec3d{std::sin(theta), std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi)});
    }
  return sum;
}
double albedo(const Hair1& m, const Vec3d& wo) {
  return over_sphere([&](const Vec3d& wi) { return m.eval(wo, wi)[0] * std::abs(wi.z); });
}

TEST(Hair, BesselFunctionIsTheStandardLibrarys) {
  for (const double x : {0.0, 0.3, 1.0, 3.7, 3.8, 10.0, 100.0, 600.0})
    EXPECT_NEAR(scaled_bessel_i0(x) / (std::cyl_bessel_i(0.0, x) * std::exp(-x)), 1, 5e-7) << x;
}

TEST(Hair, WhiteFurnaceKeepsAllEnergyAtEveryOffset) {
  for (const double beta_m : {0.2, 0.5, 1.0})
    for (const double beta_n : {0.2, 0.6, 1.0})
      for (const double h : {-0.95, -0.3, 0.0, 0.7})
        EXPECT_NEAR(albedo(fibre(0, beta_m, beta_n, h), normalize(Vec3d{0.4, 0.3, 0.6})), 1, 2e-3)
            << beta_m << " " << beta_n << " " << h;
}

// As pbrt tests its own: averaged over offsets, by uniform directions.
TEST(Hair, WhiteFurnaceAveragedOverTheWidth) {
  for (const double beta : {0.1, 0.4, 0.9}) {
    double sum = 0;
    const int n = 100000;
    const Vec3d wo = random_direction(7, 90);
    for (int i = 0; i < n; ++i) {
      const Vec3d wi = square_to_sphere(Vec2<double>{(i + 0.5) / n, random(i, 1)});
      sum += fibre(0, beta, beta, 2 * random(i, 2) - 1).eval(wo, wi)[0] * std::abs(wi.z) * 4 * pi;
    }
    EXPECT_NEAR(sum / n, 1, 0.04) << beta;
  }
}

TEST(Hair, DensityIntegratesToOne) {
  for (const double h : {-0.6, 0.2})
    EXPECT_NEAR(over_sphere([&, m = fibre(0.7, 0.3, 0.4, h)](const Vec3d& wi) {
                  return m.pdf(normalize(Vec3d{-0.2, 0.5, 0.7}), wi);
                }),
                1, 1e-3);
}

TEST(Hair, SamplesOfAWhiteFibreWeighOne) {
  for (int i = 0; i < 2000; ++i) {
    const Hair1 m = fibre(0, 0.1 + 0.9 * random(i, 5), 0.1 + 0.9 * random(i, 6), 2 * random(i, 7) - 1);
    const auto s = m.sample(random_direction(i, 0), random(i, 2), {random(i, 3), random(i, 4)});
    if (std::abs(s.wi.z) < 1e-6) continue;
    EXPECT_NEAR(s.f[0] * std::abs(s.wi.z) / s.pdf, 1, 1e-5);
  }
}

TEST(Hair, WeightOfASampleIsTheSumOfAttenuations) {
  // At normal incidence on the middle of an untilted fibre all paths are known: F(0), T = exp(-2 sigma).
  const double sigma = 0.4, F = std::pow(0.55 / 2.55, 2), T = std::exp(-2 * sigma);
  const double sum = F + (1 - F) * (1 - F) * T / (1 - T * F);
  const auto s = fibre(sigma, 0.3, 0.3, 0, 0).sample({0, 0, 1}, 0.6, {0.3, 0.4});
  EXPECT_NEAR(s.f[0] * std::abs(s.wi.z) / s.pdf, sum, 1e-9);
}

TEST(Hair, HighlightIsShiftedByTwoTilts) {
  // The reflected cone of a narrow lobe: seen from theta_o its peak is at theta_i = -theta_o + 2 tilt.
  const double tilt = 0.1, theta_o = 0.3;
  const Hair1 m = fibre(20, 0.1, 0.3, 0, tilt); // opaque: R alone
  double best = 0, peak = 0;
  for (double theta = -1.2; theta < 1.2; theta += 1e-3) {
    const double f =
        m.eval({std::sin(theta_o), 0, std::cos(theta_o)}, {std::sin(theta), 0, std::cos(theta)})[0] *
        std::cos(theta);
    if (f > best) best = f, peak = theta;
  }
  EXPECT_NEAR(peak, -theta_o + 2 * tilt, 0.02);
}

TEST(Hair, TransmittedLightGoesStraightOnThroughTheMiddle) {
  const Hair1 m = fibre(0, 0.2, 0.1, 0, 0);
  const Vec3d wo{0, 0, 1};
  const auto toward = [&](double phi) {
    return m.eval(wo, {0, std::sin(phi), std::cos(phi)})[0] * std::abs(std::cos(phi));
  };
  EXPECT_GT(toward(pi), 5 * toward(0));
  EXPECT_GT(toward(pi), 20 * toward(pi / 3));
}

TEST(Hair, ColourIsTurnedIntoTheAbsorptionOfChiang) {
  // eq. 9 at beta_n = 0.3
  const double n = 0.3, c = 0.4;
  const double scale = 5.969 - 0.215 * n + 2.532 * n * n - 10.73 * std::pow(n, 3) + 5.574 * std::pow(n, 4) +
                       0.245 * std::pow(n, 5);
  const double sigma = std::pow(std::log(c) / scale, 2);
  Hair1 by_color = fibre(0, 0.3, n, 0.2);
  by_color.color = Grey(c);
  const Vec3d wo = random_direction(1, 0), wi = random_direction(2, 0);
  EXPECT_NEAR(by_color.eval(wo, wi)[0], fibre(sigma, 0.3, n, 0.2).eval(wo, wi)[0], 1e-6);
}

TEST(Hair, PigmentsAbsorbBlueMost) {
  const auto brown = hair_absorption(1.3, 0);
  EXPECT_NEAR(brown[0], 0.5447, 1e-4);
  EXPECT_LT(brown[0], brown[1]);
  EXPECT_LT(brown[1], brown[2]);
}

} // namespace
} // namespace nacre
