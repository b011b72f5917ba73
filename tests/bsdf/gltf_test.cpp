#include "bsdf/models/gltf.h"

#include "core/quadrature.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

using Material = Gltf<double, 3>;
using Rgb = Spectrum<double, 3>;

const Vec3d wo = spherical_direction(0.6, 0.2), wi = spherical_direction(1.0, 2.5);

Material dielectric() {
  auto m = default_model<Material>();
  m.metallic = 0;
  m.base_color = Rgb({0.8, 0.4, 0.1});
  m.roughness = 0.5;
  return m;
}

/// Appendix B.3.2 as it is written: D and V of Trowbridge-Reitz in N.H.
double specular_brdf(double alpha, const Vec3d& v, const Vec3d& l) {
  const double nh = normalize(v + l).z, a2 = alpha * alpha;
  const double D = a2 / (pi * sqr(nh * nh * (a2 - 1) + 1));
  const auto half = [&](double n) { return 1 / (n + std::sqrt(a2 + (1 - a2) * n * n)); };
  return D * half(v.z) * half(l.z);
}
double schlick(double f0, double c) { return f0 + (1 - f0) * std::pow(1 - c, 5); }
double v_dot_h(const Vec3d& v, const Vec3d& l) { return dot(v, normalize(v + l)); }

TEST(Gltf, CoreIsAppendixB) {
  auto m = dielectric();
  const double s = specular_brdf(0.25, wo, wi), c = v_dot_h(wo, wi), F = schlick(0.04, c);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(m.eval(wo, wi)[i], (1 - F) * m.base_color[i] / pi + F * s, 1e-12);
  m.metallic = 0.3;
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(m.eval(wo, wi)[i],
                0.7 * ((1 - F) * m.base_color[i] / pi + F * s) + 0.3 * schlick(m.base_color[i], c) * s,
                1e-12);
}

TEST(Gltf, SpecularAndIorAreTheirExtensions) {
  auto m = dielectric();
  m.ior = 1.8;
  m.specular = 0.6;
  m.specular_color = Rgb({1, 0.5, 0.2});
  const double s = specular_brdf(0.25, wo, wi), c = v_dot_h(wo, wi), f0 = sqr(0.8 / 2.8);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(m.eval(wo, wi)[i],
                (1 - 0.6 * schlick(f0, c)) * m.base_color[i] / pi +
                    0.6 * schlick(f0 * m.specular_color[i], c) * s,
                1e-12);
}

TEST(Gltf, ClearcoatMixesByTheViewersAngle) {
  auto m = dielectric();
  const double bare = m.eval(wo, wi)[0];
  m.clearcoat = 0.8;
  m.clearcoat_roughness = 0.3;
  const double share = 0.8 * schlick(0.04, wo.z);
  EXPECT_NEAR(m.eval(wo, wi)[0], (1 - share) * bare + share * specular_brdf(0.09, wo, wi), 1e-12);
}

TEST(Gltf, SheenScalesWhatLiesBelow) {
  auto m = dielectric();
  const double bare = m.eval(wo, wi)[1];
  m.sheen_color = Rgb({0.2, 0.9, 0.5});
  m.sheen_roughness = 0.6;
  auto charlie = default_model<Charlie<double, 1>>();
  charlie.roughness = 0.36;
  charlie.softened = 0;
  const auto E = [](double z) { return CharlieAlbedo::table()(z, 0.36); };
  EXPECT_NEAR(m.eval(wo, wi)[1],
              0.9 * charlie.eval(wo, wi)[0] + bare * std::min(1 - 0.9 * E(wo.z), 1 - 0.9 * E(wi.z)), 1e-12);
}

TEST(Gltf, CharlieAlbedoIsItsIntegral) {
  for (const double roughness : {0.06, 0.2, 0.37, 0.8})
    for (const double z : {0.05, 0.3, 0.7, 0.97}) {
      auto charlie = default_model<Charlie<double, 1>>();
      charlie.roughness = roughness;
      charlie.softened = 0;
      const Vec3d w{std::sqrt(1 - z * z), 0, z};
      const double E =
          integrate_hemisphere([&](const Vec3d& i) { return charlie.eval(w, i)[0] * i.z; }, 150, 150);
      EXPECT_NEAR(CharlieAlbedo::table()(z, roughness), E, 0.005) << roughness << " " << z;
    }
}

TEST(Gltf, TransmissionIsTheMirrorLobeTurnedBelow) {
  auto m = dielectric();
  m.transmission = 0.7;
  m.specular = 0; // no Fresnel: the BTDF alone
  const Vec3d below{wi.x, wi.y, -wi.z};
  EXPECT_NEAR(m.eval(wo, below)[1], 0.7 * 0.4 * specular_brdf(0.25, wo, wi), 1e-12);
  EXPECT_NEAR(m.eval(wo, wi)[1], 0.3 * 0.4 / pi, 1e-12);
  m.diffuse_transmission = 0.25;
  m.diffuse_transmission_color = Rgb(0.9);
  EXPECT_NEAR(m.eval(wo, below)[1], 0.7 * 0.4 * specular_brdf(0.25, wo, wi) + 0.3 * 0.25 * 0.9 / pi, 1e-12);
}

TEST(Gltf, AnisotropyRoughensAlongTheTangent) {
  auto m = default_model<Material>();
  m.roughness = 0.4;
  const Vec3d n{0, 0, 1}, along = spherical_direction(0.8, 0.0), across = spherical_direction(0.8, pi / 2);
  const double before = m.eval(n, across)[0];
  EXPECT_NEAR(m.eval(n, along)[0], before, 1e-12);
  m.anisotropy = 0.7;
  EXPECT_GT(m.eval(n, along)[0], 4 * before);
}

TEST(Gltf, TheAnisotropysRotationTurnsTheSurface) {
  auto m = default_model<Material>(), turned = m;
  m.roughness = turned.roughness = 0.4;
  m.anisotropy = turned.anisotropy = 0.7;
  turned.anisotropy_rotation = 0.5;
  for (const double phi : {0.0, 1.0, 2.5}) {
    const Vec3d viewer = spherical_direction(0.4, phi), light = spherical_direction(0.8, phi + 2),
                viewer_turned = spherical_direction(0.4, phi + 0.5),
                light_turned = spherical_direction(0.8, phi + 2.5);
    EXPECT_NEAR(turned.eval(viewer_turned, light_turned)[0], m.eval(viewer, light)[0], 1e-12);
    EXPECT_NEAR(turned.pdf(viewer_turned, light_turned), m.pdf(viewer, light), 1e-12);
    const auto s = m.sample(viewer, 0.3, {0.2, 0.7}), s_t = turned.sample(viewer_turned, 0.3, {0.2, 0.7});
    EXPECT_NEAR(s_t.wi.x, std::cos(0.5) * s.wi.x - std::sin(0.5) * s.wi.y, 1e-12);
    EXPECT_NEAR(s_t.pdf, s.pdf, 1e-12);
  }
}

TEST(Gltf, AFilmOfNoThicknessIsNoFilm) {
  auto m = default_model<Material>();
  m.base_color = Rgb({0.5, 0.2, 0.04});
  m.iridescence = 1;
  m.iridescence_thickness = 0;
  const Vec3d n{0, 0, 1};
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(m.eval(n, n)[i], m.base_color[i] * specular_brdf(1, n, n), 1e-9);
}

} // namespace
} // namespace nacre
