#include "optics/fresnel.h"

#include "core/dual.h"
#include "core/pack.h"
#include "core/quadrature.h"
#include "optics/fresnel_amplitudes.h"

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

TEST(FresnelAverage, QuadratureIsWithinItsError) {
  double metal = 0, glass = 0;
  const QuadratureRule rule = composite_gauss_legendre(40, 10, 0, 1);
  for (const double eta : {0.05, 0.2, 1.0, 3.0, 5.0})
    for (const double k : {1.0, 3.0, 6.0, 10.0}) {
      const double exact =
          integrate(rule, [&](double x) { return 4 * x * x * x * fresnel_conductor(x * x, eta, k); });
      metal = std::max(metal, std::abs(fresnel_conductor_average(eta, k) - exact));
    }
  for (const double eta : {1.1, 1.3, 1.5, 2.0, 3.0})
    glass = std::max(glass, std::abs(fresnel_average<double>(
                                         [&](double mu) { return fresnel_dielectric(mu, eta).reflectance; }) -
                                     fresnel_dielectric_average_outside(eta)));
  EXPECT_LT(metal, 1e-4) << metal;
  EXPECT_LT(glass, 1e-4) << glass;
}

TEST(PolarizedReflectance, AveragesToTheUnpolarisedOneAndMatchesAmplitudes) {
  for (const double c : {1.0, 0.7, 0.2, 1e-3}) {
    for (const double eta : {1.5, 2.4, 1 / 1.5}) {
      const auto r = fresnel_dielectric_polarized(c, eta);
      EXPECT_NEAR(r.unpolarized(), fresnel_dielectric(c, eta).reflectance, 1e-15);
      const auto amplitudes = fresnel_amplitudes(c, eta).reflectance();
      EXPECT_NEAR(r.s, amplitudes.s, 1e-12) << c << " " << eta;
      EXPECT_NEAR(r.p, amplitudes.p, 1e-12) << c << " " << eta;
    }
    for (const double k : {0.5, 3.4, 9.0}) {
      const auto r = fresnel_conductor_polarized(c, 0.3, k),
                 amplitudes = fresnel_amplitudes(c, 0.3, k).reflectance();
      EXPECT_NEAR(r.s, amplitudes.s, 1e-12) << c << " " << k;
      EXPECT_NEAR(r.p, amplitudes.p, 1e-12) << c << " " << k;
    }
  }
  EXPECT_NEAR(fresnel_dielectric_polarized(std::cos(std::atan(1.5)), 1.5).p, 0, 1e-30); // Brewster
  const auto total = fresnel_dielectric_polarized(-0.3, 1.5);
  EXPECT_EQ(total.s, 1);
  EXPECT_EQ(total.p, 1);
}

TEST(PolarizedReflectance, OfAMetalInADielectricTakesTheRelativeIndex) {
  const double outside = 1.5, eta = 0.2, k = 3.4;
  const std::complex<double> n(eta, k);
  const double sine = 0.6, c = 0.8; // inside the dielectric
  const auto ct = std::sqrt(1.0 - std::pow(outside * sine / n, 2));
  const auto r_s = (outside * c - n * ct) / (outside * c + n * ct),
             r_p = (n * c - outside * ct) / (n * c + outside * ct);
  const auto r = fresnel_conductor_polarized(c, eta / outside, k / outside);
  EXPECT_NEAR(r.s, std::norm(r_s), 1e-12);
  EXPECT_NEAR(r.p, std::norm(r_p), 1e-12);
}

TEST(FresnelAmplitudes, MatchComplexArithmetic) {
  for (const double eta : {0.3, 0.66, 1.0, 1.5, 4.0})
    for (const double k : {0.0, 0.7, 5.0})
      for (const double c : {1.0, 0.6, 0.05}) {
        const std::complex<double> n(eta, k);
        auto q = std::sqrt(n * n - (1 - c * c));
        if (q.imag() < 0) q = -q;
        const std::complex<double> expected[] = {(c - q) / (c + q), (n * n * c - q) / (n * n * c + q),
                                                 2 * c / (c + q), 2.0 * n * c / (n * n * c + q)};
        const auto a = fresnel_amplitudes(c, eta, k);
        int i = 0;
        for (const Complex<double>& z : {a.r_s, a.r_p, a.t_s, a.t_p}) {
          EXPECT_NEAR(z.re, expected[i].real(), 1e-12) << eta << " " << k << " " << c << " " << i;
          EXPECT_NEAR(z.im, expected[i].imag(), 1e-12) << eta << " " << k << " " << c << " " << i;
          ++i;
        }
        EXPECT_NEAR(a.t_s.re, 1 + a.r_s.re, 1e-12); // Es is continuous across the interface
        EXPECT_NEAR(a.t_s.im, a.r_s.im, 1e-12);
      }
}

