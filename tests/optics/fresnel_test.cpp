#include "optics/fresnel.h"

#include "core/dual.h"
#include "core/quadrature.h"

#include <complex>
#include <gtest/gtest.h>

namespace nacre {
namespace {

TEST(FresnelDielectric, IsKnownAtNormalIncidence) {
  EXPECT_NEAR(fresnel_dielectric(1.0, 1.5).reflectance, 0.04, 1e-12);
  EXPECT_NEAR(fresnel_dielectric(-1.0, 1.5).reflectance, 0.04, 1e-12);
  EXPECT_NEAR(fresnel_dielectric(1.0, 2.42).reflectance, 0.1724, 1e-4);
}

TEST(FresnelDielectric, EqualIndicesReflectNothing) {
  for (const double c : {1.0, 0.5, 0.1, 0.001})
    EXPECT_NEAR(fresnel_dielectric(c, 1.0).reflectance, 0, 1e-12);
}

TEST(FresnelDielectric, EqualIndicesReflectNothingInFloatAtGrazing) {
  // 1 - (1 - c^2) loses c in float: it made total reflection of equal indices below c = 2e-4.
  for (const float c : {1e-2f, 1e-3f, 1e-4f, 1e-5f, -1e-4f})
    EXPECT_LT(fresnel_dielectric(c, 1.0f).reflectance, 1e-6f) << c;
}

TEST(FresnelDielectric, IsOneAtGrazingAndBeyondTheCriticalAngle) {
  EXPECT_EQ(fresnel_dielectric(0.0, 1.5).reflectance, 1);
  EXPECT_NEAR(fresnel_dielectric(1e-9, 1.5).reflectance, 1, 1e-7);
  const double critical = std::sqrt(1 - 1 / (1.5 * 1.5));
  EXPECT_EQ(fresnel_dielectric(-critical * 0.999, 1.5).reflectance, 1);
  EXPECT_LT(fresnel_dielectric(-critical * 1.001, 1.5).reflectance, 1);
}

TEST(FresnelDielectric, ParallelAmplitudeVanishesAtBrewstersAngle) {
  const double eta = 1.5, c = std::cos(std::atan(eta)), ct = -fresnel_dielectric(c, eta).cos_t;
  const double r_s = (c - eta * ct) / (c + eta * ct);
  EXPECT_NEAR(fresnel_dielectric(c, eta).reflectance, 0.5 * r_s * r_s, 1e-15);
}

TEST(FresnelDielectric, IsTheSameFromBothSidesOfARefractedRay) {
  for (const double c : {0.9, 0.5, 0.1}) {
    const auto outside = fresnel_dielectric(c, 1.7);
    const auto inside = fresnel_dielectric(outside.cos_t, 1.7);
    EXPECT_NEAR(outside.reflectance, inside.reflectance, 1e-12);
    EXPECT_NEAR(inside.cos_t, c, 1e-12);
  }
}

TEST(FresnelConductor, MatchesComplexArithmetic) {
  for (const double eta : {0.05, 0.2, 1.0, 3.0})
    for (const double k : {0.0, 0.5, 3.4, 9.0})
      for (const double c : {1.0, 0.8, 0.3, 0.01}) {
        const std::complex<double> n(eta, k), ct = std::sqrt(1.0 - (1 - c * c) / (n * n));
        const auto r_s = (c - n * ct) / (c + n * ct), r_p = (n * c - ct) / (n * c + ct);
        EXPECT_NEAR(fresnel_conductor(c, eta, k), 0.5 * (std::norm(r_s) + std::norm(r_p)), 1e-10)
            << eta << " " << k << " " << c;
      }
}

TEST(FresnelConductor, AbsorptionOfGoodMetalsKeepsItsDigitsInFloat) {
  for (const auto& [eta, k] : {std::pair{0.01, 30.0}, {0.02, 10.0}, {0.05, 4.0}, {0.14, 4.0}})
    for (const double c : {1.0, 0.3, 0.05}) {
      const double exact = 1 - fresnel_conductor(c, eta, k);
      // The rounding of 1 - F itself is 6e-8, that of F some times as much.
      EXPECT_NEAR(1 - fresnel_conductor(float(c), float(eta), float(k)), exact, 3e-7) << eta << " " << c;
      const auto slope = fresnel_conductor(Dual<float, 1>(float(c)), Dual<float, 1>::variable(float(eta), 0),
                                           Dual<float, 1>(float(k)))
                             .d[0];
      EXPECT_NEAR(slope / (-exact / eta), 1, 0.1) << eta << " " << c; // 1 - F is nearly proportional to eta
      const auto reference =
          fresnel_conductor(Dual<double, 1>(c), Dual<double, 1>::variable(eta, 0), Dual<double, 1>(k)).d[0];
      EXPECT_NEAR(slope / reference, 1, 1e-4) << eta << " " << k << " " << c;
    }
}

TEST(FresnelConductor, EqualIndicesWithoutAbsorptionReflectNothing) {
  for (const float c : {1.0f, 1e-2f, 1e-4f, 0.0f})
    EXPECT_LT(fresnel_conductor(c, 1.0f, 0.0f), 1e-6f) << c;
}

TEST(FresnelConductor, IndexZeroIsTheIdealMirror) {
  for (const float c : {1.0f, 0.5f, 1e-3f, 0.0f})
    EXPECT_EQ(fresnel_conductor(c, 0.0f, 1.0f), 1) << c;
}

TEST(FresnelConductor, IsKnownAtNormalIncidence) {
  const double n = 0.27, k = 2.95;
  EXPECT_NEAR(fresnel_conductor(1.0, n, k), ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k), 1e-12);
}

TEST(FresnelSchlick, ReflectsAtGrazingEvenWithEqualIndices) {
  EXPECT_NEAR(fresnel_schlick(0.2, 0.0), std::pow(0.8, 5), 1e-12); // the known flaw of the naive form
  EXPECT_NEAR(fresnel_schlick(1.0, 0.3), 0.3, 1e-12);
  EXPECT_NEAR(fresnel_schlick(0.0, 0.3), 1, 1e-12);
}

TEST(FresnelAverage, MatchesQuadratureOfTheInnerSide) {
  for (const double eta : {1.05, 1.3, 1.5, 1.9, 2.5}) {
    // outside, where Fresnel is smooth; the inner side follows from (1 - F_in) eta^2 = 1 - F_out
    const QuadratureRule rule = gauss_legendre(200, 0, 1);
    double outer = 0;
    for (std::size_t i = 0; i < rule.node.size(); ++i)
      outer += rule.weight[i] * 2 * rule.node[i] * fresnel_dielectric(rule.node[i], eta).reflectance;
    EXPECT_NEAR(fresnel_dielectric_average_inside(eta), 1 - (1 - outer) / (eta * eta), 1e-6) << eta;
    EXPECT_NEAR(fresnel_dielectric_average_inside(float(eta)), fresnel_dielectric_average_inside(eta), 1e-3)
        << eta;
  }
}

} // namespace
} // namespace nacre
