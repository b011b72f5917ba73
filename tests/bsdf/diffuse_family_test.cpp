// Facts and limits of the diffuse models that no generic law knows.
#include "bsdf/models/chandrasekhar.h"
#include "bsdf/models/eon.h"
#include "bsdf/models/gotanda_diffuse.h"
#include "bsdf/models/hanrahan_krueger.h"
#include "bsdf/models/lambert.h"
#include "bsdf/models/lambert_sphere.h"
#include "bsdf/models/lommel_seeliger.h"
#include "bsdf/models/minnaert.h"
#include "bsdf/models/oren_nayar.h"
#include "bsdf/models/oren_nayar_full.h"
#include "bsdf/models/retro_diffuse.h"
#include "core/quadrature.h"
#include "core/random.h"

#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

namespace nacre {
namespace {

using Grey = Spectrum<double, 1>;

Vec3d direction(double theta_deg, double phi_deg = 0) {
  return spherical_direction(theta_deg * pi / 180, phi_deg * pi / 180);
}
Vec3d at_cosine(double mu) { return {std::sqrt(1 - mu * mu), 0, mu}; }

/// By quadrature whose nodes crowd at the horizon: cos(theta) = t^3.
template <class M>
double albedo(const M& m, const Vec3d& wo, int n_mu = 48, int n_phi = 96) {
  double sum = 0;
  const QuadratureRule rule = gauss_legendre(n_mu, 0, 1);
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const double t = rule.node[i], z = t * t * t, s = std::sqrt(1 - z * z);
    for (int j = 0; j < n_phi; ++j) {
      const double phi = 2 * pi * (j + 0.5) / n_phi;
      sum += 3 * t * t * rule.weight[i] * (2 * pi / n_phi) * z *
             m.eval(wo, {s * std::cos(phi), s * std::sin(phi), z})[0];
    }
  }
  return sum;
}

template <class M>
void expect_lambert(const M& m, double reflectance) {
  for (const double o : {0.0, 30.0, 60.0, 85.0})
    for (const double i : {0.0, 20.0, 70.0})
      for (const double phi : {0.0, 100.0, 180.0})
        EXPECT_NEAR(m.eval(direction(o), direction(i, phi))[0], reflectance * inv_pi, 1e-12) << o << " " << i;
}

TEST(DiffuseLimits, WithoutRoughnessAreLambert) {
  expect_lambert(OrenNayarFull<double, 1>{{}, Grey(0.7), 0}, 0.7);
  expect_lambert(Eon<double, 1>{{}, Grey(0.7), 0}, 0.7);
  expect_lambert(Minnaert<double, 1>{{}, Grey(0.7), 1}, 0.7);
  expect_lambert(HanrahanKrueger<double, 1>{{}, Grey(0.9), Grey(0.7), 0, 0.3, 1}, 0.7);
}

// The paper's equations in its own angles.
double oren_nayar_1994(double rho, double sigma, double theta_r, double theta_i, double phi) {
  const double alpha = std::max(theta_i, theta_r), beta = std::min(theta_i, theta_r), s2 = sigma * sigma;
  const double C1 = 1 - 0.5 * s2 / (s2 + 0.33), part = s2 / (s2 + 0.09);
  const double C2 =
      0.45 * part * (std::cos(phi) >= 0 ? std::sin(alpha) : std::sin(alpha) - std::pow(2 * beta / pi, 3));
  const double C3 = 0.125 * part * std::pow(4 * alpha * beta / (pi * pi), 2);
  const double once = C1 + std::cos(phi) * C2 * std::tan(beta) +
                      (1 - std::abs(std::cos(phi))) * C3 * std::tan((alpha + beta) / 2);
  const double twice = 0.17 * rho * s2 / (s2 + 0.13) * (1 - std::cos(phi) * std::pow(2 * beta / pi, 2));
  return rho / pi * (once + twice);
}

TEST(OrenNayarFull, IsThePapersEquations) {
  for (const double sigma : {0.1, 0.4, 0.6})
    for (const double r : {5.0, 40.0, 80.0})
      for (const double i : {10.0, 40.0, 75.0})
        for (const double phi : {0.0, 50.0, 130.0, 180.0}) {
          const OrenNayarFull<double, 1> m{{}, Grey(0.8), sigma};
          const double d = pi / 180, paper = oren_nayar_1994(0.8, sigma, r * d, i * d, phi * d);
          EXPECT_NEAR(m.eval(direction(r), direction(i, phi))[0], paper, 1e-7)
              << sigma << " " << r << " " << i;
        }
}

TEST(OrenNayarFull, InterreflectionIsItsDifferenceFromTheSimpleFormTowardsTheLight) {
  // At phi = 0 and with either direction at the normal, C2 is that of the simple form and C3 is absent.
  const double rho = 0.9, sigma = 0.5, s2 = sigma * sigma;
  const OrenNayarFull<double, 1> full{{}, Grey(rho), sigma};
  const OrenNayar<double, 1> simple{{}, Grey(rho), sigma};
  for (const double theta : {0.0, 30.0, 70.0})
    EXPECT_NEAR(full.eval(direction(0), direction(theta))[0] - simple.eval(direction(0), direction(theta))[0],
                0.17 * rho * rho / pi * s2 / (s2 + 0.13), 1e-8);
}

TEST(Eon, KeepsAllEnergyAtEveryRoughness) {
  for (const double r : {0.05, 0.3, 0.7, 1.0})
    for (const double mu : {1.0, 0.8, 0.4, 0.1, 0.01}) {
      const Eon<double, 1> white{{}, Grey(1), r};
      // 2e-4: the kink where wi lies across wo
      EXPECT_NEAR(albedo(white, at_cosine(mu), 64, 256), 1, 2e-4) << r << " " << mu;
    }
}

TEST(Eon, WeightsOfSamplingAreNearlyConstant) {
  const Eon<double, 1> white{{}, Grey(1), 1};
  for (const double theta : {0.0, 45.0, 75.0, 88.0}) {
    double sum = 0, squares = 0;
    const int n = 4000;
    for (int i = 0; i < n; ++i) {
      const auto s = white.sample(direction(theta), unit_double(hash(3, i, 0)),
                                  {unit_double(hash(3, i, 1)), unit_double(hash(3, i, 2))});
      const double w = s.f[0] * s.wi.z / s.pdf;
      sum += w, squares += w * w;
    }
    EXPECT_NEAR(sum / n, 1, 0.015) << theta;
    EXPECT_LT(squares / n - sum / n * (sum / n), 0.05) << theta; // cosine sampling: 0.25 at 75 degrees
  }
}

TEST(Eon, AgreesWithOpenPbrsImplementation) {
  std::ifstream file(NACRE_SOURCE_DIR "/../shared/data/reference/openpbr.csv");
  if (!file) GTEST_SKIP() << "no ../shared/data/reference/openpbr.csv";
  const Eon<double, 1> m{{}, Grey(0.8), 0.7}; // 0.8 is that specification's default base_color
  int rows = 0;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("base_diffuse_roughness=0.7;specular_weight=0,")) continue;
    std::ranges::replace(line, ',', ' ');
    std::istringstream fields(line);
    std::string name;
    double theta_i, theta_o, phi, fcos;
    fields >> name >> theta_i >> theta_o >> phi >> fcos;
    const Vec3d wo = direction(theta_o), wi = direction(theta_i, phi);
    const double ours = m.eval(wo, wi)[0] * wi.z;
    EXPECT_NEAR(ours, fcos, 1e-3 * fcos) << line;
    ++rows;
  }
  EXPECT_EQ(rows, 25);
}

