#include "optics/ggx_albedo.h"

#include "core/quadrature.h"
#include "optics/fresnel.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

/// Independent of the tables' sampling of visible normals: the integral of D G2 F / (4 cos_o) over half
/// vectors, tan^2(theta_m) spread as D cos is. f(c) is a Fresnel term.
template <class Fresnel>
double reflected(double cos_theta, double alpha, Fresnel f) {
  const Ggx<double> d{alpha, alpha};
  const Vec3d wo{std::sqrt(1 - cos_theta * cos_theta), 0, cos_theta};
  const int n_phi = 300;
  return integrate(composite_gauss_legendre(8, 50, 0, 1), [&](double u) {
    const double tan2 = alpha * alpha * u / (1 - u), cm = 1 / std::sqrt(1 + tan2);
    const double sm = std::sqrt(1 - cm * cm);
    double sum = 0;
    for (int i = 0; i < n_phi; ++i) {
      const double phi = pi * (i + 0.5) / n_phi;
      const Vec3d wm{sm * std::cos(phi), sm * std::sin(phi), cm}, wi = reflect(wo, wm);
      const double c = dot(wo, wm);
      if (c > 0 && wi.z > 0) sum += f(c) * 4 * visibility(d, wo, wi, 0.0) * wi.z * c / cm;
    }
    return sum / n_phi;
  });
}

TEST(GgxAlbedo, AgreesWithQuadratureOverHalfVectors) {
  double total = 0;
  int count = 0;
  for (const double c : {0.02, 0.05, 0.13, 0.3, 0.55, 0.8, 1.0})
    for (const double alpha : {0.01, 0.033, 0.11, 0.27, 0.46, 1.0}) {
      const auto parts = GgxAlbedo::table().reflector(c, alpha);
      const auto check = [&](double table, auto fresnel) {
        const double error = std::abs(table - reflected(c, alpha, fresnel));
        EXPECT_LT(error, c > 0.2 || alpha > 0.2 ? 2.5e-3 : 0.012) << c << " " << alpha;
        total += error, ++count;
      };
      check(parts.one, [](double) { return 1.0; });
      check(parts.five, [](double x) { return sqr(sqr(1 - x)) * (1 - x); });
      check(parts.six, [](double x) { return x * sqr(1 - x) * sqr(sqr(1 - x)); });
      for (const double eta : {1.07, 1.5, 3.7})
        check(GgxAlbedo::table().dielectric_reflection(c, alpha, eta),
              [&](double x) { return fresnel_dielectric(x, eta).reflectance; });
    }
  EXPECT_LT(total / count, 6e-4);
}

TEST(GgxAlbedo, ASmoothSurfaceHasFresnelsReflectance) {
  for (const double c : {0.2, 0.5, 0.9, 1.0}) {
    EXPECT_NEAR(GgxAlbedo::table().perfect(c, 1e-3), 1, 1e-3);
    for (const double eta : {1.2, 1.5, 3.0}) {
      const double F = fresnel_dielectric(c, eta).reflectance;
      EXPECT_NEAR(GgxAlbedo::table().dielectric_reflection(c, 1e-3, eta), F, 2e-3);
      EXPECT_NEAR(GgxAlbedo::table().dielectric_transmission(c, 1e-3, eta), 1 - F, 2e-3);
    }
  }
}

TEST(GgxAlbedo, SchlickIsLinearInItsParts) {
  const double f0 = 0.3, f90 = 0.8;
  EXPECT_NEAR(GgxAlbedo::table().reflector(0.4, 0.5).schlick(f0, f90),
              reflected(0.4, 0.5, [&](double c) { return f0 + (f90 - f0) * std::pow(1 - c, 5); }), 4e-4);
}

TEST(GgxAlbedo, AveragesAreHemispherical) {
  const QuadratureRule rule = composite_gauss_legendre(4, 40, 0, 1);
  const GgxAlbedo& t = GgxAlbedo::table();
  for (const double alpha : {0.05, 0.4, 1.0}) {
    EXPECT_NEAR(t.reflector_average(alpha).one,
                integrate(rule, [&](double c) { return 2 * c * t.perfect(c, alpha); }), 1e-4);
    EXPECT_NEAR(t.reflector_average(alpha).five,
                integrate(rule, [&](double c) { return 2 * c * t.reflector(c, alpha).five; }), 1e-4);
    EXPECT_NEAR(t.dielectric_reflection_average(alpha, 1.5),
                integrate(rule, [&](double c) { return 2 * c * t.dielectric_reflection(c, alpha, 1.5); }),
                1e-4);
  }
  // Walsh 1926, exact for polished glass of index 1.5: 9.18 % from outside, 59.6 % from inside
  EXPECT_NEAR(t.dielectric_reflection_average(1e-3, 1.5), 0.0918, 1e-3);
  EXPECT_NEAR(t.dielectric_reflection_average(1e-3, 1 / 1.5), fresnel_dielectric_average_inside(1.5), 4e-3);
}

TEST(GgxAlbedo, NothingIsGainedAndEqualIndicesReflectNothing) {
  const GgxAlbedo& t = GgxAlbedo::table();
  for (double c = 0.05; c <= 1; c += 0.05)
    for (double alpha = 0; alpha <= 1; alpha += 0.1) {
      EXPECT_NEAR(t.dielectric_reflection(c, alpha, 1.0), 0, 1e-6);
      for (const double eta : {0.25, 0.7, 1.0, 1.5, 4.0}) {
        const double sum = t.dielectric_reflection(c, alpha, eta) + t.dielectric_transmission(c, alpha, eta);
        EXPECT_LE(sum, 1.002) << c << " " << alpha << " " << eta;
        EXPECT_GT(sum, c > 0.3 ? 0.3 : 0.05);
      }
    }
}

TEST(GgxAlbedo, DerivativesAreSlopes) {
  using D = Dual<double, 2>;
  const GgxAlbedo& t = GgxAlbedo::table();
  const double alpha = 0.37, eta = 1.43, h = 1e-6;
  const D e = t.dielectric_reflection(D(0.41), D::variable(alpha, 0), D::variable(eta, 1));
  const auto at = [&](double a, double n) { return t.dielectric_reflection(0.41, a, n); };
  EXPECT_NEAR(e.d[0], (at(alpha + h, eta) - at(alpha - h, eta)) / (2 * h), 1e-6);
  EXPECT_NEAR(e.d[1], (at(alpha, eta + h) - at(alpha, eta - h)) / (2 * h), 1e-6);
}

} // namespace
} // namespace nacre