TEST(FresnelAmplitudes, HaveOppositeSignsAtNormalIncidence) {
  const auto a = fresnel_amplitudes(1.0, 1.5);
  EXPECT_NEAR(a.r_s.re, -0.2, 1e-15);
  EXPECT_NEAR(a.r_p.re, 0.2, 1e-15);
  const auto real = dielectric_amplitudes(1.0, 1.5);
  EXPECT_NEAR(real.s, -0.2, 1e-15);
  EXPECT_NEAR(real.p, 0.2, 1e-15);
}

TEST(TotalReflection, PhaseIsThatOfTheAmplitudes) {
  for (const double eta : {1 / 1.51, 0.5})
    for (const double c : {0.7, 0.5, 0.2, 0.01}) {
      const auto a = fresnel_amplitudes(c, eta);
      const auto phase = total_reflection_phase(c, eta);
      if (1 - c * c < eta * eta) {
        EXPECT_EQ(phase.s, 0);
        EXPECT_EQ(phase.p, 0);
        continue;
      }
      EXPECT_NEAR(phase.s, std::atan2(a.r_s.im, a.r_s.re), 1e-12);
      EXPECT_NEAR(phase.p, std::atan2(a.r_p.im, a.r_p.re), 1e-12);
    }
}

TEST(TotalReflection, FresnelsRhombOfGlass151Retards45DegreesAtHisAngles) {
  // Born and Wolf, section 1.5.4: at n = 1.51, incidence of 48 deg 37' or 54 deg 37' gives 45 degrees.
  for (const double degrees : {48 + 37 / 60.0, 54 + 37 / 60.0}) {
    const double c = std::cos(degrees * pi / 180);
    EXPECT_NEAR(total_reflection_phase(c, 1 / 1.51).relative() * 180 / pi, 45, 0.02) << degrees;
  }
  // and 51 deg 20' the largest, 45 deg 56'
  EXPECT_NEAR(total_reflection_phase(std::cos((51 + 20 / 60.0) * pi / 180), 1 / 1.51).relative() * 180 / pi,
              45 + 56 / 60.0, 0.02);
}

TEST(FresnelAmplitudes, HaveFiniteDerivativesInEveryCorner) {
  using D = Dual<double, 3>;
  for (const double c : {0.0, 1e-20, 0.3, std::sqrt(0.75), 1.0})
    for (const double eta : {0.01, 0.5, 1.0, 1.5})
      for (const double k : {0.0, 1e-9, 3.0}) {
        const auto a = fresnel_amplitudes(D::variable(c, 0), D::variable(eta, 1), D::variable(k, 2));
        for (const Complex<D>& z : {a.r_s, a.r_p, a.t_s, a.t_p})
          EXPECT_TRUE(isfinite(z.re) && isfinite(z.im)) << c << " " << eta << " " << k;
        const auto phase = total_reflection_phase(D::variable(c, 0), D::variable(eta, 1));
        EXPECT_TRUE(isfinite(phase.s) && isfinite(phase.p)) << c << " " << eta;
      }
}

TEST(FresnelAmplitudes, AreTheSameInPacks) {
  const auto pack = fresnel_amplitudes(Pack(0.3f), Pack(0.66f), Pack(0.0f));
  const auto exact = fresnel_amplitudes(0.3, 0.66, 0.0);
  EXPECT_NEAR(lane(pack.r_p.re, 1), exact.r_p.re, 1e-6);
  EXPECT_NEAR(lane(pack.r_p.im, 1), exact.r_p.im, 1e-6);
  EXPECT_NEAR(lane(total_reflection_phase(Pack(0.3f), Pack(0.66f)).p, 0), total_reflection_phase(0.3, 0.66).p,
              1e-6);
}

} // namespace
} // namespace nacre