TEST(RetroDiffuse, BrightensTowardsTheLightAtGrazingByItsF90) {
  // Light and viewer together at the horizon: theta_d = 0 and both factors are F_D90.
  const Vec3d w = at_cosine(1e-9);
  EXPECT_NEAR((BurleyDiffuse<double, 1>{{}, Grey(1), 1}.eval(w, w)[0] * pi), 2.5 * 2.5, 1e-6);
  EXPECT_NEAR((BurleyDiffuse<double, 1>{{}, Grey(1), 0}.eval(w, w)[0] * pi), 0.5 * 0.5, 1e-6);
  EXPECT_NEAR((FrostbiteDiffuse<double, 1>{{}, Grey(1), 1}.eval(w, w)[0] * pi), 2.5 * 2.5 / 1.51, 1e-6);
  EXPECT_NEAR((FrostbiteDiffuse<double, 1>{{}, Grey(1), 0}.eval(w, w)[0] * pi), 0, 1e-6);
}

TEST(RetroDiffuse, FrostbiteTakesBackBurleysGain) {
  const Vec3d rim = at_cosine(1e-3);
  EXPECT_NEAR(albedo(BurleyDiffuse<double, 1>{{}, Grey(1), 1}, rim), 1.55, 0.01);
  EXPECT_NEAR(albedo(FrostbiteDiffuse<double, 1>{{}, Grey(1), 1}, rim), 1.03, 0.01);
}

