#include "optics/fresnel_approximations.h"

#include "core/dual.h"
#include "core/quadrature.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

template <class F>
double mean(F fresnel) {
  return integrate(gauss_legendre(200, 0, 1), [&](double mu) { return 2 * mu * fresnel(mu); });
}

TEST(CookTorranceFresnel, EqualsTheExactEquations) {
  for (const double eta : {0.5, 0.9, 1.0, 1.1, 1.5, 2.4, 10.0})
    for (const double c : {1.0, 0.9, 0.5, 0.1, 1e-3, 0.0})
      EXPECT_NEAR(fresnel_cook_torrance(c, eta), fresnel_dielectric(c, eta).reflectance, 1e-12)
          << eta << " " << c;
}

TEST(Schlick, NaiveFormReflectsFromEqualIndicesAndTheCorrectedOnesDoNot) {
  for (const double c : {1.0, 0.7, 0.3, 0.05, 0.0}) {
    EXPECT_NEAR(fresnel_schlick(c, 0.0), std::pow(1 - c, 5), 1e-15) << c; // the flaw
    EXPECT_EQ(fresnel_schlick_vanishing(c, 0.0), 0) << c;
    EXPECT_EQ(fresnel_schlick_dielectric(c, 1.0), 0) << c;
  }
  EXPECT_EQ(fresnel_schlick_vanishing(0.3, 0.04), fresnel_schlick(0.3, 0.04)); // from 2 % on they are one
}

TEST(Schlick, DielectricFormIsNearTheExactOneFromBothSides) {
  double worst = 0;
  for (const double eta : {1.4, 1.5, 1.8, 1 / 1.4, 1 / 1.5, 1 / 1.8})
    for (double c = 0; c <= 1; c += 0.01)
      worst = std::max(worst,
                       std::abs(fresnel_schlick_dielectric(c, eta) - fresnel_dielectric(c, eta).reflectance));
  EXPECT_LT(worst, 0.05) << worst;
  EXPECT_EQ(fresnel_schlick_dielectric(0.2, 1 / 1.5), 1);
}

TEST(Schlick, HasF0AtNormalAndF90AtGrazing) {
  EXPECT_NEAR(fresnel_schlick(1.0, 0.3, 0.8), 0.3, 1e-15);
  EXPECT_NEAR(fresnel_schlick(0.0, 0.3, 0.8), 0.8, 1e-15);
}

TEST(FresnelMeans, MatchQuadrature) {
  for (const double f0 : {0.0, 0.04, 0.5, 0.9, 1.0}) {
    EXPECT_NEAR(fresnel_schlick_average(f0), mean([&](double mu) { return fresnel_schlick(mu, f0); }), 1e-9);
    EXPECT_NEAR(fresnel_schlick_average(f0, 0.2),
                mean([&](double mu) { return fresnel_schlick(mu, f0, 0.2); }), 1e-9);
    for (const double tint : {0.0, 0.4, 1.0})
      EXPECT_NEAR(fresnel_f82_tint_average(f0, tint),
                  mean([&](double mu) { return fresnel_f82_tint(mu, f0, tint); }), 1e-9);
  }
}

TEST(FresnelMeans, FitOfDielectricsIsWithinItsError) {
  double outside = 0, inside = 0;
  for (double eta = 1.05; eta <= 3; eta += 0.01) {
    outside = std::max(
        outside, std::abs(fresnel_dielectric_average_fit(eta) - fresnel_dielectric_average_outside(eta)));
    inside = std::max(
        inside, std::abs(fresnel_dielectric_average_fit(1 / eta) - fresnel_dielectric_average_inside(eta)));
  }
  RecordProperty("outside", std::to_string(outside));
  RecordProperty("inside", std::to_string(inside));
  EXPECT_LT(outside, 0.007) << outside;
  EXPECT_LT(inside, 0.001) << inside;
  EXPECT_EQ(fresnel_dielectric_average_fit(1.0), 0);
}

TEST(Lazanyi, WithoutItsErrorTermIsSchlickOfTheMetal) {
  for (const auto& [eta, k] : {std::pair{0.2, 3.4}, {1.5, 7.6}, {3.0, 3.0}})
    for (const double c : {1.0, 0.6, 0.1, 0.0})
      EXPECT_NEAR(fresnel_lazanyi(c, eta, k, 0.0, 6.0), fresnel_schlick(c, fresnel_conductor(1.0, eta, k)),
                  1e-12);
}

