#include "optics/mueller.h"

#include "core/dual.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

double difference(const Mueller<double>& a, const Mueller<double>& b) {
  double worst = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      worst = std::max(worst, std::abs(a.rows[i][j] - b.rows[i][j]));
  return worst;
}
double radians(double degrees) { return degrees * pi / 180; }

TEST(Mueller, UnpolarisedReflectanceIsFresnels) {
  for (const double c : {1.0, 0.6, 0.1}) {
    EXPECT_NEAR(mueller_reflection(c, 1.5).rows[0][0], fresnel_dielectric(c, 1.5).reflectance, 1e-14);
    EXPECT_NEAR(mueller_reflection(c, 0.2, 3.4).rows[0][0], fresnel_conductor(c, 0.2, 3.4), 1e-12);
  }
}

TEST(Mueller, ReflectionAndRefractionKeepTheEnergyOfEveryPolarisation) {
  for (const double eta : {1.5, 1 / 1.5, 2.4})
    for (const double c : {1.0, 0.8, 0.3, 0.01})
      for (const Stokes<double>& light : {Stokes<double>{1, 0, 0, 0},
                                          {1, 1, 0, 0},
                                          {1, -1, 0, 0},
                                          {1, 0, 0.6, 0.8},
                                          {1, 0.48, -0.6, 0.64}}) {
        const auto r = mueller_reflection(c, eta) * light, t = mueller_refraction(c, eta) * light;
        EXPECT_NEAR(r[0] + t[0], 1, 1e-12) << eta << " " << c;
      }
}

TEST(Mueller, FullyPolarisedLightStaysSo) {
  for (const double k : {0.0, 3.0})
    for (const double c : {0.9, 0.4}) {
      const auto r = mueller_reflection(c, 1.4, k) * Stokes<double>{1, 0.48, -0.6, 0.64};
      EXPECT_NEAR(r[0] * r[0], r[1] * r[1] + r[2] * r[2] + r[3] * r[3], 1e-14);
    }
}

TEST(Mueller, BrewstersAnglePolarisesFully) {
  const auto r = mueller_reflection(std::cos(std::atan(1.5)), 1.5) * Stokes<double>{1, 0, 0, 0};
  EXPECT_NEAR(r[1] / r[0], 1, 1e-14); // s alone
  EXPECT_GT(r[0], 0.05);
}

TEST(Mueller, MirrorsTurnHandednessAround) {
  // At normal incidence r_p = -r_s: circular light comes back with the other helicity, U with the other sign.
  const auto r = mueller_reflection(1.0, 0.2, 3.4) * Stokes<double>{1, 0, 0, 1};
  EXPECT_NEAR(r[3] / r[0], -1, 1e-12);
  EXPECT_NEAR(r[2], 0, 1e-12);
}

TEST(Mueller, TotalReflectionIsARetarderOfThePublishedPhase) {
  const double c = std::cos(radians(54 + 37 / 60.0)), eta = 1 / 1.51;
  const auto r = mueller_reflection(c, eta) * Stokes<double>{1, 0, 1, 0};
  EXPECT_NEAR(r[0], 1, 1e-12);
  EXPECT_NEAR(r[1], 0, 1e-12);
  const double delta = total_reflection_phase(c, eta).relative();
  EXPECT_NEAR(r[2], std::cos(delta), 1e-12);
  EXPECT_NEAR(std::abs(r[3]), std::sin(delta), 1e-12);
}

TEST(Mueller, FresnelsRhombMakesCircularLight) {
  const auto once = mueller_reflection(std::cos(radians(54 + 37 / 60.0)), 1 / 1.51);
  const auto r = once * once * Stokes<double>{1, 0, 1, 0};
  EXPECT_NEAR(r[0], 1, 1e-12);
  EXPECT_NEAR(std::abs(r[3]), 1, 1e-5);
  EXPECT_LT(std::hypot(r[1], r[2]), 1e-3);
}

TEST(Mueller, ThereAndBackThroughAnInterfaceLosesTheReflectancesTwice) {
  const double c = 0.6, eta = 1.5, ct = -fresnel_dielectric(c, eta).cos_t;
  const auto both = mueller_refraction(ct, 1 / eta) * mueller_refraction(c, eta);
  const auto r = fresnel_dielectric_polarized(c, eta);
  EXPECT_NEAR(both.rows[0][0] + both.rows[0][1], sqr(1 - r.s), 1e-12);
  EXPECT_NEAR(both.rows[0][0] - both.rows[0][1], sqr(1 - r.p), 1e-12);
}

TEST(Mueller, RotationsComposeAndTurnLinearLight) {
  EXPECT_LT(difference(mueller_rotation(0.3) * mueller_rotation(0.5), mueller_rotation(0.8)), 1e-14);
  EXPECT_LT(difference(mueller_rotation(pi), mueller_rotation(0.0)), 1e-14);
  // Light along s in a frame turned by 45 degrees is halfway, -U; turned by 90 it lies along -p.
  const auto r = mueller_rotation(radians(45)) * Stokes<double>{1, 1, 0, 0};
  EXPECT_NEAR(r[2], -1, 1e-14);
  EXPECT_NEAR((mueller_rotation(radians(90)) * Stokes<double>{1, 1, 0, 0})[1], -1, 1e-14);
}

TEST(Mueller, CrossedPolarisersPassNothing) {
  const auto polariser =
      mueller_of_amplitudes(Complex<double>{1, 0}, Complex<double>{0, 0}); // passes s alone
  const auto crossed = mueller_rotation(radians(-90)) * polariser * mueller_rotation(radians(90)) * polariser;
  EXPECT_NEAR((crossed * Stokes<double>{1, 0, 0, 0})[0], 0, 1e-15);
}

TEST(Mueller, HasFiniteDerivativesInEveryCorner) {
  using D = Dual<double, 3>;
  for (const double c : {0.0, 1e-20, 0.5, 1.0})
    for (const double eta : {0.2, 1.0, 1.5}) {
      const auto r = mueller_reflection(D::variable(c, 0), D::variable(eta, 1), D::variable(0, 2));
      const auto t = mueller_refraction(D::variable(c, 0), D::variable(eta, 1));
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
          EXPECT_TRUE(isfinite(r.rows[i][j]) && isfinite(t.rows[i][j])) << c << " " << eta;
    }
}

} // namespace
} // namespace nacre