TEST(GotandaDiffuse, OfASmoothSurfaceDoesNotTurnWithTheLight) {
  const GotandaDiffuse<double, 1> m{{}, Grey(1), 0, 0.04};
  const double f = m.eval(direction(50), direction(40, 0))[0];
  for (const double phi : {60.0, 120.0, 180.0})
    EXPECT_NEAR(m.eval(direction(50), direction(40, phi))[0], f, 1e-14);
}

TEST(GotandaDiffuse, OfARoughSurfaceIsBrightestTowardsTheLight) {
  const GotandaDiffuse<double, 1> m{{}, Grey(1), 0.8, 0.04};
  EXPECT_GT(m.eval(direction(60), direction(60, 0))[0], 1.3 * m.eval(direction(60), direction(60, 180))[0]);
}

TEST(GotandaDiffuse, IsContinuousWhereItsSeriesTakesOver) {
  const GotandaDiffuse<double, 1> m{{}, Grey(1), 0.5, 0.04};
  const double f = m.eval(direction(30), at_cosine(1e-3 * (1 - 1e-9)))[0];
  EXPECT_NEAR(m.eval(direction(30), at_cosine(1e-3 * (1 + 1e-9)))[0], f, 1e-5 * f);
}

TEST(Minnaert, AlbedoIsThePowerOfTheCosine) {
  for (const double k : {0.5, 1.0, 2.5})
    for (const double mu : {1.0, 0.6, 0.2})
      EXPECT_NEAR(albedo(Minnaert<double, 1>{{}, Grey(0.5), k}, at_cosine(mu)), 0.5 * std::pow(mu, k - 1),
                  1e-4);
}

TEST(LommelSeeliger, AlbedoHasItsClosedForm) {
  const LommelSeeliger<double, 1> m{{}, Grey(0.8)};
  for (const double mu : {1.0, 0.5, 0.05})
    EXPECT_NEAR(albedo(m, at_cosine(mu)), 0.4 * (1 - mu * std::log(1 + 1 / mu)), 1e-6);
}

TEST(LommelSeeliger, IsChandrasekharsFirstOrder) {
  const double c = 1e-4;
  const double first = LommelSeeliger<double, 1>{{}, Grey(c)}.eval(direction(20), direction(60, 77))[0];
  const double all = Chandrasekhar<double, 1>{{}, Grey(c)}.eval(direction(20), direction(60, 77))[0];
  EXPECT_NEAR(all / first, 1, 2 * c);
}

// Chandrasekhar 1960, table XI.
TEST(Chandrasekhar, HAgreesWithThePrintedTable) {
  const auto H = [](double mu) { return chandrasekhar_h<double, 1>(mu, Grey(1))[0]; };
  EXPECT_NEAR(H(1), 2.9078, 5e-5);
  EXPECT_NEAR(H(0.5), 2.0128, 5e-5);
  EXPECT_NEAR(H(0.1), 1.2474, 6e-5);
}

TEST(Chandrasekhar, HSolvesItsIntegralEquation) {
  // H(mu) = 1 + c/2 mu H(mu) integral of H(x) / (mu + x), chapter V, eq. 1
  const QuadratureRule rule = gauss_legendre(64, 0, 1);
  for (const double c : {0.1, 0.6, 0.95, 1.0})
    for (const double mu : {0.02, 0.3, 1.0}) {
      double integral = 0;
      for (std::size_t i = 0; i < rule.node.size(); ++i) {
        const double t = rule.node[i], x = t * t * t;
        integral += 3 * t * t * rule.weight[i] * chandrasekhar_h<double, 1>(x, Grey(c))[0] / (mu + x);
      }
      const double H = chandrasekhar_h<double, 1>(mu, Grey(c))[0];
      EXPECT_NEAR(1 + 0.5 * c * mu * H * integral, H, 2e-5 * H) << c << " " << mu;
    }
}

TEST(Chandrasekhar, WhiteMediumReflectsEverything) {
  const Chandrasekhar<double, 1> white{{}, Grey(1)};
  for (const double mu : {1.0, 0.5, 0.05})
    EXPECT_NEAR(albedo(white, at_cosine(mu), 48, 1), 1, 1e-5) << mu;
}

