#include "bsdf/models/frostbite.h"
#include "bsdf/models/unreal.h"

#include "core/quadrature.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

const Vec3d wo = spherical_direction(0.7, 0.2), wi = spherical_direction(1.1, 2.4), wm = normalize(wo + wi);

TEST(Unreal, IsKarissFormulas) {
  auto m = default_model<Unreal<double, 1>>();
  m.roughness = 0.4;
  m.base_color[0] = 0.3;
  const double c = dot(wo, wm), a2 = std::pow(0.4, 4), k = sqr(1.4) / 8;
  const double D = a2 / (pi * sqr(wm.z * wm.z * (a2 - 1) + 1));
  const auto G1 = [&](double z) { return z / (z * (1 - k) + k); };
  const double F = 0.04 + 0.96 * std::pow(2, (-5.55473 * c - 6.98316) * c);
  const double specular = D * F * G1(wo.z) * G1(wi.z) / (4 * wo.z * wi.z);
  EXPECT_NEAR(m.eval(wo, wi)[0], 0.3 / pi + specular, 1e-12);
  m.metallic = 1;
  m.base_color[0] = 0.04;
  EXPECT_NEAR(m.eval(wo, wi)[0], specular, 1e-12);
}

TEST(Frostbite, IsLagardesAndRousierssListings) {
  auto m = default_model<Frostbite<double, 1>>();
  m.roughness = 0.8;
  m.reflectance = 0.2; // 0.0064: the grazing reflectance fades below 2 %
  m.base_color[0] = 0.7;
  const double c = dot(wo, wm), alpha = 0.64, a2 = alpha * alpha, f0 = 0.16 * 0.04;
  const auto schlick = [](double f0_, double f90, double u) {
    return f0_ + (f90 - f0_) * std::pow(1 - u, 5);
  };
  const double f90 = 0.5 * 0.8 + 2 * c * c * 0.8, factor = 1 + 0.8 * (1 / 1.51 - 1);
  const double diffuse = schlick(1, f90, wi.z) * schlick(1, f90, wo.z) * factor;
  const double V = 0.5 / (wi.z * std::sqrt((wo.z - a2 * wo.z) * wo.z + a2) +
                          wo.z * std::sqrt((wi.z - a2 * wi.z) * wi.z + a2));
  const double D = a2 / (pi * sqr((wm.z * a2 - wm.z) * wm.z + 1));
  EXPECT_NEAR(m.eval(wo, wi)[0], 0.7 / pi * diffuse + schlick(f0, 50 * f0, c) * V * D, 1e-12);
}

// What the renormalisation is for: a white surface gains hardly any energy, at the price of losing some.
TEST(Frostbite, AWhiteSurfaceReflectsNoMoreThanItReceives) {
  auto m = default_model<Frostbite<double, 1>>();
  m.base_color[0] = 1;
  for (const double roughness : {0.1, 0.5, 1.0})
    for (const double z : {0.2, 0.6, 1.0}) {
      m.roughness = roughness;
      const Vec3d w{std::sqrt(1 - z * z), 0, z};
      const double E = integrate_hemisphere([&](const Vec3d& i) { return m.eval(w, i)[0] * i.z; }, 200, 200);
      EXPECT_LT(E, 1.03) << roughness << " " << z;
      EXPECT_GT(E, 0.65) << roughness << " " << z;
    }
}

} // namespace
} // namespace nacre
