#include "bsdf/models/ashikhmin_shirley.h"

#include "bsdf/models/ashikhmin_dbrdf.h"
#include "bsdf/models/ashikhmin_shirley_diffuse.h"
#include "bsdf/published_fits.h"
#include "bsdf/reference_table.h"
#include "core/quadrature.h"
#include "core/random.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

using Exact = AshikhminShirleyExact<double, 3>;
using Schlick = AshikhminShirley<double, 3>;

template <class M>
published_fits::Deviation deviation(const std::string& set) {
  return published_fits::compare(set, [](const nlohmann::json& lobe) {
    auto m = default_model<M>();
    m.specular_reflectance = published_fits::albedo(lobe);
    m.fresnel = Spectrum<double, 3>(lobe["fresnelReflectance"].get<double>());
    m.n_u = m.n_v = lobe["sharpness"];
    return m;
  });
}

TEST(AshikhminShirley, PublishedFitsHaveTheValuesOfBbm) {
  for (const std::string set :
       {"low_ashikhminshirley_E1", "low_ashikhminshirley_E2", "ngan_ashikhminshirley"}) {
    // Loew's "fresnelReflectance" is an index, for Fresnel's equations.
    const auto d = set == "ngan_ashikhminshirley" ? deviation<Schlick>(set) : deviation<Exact>(set);
    if (d.count == 0) GTEST_SKIP() << "no published fits beside the project";
    EXPECT_LT(d.worst, 1e-7) << d.beyond << " of " << d.count << " beyond, worst " << d.where;
  }
}

TEST(AshikhminShirley, WithItsDiffuseIsThePublicShader) {
  const auto rows = reference_table::read("brdf_files.csv", "ashikhman_shirley.brdf");
  if (rows.empty()) GTEST_SKIP() << "no reference values beside the project";
  auto specular = default_model<Schlick>();
  auto diffuse = default_model<AshikhminShirleyDiffuse<double, 3>>();
  specular.fresnel = diffuse.f0 = Spectrum<double, 3>(0.1), diffuse.reflectance = Spectrum<double, 3>(1.0);
  specular.n_u = specular.n_v = 100;
  for (const auto& row : rows) {
    const double f = specular.eval(row.wo, row.wi)[0] + diffuse.eval(row.wo, row.wi)[0];
    EXPECT_NEAR(f, row.f[0], 5e-5 * row.f[0]) << row.text();
  }
}

TEST(AshikhminShirley, SampleWeighsAtMostFresnel) {
  auto m = default_model<AshikhminShirley<double, 1>>();
  m.fresnel = Spectrum<double, 1>(1.0);
  int lost = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const auto u = [&](int d) { return unit_double(hash(3, i, d)); };
    m.n_u = std::exp(9 * u(0)), m.n_v = std::exp(9 * u(1));
    const auto s = m.sample(spherical_direction(1.57 * u(2), 6 * u(3)), u(4), {u(5), u(6)});
    EXPECT_LE(s.pdf > 0 ? s.f[0] * s.wi.z / s.pdf : 0, 1 + 1e-9);
    lost += s.pdf == 0;
  }
  EXPECT_LT(lost, 0.1 * n);
}

TEST(AshikhminShirley, IsRotatedWithItsAxes) {
  auto m = default_model<AshikhminShirley<double, 1>>(), turned = m;
  m.n_u = turned.n_v = 10, m.n_v = turned.n_u = 1000;
  const auto quarter = [](const Vec3d& w) { return Vec3d{-w.y, w.x, w.z}; };
  const Vec3d wo = spherical_direction(0.7, 0.2), wi = spherical_direction(0.6, 3.0);
  EXPECT_NEAR(turned.eval(quarter(wo), quarter(wi))[0], m.eval(wo, wi)[0], 1e-12);
  EXPECT_GT(std::abs(turned.eval(wo, wi)[0] / m.eval(wo, wi)[0] - 1), 0.1);
}

