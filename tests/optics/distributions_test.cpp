// The laws that every distribution of facets keeps, by quadrature in double precision, and the identities
// between families.
#include "core/quadrature.h"
#include "core/random.h"
#include "optics/masking.h"
#include "optics/ndf_abc.h"
#include "optics/ndf_blinn_phong.h"
#include "optics/ndf_exponential_power.h"
#include "optics/ndf_gtr.h"
#include "optics/ndf_shifted_gamma.h"
#include "optics/ndf_student_t.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

/// Integral over the hemisphere of D(wm) f(wm), for slopes (x r cos, y r sin): log r over all decades, the
/// azimuth where wo sees the facets.
template <class Distribution, class F>
double integrate_facets(const Distribution& d, double x, double y, const Vec3d& wo, F f) {
  const QuadratureRule log_r = composite_gauss_legendre(8, 50, std::log(1e-8), std::log(1e6));
  const QuadratureRule around = gauss_legendre(40, -1, 1);
  const double s = std::hypot(x * wo.x, y * wo.y), start = std::atan2(y * wo.y, x * wo.x);
  double sum = 0;
  for (std::size_t i = 0; i < log_r.node.size(); ++i) {
    const double r = std::exp(log_r.node[i]), c = -wo.z / (s * r);
    const double edge = s * r > wo.z ? std::acos(c) : pi;
    for (std::size_t j = 0; j < around.node.size(); ++j) {
      const double phi = start + edge * around.node[j];
      const Vec3d wm = normalize(Vec3d{x * r * std::cos(phi), y * r * std::sin(phi), 1});
      if (wm.z < 2e-5) continue;
      sum += log_r.weight[i] * around.weight[j] * edge * x * y * r * r * wm.z * wm.z * wm.z * d.D(wm) * f(wm);
    }
  }
  return sum;
}

/// Calls f(name, distribution, stretch_x, stretch_y, projected area) for each of a family's members.
template <class F>
void for_each_distribution(F f) {
  const std::pair<double, double> roughness[] = {{0.003, 0.003}, {0.1, 0.1}, {0.5, 0.5}, {1, 1}, {0.1, 0.6}};
  for (const auto& [ax, ay] : roughness) {
    const std::string at = " alpha " + std::to_string(ax) + " " + std::to_string(ay);
    const double mean = std::sqrt(ax * ay);
    for (const double gamma : {0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 5.0})
      f("GTR " + std::to_string(gamma) + at, gtr(ax, ay, gamma), ax / mean, ay / mean, 1);
    f("Blinn-Phong" + at, blinn_phong_facets(ax, ay), ax / mean, ay / mean, 1);
    for (const double gamma : {2.0, 3.0, 10.0, 40.0})
      f("STD " + std::to_string(gamma) + at, student_t(ax, ay, gamma), ax, ay, 1);
    for (const double p : {0.2, 0.4, 0.7, 1.0, 1.5, 3.0, 5.0})
      f("EPD " + std::to_string(p) + at, exponential_power(ax, ay, p), ax, ay, 1);
  }
  for (const double alpha : {2e-5, 1e-3, 0.05, 0.8})
    for (const double p : {0.0, 0.5, 1.0, 1.7})
      f("SGD " + std::to_string(alpha) + " " + std::to_string(p),
        shifted_gamma(alpha, p, shifted_gamma_normalisation(alpha, p)), 1, 1, 1);
  for (const double B : {0.5, 30.0, 1e4, 5e6})
    for (const double C : {0.05, 0.5, 1.0, 1.7, 2.0, 2.7})
      f("ABC " + std::to_string(B) + " " + std::to_string(C), abc(abc_normalisation(B, C), B, C), 1, 1, 1);
}

TEST(Distributions, ProjectedAreaIsOne) {
  for_each_distribution([](const std::string& name, const auto& d, double x, double y, double area) {
    EXPECT_NEAR(integrate_facets(d, x, y, {0, 0, 1}, [](const Vec3d& wm) { return wm.z; }), area, 2e-4)
        << name;
  });
}

// Heitz 2014, eq. 14: cos_o is the integral of G1 <wo, wm> D, so Smith's lambda_cos is the rest of the
// facets' projected area.
TEST(Distributions, VisibleProjectedAreaIsConserved) {
  double worst = 0;
  for_each_distribution([&](const std::string& name, const auto& d, double x, double y, double) {
    for (const double theta : {0.0, 0.3, 1.0, 1.4, 1.55, 1.5707}) {
      const Vec3d wo = spherical_direction(theta, 0.7);
      const double area = integrate_facets(d, x, y, wo, [&](const Vec3d& wm) { return dot(wo, wm); });
      const double ours = wo.z + d.lambda_cos(wo);
      EXPECT_NEAR(ours, area, 1e-3 * area) << name << " theta " << theta;
      worst = std::max(worst, std::abs(ours / area - 1));
    }
  });
}

// Below gamma = 2 slopes reach so far that only their marginal, Student's t again, can be integrated to its
// end: lambda_cos = integral of (s p - z) P2(p) over p > z / s, here with p = width / v.
TEST(StudentT, MaskingOfLongTailsIsTheIntegralOfTheMarginal) {
  for (const double gamma : {1.55, 1.6, 1.8, 2.5})
    for (const double alpha : {0.01, 0.7})
      for (const double theta : {0.2, 0.9, 1.5, 1.5707}) {
        const Vec3d w = spherical_direction(theta, 0.0);
        const double width = alpha * std::sqrt(gamma - 1), start = w.z / w.x;
        const double peak =
            std::tgamma(gamma - 0.5) / std::tgamma(gamma) * (gamma - 1) / std::sqrt(pi) / width;
        const auto f = [&](double x) { // p = start + width (x^-5 - 1): the tail as a power of x
          const double p = start + width * (std::pow(x, -12) - 1);
          return (w.x * p - w.z) * peak * std::pow(1 + sqr(p / width), 0.5 - gamma) * width * 12 *
                 std::pow(x, -13);
        };
        const double area = integrate_adaptive(f, 1e-9, 1, {.absolute = 1e-9, .relative = 1e-7}).value;
        EXPECT_NEAR(student_t(alpha, alpha, gamma).lambda_cos(w), area, 1e-5 * (area + w.z))
            << gamma << " " << alpha << " " << theta;
      }
}

} // namespace
} // namespace nacre
