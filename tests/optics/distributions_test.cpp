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

/// Normals sampled for a view are counted in bins of slope and azimuth (stretched) and held against the
/// stated density; returns chi-square per degree of freedom.
template <class Distribution>
double chi_square(const Distribution& d, double x, double y, const Vec3d& wo, bool visible) {
  constexpr int rings = 12, sectors = 8, samples = 40000;
  const auto ring = [&](const Vec3d& wm) { // log slope from 0.02 to 50 in units of the stretch
    const double r = std::hypot(wm.x / x, wm.y / y) / wm.z;
    return std::clamp(int((std::log(r) + 4) / 8 * (rings - 2)) + 1, 0, rings - 1);
  };
  std::array<double, rings * sectors> expected{}, counted{};
  const double steps = 40;
  for (double i = 0.5; i < 2 * rings * steps; ++i)
    for (double j = 0.5; j < sectors * 16; ++j) {
      const double log_r = -12 + 24 * i / (2 * rings * steps), phi = 2 * pi * j / (sectors * 16),
                   r = std::exp(log_r);
      const Vec3d wm = normalize(Vec3d{x * r * std::cos(phi), y * r * std::sin(phi), 1});
      const double c = std::max(0.0, dot(wo, wm));
      const double density =
          visible ? d.visible_density(wo, wm) * c : d.visible_density({0, 0, 1}, wm) * wm.z;
      const double area =
          24 / (2 * rings * steps) * 2 * pi / (sectors * 16) * x * y * r * r * std::pow(wm.z, 3);
      expected[std::size_t(ring(wm) * sectors + int(j) / 16)] += samples * density * area;
    }
  for (int n = 0; n < samples; ++n) {
    const Vec2<double> u{unit_double(hash(3, n, 0)), unit_double(hash(3, n, 1))};
    const Vec3d wm = visible ? d.sample_visible(wo, u) : d.sample_normal(u);
    const double phi = std::atan2(wm.y / y, wm.x / x) + (wm.y < 0 ? 2 * pi : 0);
    counted[std::size_t(ring(wm) * sectors + std::clamp(int(phi / (2 * pi) * sectors), 0, sectors - 1))] += 1;
  }
  double sum = 0, total = 0;
  int bins = 0;
  for (std::size_t b = 0; b < expected.size(); ++b) {
    total += expected[b];
    if (expected[b] > 20) sum += sqr(counted[b] - expected[b]) / expected[b], ++bins;
  }
  EXPECT_NEAR(total, samples, 0.003 * samples);
  return sum / bins;
}

TEST(Distributions, SamplesFollowTheStatedDensity) {
  const auto check = [](const std::string& name, const auto& d, double x, double y) {
    // 1.6: beyond 4 standard deviations of 80 bins' mean
    EXPECT_LT(chi_square(d, x, y, {0, 0, 1}, false), 1.6) << name << " normals";
    for (const double theta : {0.0, 0.5, 1.3, 1.55})
      EXPECT_LT(chi_square(d, x, y, spherical_direction(theta, 0.7), true), 1.6)
          << name << " theta " << theta;
  };
  check("GTR 0.5", gtr(0.3, 0.3, 0.5), 0.3, 0.3);
  check("GTR 1", gtr(0.3, 0.3, 1.0), 0.3, 0.3);
  check("GTR 2.5", gtr(0.2, 0.6, 2.5), 0.2, 0.6);
  check("Blinn-Phong", blinn_phong_facets(0.2, 0.6), 0.2, 0.6);
  check("STD 1.8", student_t(0.1, 0.3, 1.8), 0.1, 0.3);
  check("EPD 0.3", exponential_power(0.01, 0.02, 0.3), 0.3, 0.6);
  check("EPD 0.8", exponential_power(0.3, 0.6, 0.8), 0.3, 0.6);
  check("EPD 3", exponential_power(0.3, 0.6, 3.0), 0.3, 0.6);
  check("SGD", shifted_gamma(0.05, 0.5, 1.0), 0.2, 0.2);
  check("SGD", shifted_gamma(0.1, 1.5, 1.0), 0.2, 0.2);
  check("ABC", abc(1.0, 300.0, 1.3), 0.2, 0.2);
  check("ABC", abc(1.0, 30.0, 0.3), 0.5, 0.5);
}