// At the peak eq. 4 is (n + 1) F / (8 pi cos^2): exponents so large that a cosine rounds to 1 keep their
// digits.
TEST(AshikhminShirley, PeakIsExactInFloatForHugeExponents) {
  auto m = default_model<AshikhminShirley<float, 1>>();
  auto reference = default_model<AshikhminShirley<double, 1>>();
  m.n_u = m.n_v = 6e5f, reference.n_u = reference.n_v = 6e5;
  const Vec3d n{0, 0, 1};
  EXPECT_NEAR(reference.eval(n, n)[0], 0.04 * (6e5 + 1) / (8 * pi), 1e-6);
  for (double off = 0; off < 0.004; off += 0.0005) {
    const Vec3f wi = vec3<float>(spherical_direction(off, 0.0));
    const double f = reference.eval(n, {wi.x, wi.y, wi.z})[0];
    EXPECT_NEAR(m.eval({0, 0, 1}, wi)[0], f, 1e-4 * f);
  }
}

TEST(AshikhminShirleyDiffuse, AlbedoIsThePapers) {
  auto m = default_model<AshikhminShirleyDiffuse<double, 1>>();
  m.reflectance = Spectrum<double, 1>(0.8), m.f0 = Spectrum<double, 1>(0.1);
  for (const double theta : {0.0, 0.7, 1.5}) {
    const Vec3d wo = spherical_direction(theta, 0.0);
    const double a = integrate_hemisphere([&](const Vec3d& wi) { return m.eval(wo, wi)[0] * wi.z; }, 16, 4);
    EXPECT_NEAR(a, 0.8 * 0.9 * (1 - std::pow(1 - wo.z / 2, 5)), 1e-12);
  }
}

TEST(AshikhminDbrdf, IsDistributionOverFourAlongTheNormal) {
  auto m = default_model<AshikhminDbrdf<double, 1>>();
  m.alpha_x = 0.1, m.alpha_y = 0.4;
  const Vec3d n{0, 0, 1};
  for (const double phi : {0.0, 1.0, 1.5}) {
    const Vec3d wi = spherical_direction(0.3, phi), wm = normalize(n + wi);
    const double D = Beckmann<double>{0.1, 0.4}.D(wm);
    // cos_o = 1: the term for masking is 1
    EXPECT_NEAR(m.eval(n, wi)[0], 0.25 * D * fresnel_schlick(dot(n, wm), 0.04), 1e-12);
  }
}

TEST(AshikhminDbrdf, NarrowLobeDarkensTowardsTheHorizon) {
  auto m = default_model<AshikhminDbrdf<double, 1>>();
  m.f0 = Spectrum<double, 1>(1.0), m.alpha_x = m.alpha_y = 0.003;
  for (const double theta : {0.0, 0.8, 1.2}) {
    const double c = std::cos(theta);
    const auto s = m.sample(spherical_direction(theta, 0.0), 0.5, {0.5, 0.5});
    EXPECT_NEAR(s.f[0] * s.wi.z / s.pdf, c / (2 - c), 0.01);
  }
}

TEST(AshikhminDbrdf, NeverReflectsMoreThanItReceives) {
  auto m = default_model<AshikhminDbrdf<double, 1>>();
  m.f0 = Spectrum<double, 1>(1.0);
  for (const double alpha : {0.02, 0.3, 1.0})
    for (const double theta : {0.0, 0.9, 1.4, 1.56}) {
      m.alpha_x = m.alpha_y = alpha;
      double worst = 0;
      for (int i = 0; i < 2000; ++i) {
        const auto u = [&](int d) { return unit_double(hash(4, i, d)); };
        const auto s = m.sample(spherical_direction(theta, 0.0), u(0), {u(1), u(2)});
        if (s.pdf > 0) worst = std::max(worst, s.f[0] * s.wi.z / s.pdf);
      }
      EXPECT_LT(worst, 1 + 1e-9) << alpha << " " << theta;
    }
}

} // namespace
} // namespace nacre
