// The two-scale model's own parts: its limits, its blur against the true convolution, its lobe's share.
#include "bsdf/models/rough_conductor.h"
#include "bsdf/models/two_scale.h"

#include "core/quadrature.h"
#include "core/random.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

TEST(ProjectedDiskLobe, ShareInTheDiskIsItsIntegral) {
  for (const double B : {0.3, 4.0, 300.0})
    for (const double C : {1.03, 1.5, 2.5})
      for (const double s : {0.0, 0.4, 0.9, 0.999}) {
        const ProjectedDiskLobe<double> lobe{B, C};
        // Over the disk in polar coordinates about its centre, which lies at distance s from the lobe's.
        const auto f = [&](double r, double phi) {
          return r * std::pow(1 + B * (r * r + s * s - 2 * r * s * std::cos(phi)), -C) * 2 * B * (C - 1) / pi;
        };
        const double share =
            integrate_adaptive_2d(f, {0, 0}, {1, pi}, {.absolute = 1e-6, .relative = 1e-6}).value;
        EXPECT_NEAR(lobe.share_in_disk(s), share, 2e-3) << B << " " << C << " " << s;
      }
}

TEST(TwoScale, WithoutFinerRoughnessItIsTheFacetsAlone) {
  auto m = default_model<TwoScale<double, 1>>();
  m.sigma = 0;
  m.p = 1;
  m.beta = 0.3;
  auto facets = default_model<BeckmannConductor<double, 1>>();
  facets.alpha_x = facets.alpha_y = 0.3;
  // Opposite azimuths: van Ginneken's masking is then all but height-correlated.
  const Vec3d wo = spherical_direction(0.6, 0.0), wi = spherical_direction(0.4, pi);
  EXPECT_NEAR(m.eval(wo, wi)[0], facets.eval(wo, wi)[0], 1e-3 * facets.eval(wo, wi)[0]);
}

TEST(TwoScale, ShorterWavesAreDiffractedMore) {
  auto m = default_model<TwoScale<double, 3>>();
  m.wavelength = Spectrum<double, 3>({0.65, 0.55, 0.45});
  const Vec3d wo = spherical_direction(0.5, 0.0), mirror = spherical_direction(0.5, pi);
  const Vec3d aside = spherical_direction(0.5, pi - 1);
  const auto peak = m.eval(wo, mirror), haze = m.eval(wo, aside);
  EXPECT_GT(peak[0], peak[2]); // the mirror lobe is reddish, the haze bluish
  EXPECT_LT(haze[0], haze[2]);
}

/// The convolution that eq. 33 asks for: S(angle to h) D over the sphere of normals, S = S_HS cos^2
/// normalised.
double convolution(double beta, double p, double u, double c, double theta_h) {
  const auto d = exponential_power(beta, beta, p);
  const Vec3d h = spherical_direction(theta_h, 0.0);
  const double centre = beta * u < 1 ? 0 : std::tan(theta_h); // of the narrower of both
  const auto at = [&](double r, double phi) {
    const Vec3d m = normalize(Vec3d{centre + r * std::cos(phi), r * std::sin(phi), 1});
    const double cos_mh = std::max(0.0, dot(m, h));
    const double S_HS = std::pow(1 + 4 * u * u * (1 - sqr(cos_mh)), -0.5 * (c + 1));
    return 2 * u * u * (c - 1) / pi * S_HS * sqr(cos_mh) * d.D(m) * m.z * m.z * m.z * r * r;
  };
  const QuadratureRule log_r = composite_gauss_legendre(6, 60, std::log(1e-6), std::log(100.0));
  const QuadratureRule around = composite_gauss_legendre(8, 20, 0, pi);
  double sum = 0;
  for (std::size_t i = 0; i < log_r.node.size(); ++i)
    for (std::size_t j = 0; j < around.node.size(); ++j)
      sum += 2 * log_r.weight[i] * around.weight[j] * at(std::exp(log_r.node[i]), around.node[j]);
  return sum;
}

// One lobe of S_HS's shape, as the source fits it too, cannot follow both S and D where D is the wider: its
// end at three times the width, less than a hundredth of the peak, is then off by up to 20 times. The mean is
// what counts.
TEST(TwoScale, BlurIsNearTheTrueConvolution) {
  double worst_peak = 1, worst_narrow = 1, sum = 0;
  int count = 0;
  for (const double beta : {0.01, 0.05, 0.2})
    for (const double p : {0.5, 1.0, 2.0})
      for (const double u : {1.0, 5.0, 30.0})
        for (const double c : {1.5, 2.5})
          for (const double x : {0.0, 1.0, 3.0}) {
            const double limit = 0.5 * p / (std::tgamma(1 / p) * (c - 1) * beta * beta);
            const double g2 = 1 / (1 / (u * u) + 1 / limit),
                         theta = std::min(1.0, std::atan(x * (beta + 0.5 / u)));
            const double S_HS = std::pow(1 + 4 * g2 * sqr(std::sin(theta)), -0.5 * (c + 1));
            const double ours = 2 * g2 * (c - 1) / pi * S_HS * sqr(std::cos(theta));
            const double ratio = ours / convolution(beta, p, u, c, theta), off = std::max(ratio, 1 / ratio);
            if (x == 0) worst_peak = std::max(worst_peak, off);
            if (beta * u <= 0.05) worst_narrow = std::max(worst_narrow, off);
            sum += std::log(off), ++count;
          }
  EXPECT_LT(worst_narrow, 1.2);
  EXPECT_LT(worst_peak, 2.6);
  EXPECT_LT(std::exp(sum / count), 1.28);
}

} // namespace
} // namespace nacre