TEST(Distributions, FamiliesMeetAtTheirCommonMembers) {
  for (int n = 0; n < 100; ++n) {
    const auto u = [&](int k) { return unit_double(hash(9, n, k)); };
    const Vec3d w = spherical_direction(1.5 * u(0), 6 * u(1));
    const double ax = 0.1 + 0.9 * u(2), ay = 0.1 + 0.9 * u(3);
    const Ggx<double> ggx{ax, ay};
    const Beckmann<double> beckmann{ax, ay};
    const auto expect_same = [&](const auto& a, const auto& b, const char* name, double tolerance) {
      EXPECT_NEAR(a.D(w), b.D(w), tolerance * b.D(w) + 1e-6) << name;
      EXPECT_NEAR(a.lambda_cos(w), b.lambda_cos(w), tolerance * (w.z + b.lambda_cos(w))) << name;
    };
    expect_same(gtr(ax, ay, 2.0), ggx, "GTR at gamma 2 is GGX", 1e-3);
    expect_same(student_t(ax, ay, 2.0), ggx, "STD at gamma 2 is GGX", 1e-6);
    expect_same(exponential_power(ax, ay, 1.0), beckmann, "EPD at p 1 is Beckmann", 1e-3);
    expect_same(student_t(ax, ay, 1e5), beckmann, "STD of infinite gamma is Beckmann", 3e-3);
    // Burley 2012, eq. 4: Berry's distribution, its constant known.
    const double a2 = ax * ax, c2 = w.z * w.z;
    EXPECT_NEAR(gtr(ax, ax, 1.0).D(w), (a2 - 1) / (pi * std::log(a2) * (1 + (a2 - 1) * c2)), 1e-8 * 100)
        << ax;
  }
}

TEST(Distributions, AreContinuousWhereTheirFormulasAreZeroOverZero) {
  const Vec3d w = spherical_direction(0.8, 0.0);
  const auto near = [](double a, double b) { EXPECT_NEAR(a, b, 1e-4 * b); };
  near(gtr(0.3, 0.3, 1 + 1e-7).D(w), gtr(0.3, 0.3, 1.0).D(w));
  near(gtr(1.0, 1.0, 1.3).D(w), 1 / pi);
  near(abc_normalisation(1e3, 1 + 1e-7), abc_normalisation(1e3, 1.0));
  near(abc_normalisation(1e3, 2 + 1e-7), abc_normalisation(1e3, 2.0));
  near(exponential_power(0.3, 0.3, 1 + 1e-7).visible_density(w, {0, 0, 1}),
       exponential_power(0.3, 0.3, 1 - 1e-7).visible_density(w, {0, 0, 1}));
}

TEST(Masking, FormsAgreeWhereTheyMust) {
  const Ggx<double> d{0.5, 0.5};
  for (const double theta : {0.3, 1.2, 1.5}) {
    const Vec3d wo = spherical_direction(theta, 0.0);
    const double lo = d.lambda_cos(wo);
    for (const double phi : {0.0, 0.4, 2.0, pi}) {
      const Vec3d wi = spherical_direction(0.9, phi);
      const double li = d.lambda_cos(wi), none = 0.25 / (wo.z * wi.z);
      const double separable = visibility(d, wo, wi, 1.0), correlated = visibility(d, wo, wi, 0.0);
      EXPECT_NEAR(azimuth_difference(wo, wi), phi, 1e-12);
      const double ginneken = visibility_van_ginneken(lo, li, wo.z, wi.z, phi);
      const double ashikhmin = visibility_ashikhmin(lo, li, wo.z, wi.z, phi);
      EXPECT_GE(ginneken, correlated);
      EXPECT_LE(ginneken, none);
      EXPECT_GE(ashikhmin, separable * (1 - 1e-12));
      // Seen from above the light nothing masked is lit besides: the smaller G1 counts alone.
      const double smaller = std::min(smith_g1(d, wo), smith_g1(d, wi)) * none;
      if (phi == 0) {
        EXPECT_NEAR(ginneken, smaller, 1e-12 * smaller);
        EXPECT_NEAR(ashikhmin, smaller, 1e-12 * smaller);
      }
      if (phi > 3) {
        EXPECT_NEAR(ashikhmin, separable, 1e-12);
      }
    }
  }
  EXPECT_EQ(azimuth_difference(Vec3d{0, 0, 1}, Vec3d{0, 0, 1}), 0);
}

// Torrance and Sparrow's masking keeps projected area too, with any distribution: cos_o is the integral of
// G1 <wo, wm> D with G1 = min(1, 2 cos_m cos_o / (wo . wm)) over pairs of facets of which at least one is
// seen.
TEST(Masking, VCavityConservesProjectedArea) {
  const Ggx<double> d{0.4, 0.4};
  for (const double theta : {0.2, 0.9, 1.4}) {
    const Vec3d wo = spherical_direction(theta, 0.0);
    const double area = integrate_facets(d, 0.4, 0.4, wo, [&](const Vec3d& wm) {
      const double c = dot(wo, wm);
      return c <= 0 ? 0 : c * 4 * visibility_vcavity(wo.z, 1.0, wm.z, c) * wo.z;
    });
    EXPECT_NEAR(area, wo.z, 2e-3 * wo.z);
  }
}

TEST(Ggx, FromStraightBelowANormalIsANormal) {
  const Vec3d wm = Ggx<double>{0.3, 0.3}.sample_visible({0, 0, -1}, {0.3, 0.6});
  EXPECT_NEAR(length(wm), 1, 1e-12);
}

} // namespace
} // namespace nacre
