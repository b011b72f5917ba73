#include "bsdf/models/disney_2012.h"
#include "bsdf/models/disney_2015.h"
#include "bsdf/models/rough_dielectric.h"

#include "bsdf/reference_table.h"
#include "core/quadrature.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

using Principled = Disney2012<double, 3>;

Spectrum<double, 3> color(double r, double g, double b) { return Spectrum<double, 3>({r, g, b}); }

TEST(Disney2012, IsThePublicDisneyBrdf) {
  const auto rows = reference_table::read("brdf_files.csv", "disney.brdf");
  if (rows.empty()) GTEST_SKIP() << "no reference values beside the project";
  auto m = default_model<Principled>();
  m.base_color = color(std::pow(0.82, 2.2), std::pow(0.67, 2.2), std::pow(0.16, 2.2));
  for (const auto& row : rows)
    for (int c = 0; c < 3; ++c) // the reference computes in float
      EXPECT_NEAR(m.eval(row.wo, row.wi)[c], row.f[std::size_t(c)], 2e-5 * row.f[std::size_t(c)])
          << row.text();
}

TEST(Disney2012, Gtr1IsNormalizedAndSampled) {
  for (const double alpha : {0.001, 0.02, 0.1}) {
    const Gtr1<double> d{alpha};
    // In z = 1 - cos theta on a logarithmic scale, as the peak is narrow.
    const double total =
        integrate(composite_gauss_legendre(8, 200, std::log(1e-14), 0), [&](double log_drop) {
          const double drop = std::exp(log_drop), z = 1 - drop, s = std::sqrt(drop * (2 - drop));
          return 2 * pi * d.D({s, 0, z}) * z * drop;
        });
    EXPECT_NEAR(total, 1, 1e-6);
    // The share of normals below a quantile of the sampler is that quantile.
    const Vec3d wm = d.sample_normal({0.25, 0.3});
    const double share = integrate(
        composite_gauss_legendre(8, 200, std::log(1e-14), std::log(1 - wm.z)), [&](double log_drop) {
          const double drop = std::exp(log_drop), z = 1 - drop, s = std::sqrt(drop * (2 - drop));
          return 2 * pi * d.D({s, 0, z}) * z * drop;
        });
    EXPECT_NEAR(share, 0.3, 1e-4);
  }
}

TEST(Disney2012, DiffuseAtNormalIncidenceIsLambert) {
  auto m = default_model<Principled>();
  m.specular = 0;
  m.base_color = color(0.2, 0.5, 0.8);
  const Vec3d n{0, 0, 1};
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(m.eval(n, n)[c], m.base_color[c] / pi, 1e-12);
}

TEST(Disney2012, MetalIsGgxOfTheBaseColor) {
  auto m = default_model<Principled>();
  m.metallic = 1;
  m.base_color = color(0.9, 0.6, 0.3);
  m.roughness = 0.6;
  const Vec3d wo = spherical_direction(0.5, 0.3), wi = spherical_direction(0.9, 2.0), wm = normalize(wo + wi);
  const Ggx<double> d{0.36, 0.36};
  for (int c = 0; c < 3; ++c) {
    const double F = m.base_color[c] + (1 - m.base_color[c]) * std::pow(1 - dot(wo, wm), 5);
    EXPECT_NEAR(m.eval(wo, wi)[c], F * d.D(wm) * smith_g1(d, wo) * smith_g1(d, wi) / (4 * wo.z * wi.z),
                1e-12);
  }
}

TEST(Disney2012, AnisotropyStretchesAlongTheTangent) {
  auto m = default_model<Principled>();
  m.anisotropic = 0.8;
  m.metallic = 1;
  const Vec3d n{0, 0, 1};
  EXPECT_GT(m.eval(n, spherical_direction(0.6, 0.0))[0], 2 * m.eval(n, spherical_direction(0.6, pi / 2))[0]);
}

TEST(Disney2012, TintOfBlackIsWhite) {
  auto m = default_model<Principled>();
  m.base_color = color(0, 0, 0);
  m.sheen = m.sheen_tint = m.specular_tint = 1;
  const auto f = m.eval(spherical_direction(1.2, 0.0), spherical_direction(1.3, 0.5));
  EXPECT_EQ(f[0], f[2]);
  EXPECT_GT(f[0], 0);
}

TEST(Disney2015, ItsGlassIsWaltersWithTheRootOfTheBaseColor) {
  auto m = default_model<Disney2015<double, 3>>();
  m.spec_trans = 1;
  m.eta = 1.4;
  m.base_color = color(0.81, 0.36, 1);
  auto glass = default_model<GgxDielectric<double, 3>>();
  glass.eta = 1.4;
  glass.alpha_x = glass.alpha_y = 0.25;
  glass.separable = 1;
  const Vec3d wo = spherical_direction(0.5, 0.3);
  for (const double theta : {0.1, 0.6, 2.6, 3.0}) {
    const Vec3d wi = spherical_direction(theta, 3.3);
    for (const auto& [o, i] : {std::pair{wo, wi}, std::pair{-wo, wi}, std::pair{wi, wo}})
      for (int c = 0; c < 3; ++c) {
        const double f = glass.eval(o, i)[c] * (o.z * i.z < 0 ? std::sqrt(m.base_color[c]) : 1);
        EXPECT_NEAR(m.eval(o, i)[c], f, 1e-9 * f + 1e-15) << theta;
      }
  }
}

TEST(Disney2015, DiffuseIsLambertWithRetroReflection) { // Burley 2015, eq. 4
  auto m = default_model<Disney2015<double, 3>>();
  const Vec3d wo = spherical_direction(1.2, 0.0), wi = spherical_direction(1.1, 0.4);
  const double with = m.eval(wo, wi)[0];
  m.base_color = color(0, 0, 0);
  const double diffuse = with - m.eval(wo, wi)[0];
  const double cd = dot(wo, normalize(wo + wi)), RR = 2 * 0.5 * cd * cd;
  const double FL = std::pow(1 - wi.z, 5), FV = std::pow(1 - wo.z, 5);
  const double shape = (1 - 0.5 * FL) * (1 - 0.5 * FV) + RR * (FL + FV + FL * FV * (RR - 1));
  EXPECT_NEAR(diffuse, 0.5 / pi * shape, 1e-12);
}

TEST(Disney2015, ThinSurfacesShareTheirDiffuseLight) {
  auto m = default_model<Disney2015Thin<double, 3>>();
  m.diff_trans = 0.6;
  m.base_color = color(0.5, 0.5, 0.5);
  const Vec3d wo{0, 0, 1}, up = spherical_direction(0.3, 0.0);
  EXPECT_NEAR(m.eval(wo, -up)[0], 0.3 * 0.5 / pi, 1e-12);
  m.spec_trans = 1; // what goes through straight is tinted once
  m.eta = 1.5;
  const double straight = m.eval(wo, -wo)[0];
  const Ggx<double> d = disney::facets(0.625 * 0.5, 0.0);
  EXPECT_NEAR(straight, 0.5 * 0.96 * d.D(wo) / 4, 1e-9);
  EXPECT_EQ(m.eval(-wo, wo)[0], straight);
}

} // namespace
} // namespace nacre