TEST(Lazanyi, ErrorTermBringsAluminiumCloserThanSchlick) {
  const double eta = 1.1, k = 6.7, f0 = fresnel_conductor(1.0, eta, k); // aluminium near 590 nm
  // a from the true value where the term of that exponent is deepest
  const double a = (fresnel_schlick(1.0 / 7, f0) - fresnel_conductor(1.0 / 7, eta, k)) / f82_weight;
  double with = 0, without = 0;
  for (double c = 0; c <= 1; c += 0.01) {
    const double exact = fresnel_conductor(c, eta, k);
    with = std::max(with, std::abs(fresnel_lazanyi(c, eta, k, a, 6.0) - exact));
    without = std::max(without, std::abs(fresnel_schlick(c, f0) - exact));
  }
  EXPECT_LT(with, 0.5 * without) << with << " " << without;
}

TEST(HoffmanFresnel, IsLazanyisTermThroughTheValueAt82Degrees) {
  EXPECT_NEAR(std::acos(f82_cosine) * 180 / pi, 81.79, 0.01);
  for (const double c : {1.0, 0.5, 1.0 / 7, 0.02, 0.0}) {
    const double f0 = 0.9, f82 = 0.7;
    // constants of Hoffman 2019 as the field quotes them
    const double a = 17.6513846 * (f0 - f82) + 8.16666667 * (1 - f0);
    EXPECT_NEAR(fresnel_hoffman(c, f0, f82), fresnel_schlick(c, f0) - a * c * std::pow(1 - c, 6), 1e-8);
  }
  EXPECT_NEAR(fresnel_hoffman(f82_cosine, 0.9, 0.7), 0.7, 1e-14);
}

TEST(F82Tint, IsSchlickForWhiteAndStaysInRangeForMetals) {
  for (const double f0 : {0.1, 0.4, 1.0})
    for (double c = 0; c <= 1; c += 0.02) {
      EXPECT_NEAR(fresnel_f82_tint(c, f0, 1.0), fresnel_schlick(c, f0), 1e-14);
      for (const double tint : {0.25, 0.5}) {
        const double f = fresnel_f82_tint(c, f0, tint);
        EXPECT_TRUE(f >= -1e-12 && f <= 1) << f0 << " " << tint << " " << c << ": " << f;
      }
    }
}

TEST(F82Tint, FallsBelowZeroForDarkTintsOfDarkColours) {
  EXPECT_NEAR(fresnel_f82_tint(0.26, 0.0, 0.0), -0.1268, 1e-3); // as published, not clamped
}

TEST(Gulbrandsen, ThereAndBack) {
  for (const double r : {0.05, 0.5, 0.9, 0.99})
    for (const double g : {0.0, 0.3, 1.0}) {
      const auto index = complex_index(ArtisticMetal<double>{r, g});
      EXPECT_NEAR(fresnel_conductor(1.0, index.eta, index.k), r, 1e-9);
      const auto back = artistic_metal(index);
      EXPECT_NEAR(back.r, r, 1e-9);
      EXPECT_NEAR(back.g, g, 1e-6) << r;
    }
  EXPECT_NEAR(complex_index(ArtisticMetal<double>{0.04, 0}).eta, 1.5, 1e-12); // no absorption: a dielectric
  EXPECT_NEAR(complex_index(ArtisticMetal<double>{0.04, 0}).k, 0, 1e-7);
}

TEST(FresnelApproximations, HaveFiniteDerivativesInEveryCorner) {
  using D = Dual<double, 2>;
  for (const double c : {0.0, 1e-20, 1e-6, 0.5, 1.0})
    for (const double a : {0.0, 1e-9, 0.5, 1.0})
      for (const double b : {0.0, 0.5, 1.0}) {
        const D mu(c), x = D::variable(a, 0), y = D::variable(b, 1);
        const auto index = complex_index(ArtisticMetal<D>{x, y});
        const auto artistic = artistic_metal(ComplexIndex<D>{D(0.1) + x, y});
        for (const D& f :
             {fresnel_schlick(mu, x, y), fresnel_schlick_vanishing(mu, x), fresnel_hoffman(mu, x, y),
              fresnel_f82_tint(mu, x, y), fresnel_f82_tint_average(x, y), index.eta, index.k, artistic.r,
              artistic.g, fresnel_lazanyi(mu, D(D(0.1) + x), y, y, D(D(1) + x)),
              fresnel_cook_torrance(mu, D(D(0.5) + x)), fresnel_schlick_dielectric(mu, D(D(0.5) + x)),
              fresnel_dielectric_average_fit(D(D(0.5) + x))})
          EXPECT_TRUE(isfinite(f)) << c << " " << a << " " << b << ": " << f.v << " " << f.d[0] << " "
                                   << f.d[1];
      }
}

} // namespace
} // namespace nacre
