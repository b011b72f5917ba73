#include "bsdf/models/cook_torrance.h"

#include "bsdf/models/torrance_sparrow.h"
#include "bsdf/published_fits.h"
#include "bsdf/reference_table.h"
#include "core/random.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

using Exact = CookTorrance<double, 3>;
using Schlick = CookTorranceSchlick<double, 3>;
using Gray = Spectrum<double, 3>;

TEST(CookTorrance, PublishedFitsOfLoewHaveTheValuesOfBbm) {
  for (const std::string set : {"low_cooktorrance_E1", "low_cooktorrance_E2"}) {
    const auto d = published_fits::compare(set, [](const nlohmann::json& lobe) {
      auto m = default_model<Exact>();
      m.specular_reflectance = published_fits::albedo(lobe);
      m.fresnel = Gray(lobe["eta"].get<double>());
      m.m = lobe["roughness"];
      return m;
    });
    if (d.count == 0) GTEST_SKIP() << "no published fits beside the project";
    EXPECT_EQ(d.count, 3 * 1250);
    EXPECT_LT(d.worst, 1e-7) << d.beyond << " of " << d.count << " beyond, worst " << d.where;
  }
}

TEST(CookTorrance, PublishedFitsOfNganHaveTheValuesOfBbm) {
  const auto d = published_fits::compare("ngan_cooktorrance", [](const nlohmann::json& lobe) {
    auto m = default_model<Schlick>();
    m.specular_reflectance = published_fits::albedo(lobe);
    m.fresnel = Gray(lobe["eta"].get<double>()); // reflectance at normal incidence, whatever its name
    m.m = lobe["roughness"];
    m.divisor = pi;
    return m;
  });
  if (d.count == 0) GTEST_SKIP() << "no published fits beside the project";
  EXPECT_LT(d.worst, 1e-7) << d.beyond << " of " << d.count << " beyond, worst " << d.where;
}

// The public shader has no 1/pi, and its switch for G, on by default, leaves G out.
TEST(CookTorrance, PublicShaderIsPiTimesThePapersWithoutG) {
  const auto rows = reference_table::read("brdf_files.csv", "cooktorrance.brdf");
  if (rows.empty()) GTEST_SKIP() << "no reference values beside the project";
  auto m = default_model<Schlick>();
  m.fresnel = Gray(0.1), m.m = 0.1;
  for (const auto& row : rows) {
    const Vec3d wm = normalize(row.wo + row.wi);
    const double G = std::min(1.0, 2 * wm.z * std::min(row.wo.z, row.wi.z) / dot(row.wo, wm));
    const double f = pi / G * m.eval(row.wo, row.wi)[0];
    EXPECT_NEAR(f, row.f[0], 1e-4 * row.f[0] + 1e-12) << row.text();
  }
}

/// Mean of f cos / pdf, the directional albedo of a gray model.
template <class M>
double albedo(const M& m, double theta) {
  const Vec3d wo = spherical_direction(theta, 0.4);
  double sum = 0;
  const int n = 120;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double u_lobe = unit_double(hash(1, i, j));
      const auto s = m.sample(wo, u_lobe, {(i + 0.5) / n, (j + 0.5) / n});
      if (s.pdf > 0) sum += s.f[0] * s.wi.z / s.pdf;
    }
  return sum / (n * n);
}

TEST(CookTorrance, ReflectsFourTimesTheLightAsPublishedAndKeepsItWithDivisorFour) {
  auto m = default_model<Schlick>();
  m.fresnel = Gray(1.0), m.m = 0.01;
  EXPECT_NEAR(albedo(m, 0.3), 4, 0.01);
  m.divisor = pi;
  EXPECT_NEAR(albedo(m, 0.3), 4 / pi, 0.003);
  m.divisor = 4;
  EXPECT_NEAR(albedo(m, 0.3), 1, 0.002);
  for (const double roughness : {0.05, 0.3, 1.0, 2.5})
    for (const double theta : {0.0, 0.8, 1.3, 1.56}) {
      m.m = roughness;
      EXPECT_LT(albedo(m, theta), 1 + 1e-9) << roughness << " " << theta;
    }
}

// The facet of a groove that is seen reflects the light, or the other facet stops it: f cos / pdf is F G / G1
// <= F.
TEST(CookTorrance, SampleWeighsAtMostFresnel) {
  auto m = default_model<Schlick>();
  m.fresnel = Gray(1.0), m.divisor = 4;
  for (int i = 0; i < 20000; ++i) {
    const auto u = [&](int d) { return unit_double(hash(2, i, d)); };
    m.m = 0.01 + u(0);
    const auto s = m.sample(spherical_direction(1.57 * u(1), 0.0), u(2), {u(3), u(4)});
    if (s.pdf > 0) {
      EXPECT_LE(s.f[0] * s.wi.z / s.pdf, 1 + 1e-9);
    }
  }
}

TEST(TorranceSparrow, FacetsHaveTheProjectedAreaOfTheSurface) {
  // Along the normal f = F D(0) / 4, and the integral of exp(-(a / m)^2) cos a is pi m times Dawson's
  // integral of m (Abramowitz and Stegun 1964, table 7.5) but for angles beyond pi / 2.
  auto m = default_model<TorranceSparrow<double, 1>>();
  const Vec3d n{0, 0, 1};
  for (const auto& [width, dawson] : {std::pair{0.1, 0.0993359924}, {0.3, 0.2826316650}}) {
    m.m = width;
    EXPECT_NEAR(m.eval(n, n)[0], 0.04 / (4 * pi * width * dawson), 2e-9 * m.eval(n, n)[0]);
  }
}

// What the paper set out to explain: the brightest direction lies beyond the mirror direction.
TEST(TorranceSparrow, PeakIsOffSpecular) {
  auto m = default_model<TorranceSparrow<double, 1>>();
  m.m = 0.3;
  const double theta = 60 * pi / 180;
  const auto radiance = [&](double theta_r) {
    return m.eval(spherical_direction(theta_r, pi), spherical_direction(theta, 0.0))[0];
  };
  double best = 0;
  for (double t = 0.5; t < 1.57; t += 0.01)
    if (radiance(t) > radiance(best)) best = t;
  EXPECT_GT(best, theta + 0.1);
  m.m = 0.02;
  EXPECT_GT(radiance(theta), radiance(theta + 0.05));
}

// Both have V-cavities; Gaussian angles and Gaussian slopes are the same where facets are nearly level.
TEST(TorranceSparrow, IsCookTorranceOfSmallRoughness) {
  auto a = default_model<TorranceSparrow<double, 3>>();
  auto b = default_model<Exact>();
  a.m = b.m = 0.02, b.divisor = 4;
  for (const double theta : {0.0, 0.5, 1.2}) {
    const Vec3d wo = spherical_direction(theta, 0.0), wi = spherical_direction(theta + 0.01, pi);
    EXPECT_NEAR(a.eval(wo, wi)[0], b.eval(wo, wi)[0], 2e-3 * b.eval(wo, wi)[0]);
  }
}

} // namespace
} // namespace nacre