TEST(HanrahanKrueger, DeepIndexMatchedLayerIsLommelSeeliger) {
  const HanrahanKrueger<double, 1> layer{{}, Grey(0.6), Grey(1), 20, 0, 1};
  const LommelSeeliger<double, 1> deep{{}, Grey(0.6)};
  for (const double theta : {30.0, 70.0})
    EXPECT_NEAR(layer.eval(direction(10), direction(theta, 33))[0],
                deep.eval(direction(10), direction(theta, 33))[0], 1e-12);
}

TEST(HanrahanKrueger, ClearLayerShowsItsBaseThroughTwoInterfaces) {
  const double eta = 1.5;
  const HanrahanKrueger<double, 1> layer{{}, Grey(0), Grey(0.5), 0, 0, eta};
  const double T = 1 - 0.04;
  EXPECT_NEAR(layer.eval(direction(0), direction(0))[0], T * T / (eta * eta) * 0.5 / pi, 1e-12);
}

TEST(HanrahanKrueger, PhaseFunctionIsTheRatioToIsotropicScattering) {
  const double g = -0.5;
  const HanrahanKrueger<double, 1> back{{}, Grey(1), Grey(0), 1, g, 1}, even{{}, Grey(1), Grey(0), 1, 0, 1};
  const Vec3d wo = direction(40), wi = direction(60, 20);
  const double p = (1 - g * g) / std::pow(1 + g * g + 2 * g * dot(wo, wi), 1.5); // times 4 pi
  EXPECT_NEAR(back.eval(wo, wi)[0] / even.eval(wo, wi)[0], p, 1e-12);
}

/// Direction of travel after one collision with a Lambertian sphere: a point of it that the light sees, then
/// a cosine lobe about its normal.
Vec3d scattered_by_sphere(const Vec3d& travel, std::uint64_t key, int& dimension) {
  const auto u = [&] {
    const double x = unit_double(hash(17, key, dimension++));
    return Vec2<double>{x, unit_double(hash(17, key, dimension++))};
  };
  const Vec3d normal = Frame<double>::around(-travel).to_world(square_to_cosine_hemisphere(u()));
  return normalize(Frame<double>::around(normal).to_world(square_to_cosine_hemisphere(u())));
}

TEST(LambertSphere, PhaseFunctionIsNormalised) {
  const QuadratureRule rule = gauss_legendre(64, -1, 1);
  EXPECT_NEAR(integrate(rule, [](double c) { return 2 * pi * LambertSphere<double, 1>::phase(c); }), 1, 1e-5);
}

TEST(LambertSphere, AgreesWithARandomWalkThroughTheMedium) {
  const double kd = 0.7, c = LambertSphere<double, 1>::grain_albedo(kd);
  const LambertSphere<double, 1> m{{}, Grey(kd)};
  const Vec3d wi = direction(50);
  const std::array views{direction(0), direction(50), direction(50, 180), direction(75, 90)};
  std::array<double, 4> sum{};
  const int n = 40000;
  for (int k = 0; k < n; ++k) {
    int dimension = 0;
    double depth = 0, weight = 1;
    Vec3d travel = -wi;
    for (int bounce = 0; bounce < 60; ++bounce) {
      depth += std::log(1 - unit_double(hash(17, k, dimension++))) * travel.z; // optical depth, downwards
      if (depth < 0) break;
      weight *= c;
      for (std::size_t v = 0; v < views.size(); ++v)
        sum[v] += weight * LambertSphere<double, 1>::phase(dot(travel, views[v])) *
                  std::exp(-depth / views[v].z) / views[v].z;
      travel = scattered_by_sphere(travel, std::uint64_t(k), dimension);
    }
  }
  for (std::size_t v = 0; v < views.size(); ++v) {
    // light of unit flux through the surface: f = radiance; 3 % is the fit's error and the walk's
    const double walk = sum[v] / n;
    EXPECT_NEAR(m.eval(views[v], wi)[0], walk, 0.03 * walk) << v;
  }
}

TEST(LambertSphere, ReflectanceIsTheHemisphericalAlbedo) {
  const QuadratureRule rule = gauss_legendre(12, 0, 1);
  for (const double kd : {0.2, 0.5, 0.8, 1.0}) {
    const LambertSphere<double, 1> m{{}, Grey(kd)};
    const double mean = integrate(rule, [&](double mu) { return 2 * mu * albedo(m, at_cosine(mu), 24, 48); });
    EXPECT_NEAR(mean, kd, 0.04 * kd) << kd; // what eq. 46 reaches
  }
}

} // namespace
} // namespace nacre
