#include "report/material_images.h"

#include "core/error.h"
#include "core/warp.h"
#include "report/material_plots.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

/// The local directions of a pixel of a sphere: north is up, tangents point east.
struct PixelDirections {
  Vec3d wo, wi;
};
PixelDirections of_pixel(int px, int py, int size, const SphereLight& light) {
  const double x = (px + 0.5 - 0.5 * size) * 2.04 / size, y = (0.5 * size - py - 0.5) * 2.04 / size;
  const double theta = light.theta_deg * pi / 180, phi = light.phi_deg * pi / 180;
  const Vec3d to_light{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
  const double z2 = 1 - x * x - y * y;
  if (z2 <= 0) return {{0, 0, -1}, {0, 0, -1}};
  const Vec3d n{x, y, std::sqrt(z2)}, east = normalize(Vec3d{n.z, 0, -n.x}), north = cross(n, east);
  return {{east.z, north.z, n.z}, {dot(east, to_light), dot(north, to_light), dot(n, to_light)}};
}

void expect_sphere_of_evaluations(const std::string& text, const SphereLight& light) {
  constexpr int size = 61; // no multiple of a pack's width
  const MaterialSpec material = parse_material(text);
  const auto reference = make_bsdf<double>(material);
  const Image image = lit_sphere(material, size, light);
  int lit = 0;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const auto [wo, wi] = of_pixel(x, y, size, light);
      const bool seen = wo.z > 0 && wi.z > 0;
      lit += seen;
      if (std::abs(wi.z) < 1e-5) continue; // the terminator is on either side in float
      for (int c = 0; c < 3; ++c) {
        const double expected = seen ? reference.eval(wo, wi)[c] * pi * (light.cosine ? wi.z : 1) : 0;
        EXPECT_NEAR(image.at(x, y)[c], expected, 2e-4 * (1 + expected)) << text << " " << x << "," << y;
      }
    }
  EXPECT_GT(lit, size * size / 3);
}

TEST(LitSphere, PixelsAreTheDoublePrecisionValuesAtTheirDirections) {
  expect_sphere_of_evaluations("ggx_plastic:diffuse_reflectance=0.05/0.2/0.5,alpha=0.3", {});
  expect_sphere_of_evaluations("lambert:reflectance=0.2/0.4/0.8", {10, -30, false});
}

TEST(LitSphere, TangentsPointEast) {
  expect_sphere_of_evaluations("ward:specular_reflectance=0.5,alpha_x=0.1,alpha_y=0.6", {});
  expect_sphere_of_evaluations("ward:specular_reflectance=0.5,alpha_x=0.6,alpha_y=0.1", {60, 20, true});
}

TEST(LitSphere, StochasticModelsAreTheSameInPacks) {
  // The mean over the sphere: noise of single pixels differs.
  constexpr int size = 64;
  const MaterialSpec material = parse_material("walk_ggx_dielectric:alpha_x=0.4,alpha_y=0.4,walks=4");
  const auto reference = make_bsdf<double>(material);
  const Image image = lit_sphere(material, size);
  double sum = 0, expected = 0;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const auto [wo, wi] = of_pixel(x, y, size, {});
      sum += image.at(x, y)[0];
      if (wo.z > 0 && wi.z > 0) expected += reference.eval(wo, wi)[0] * pi * wi.z;
    }
  EXPECT_NEAR(sum / expected, 1, 0.05);
}

TEST(WhiteFurnace, WhiteLambertCannotBeSeen) {
  const std::array<double, 2> values{0, 0.5};
  const Image strip = white_furnace(parse_material("oren_nayar:reflectance=1"), "sigma", values, 48);
  ASSERT_EQ(strip.width, 96);
  bool darker = false;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 96; ++x) {
      const float albedo = strip.at(x, y)[0];
      EXPECT_TRUE(x >= 48 || std::abs(albedo - 1) < 1e-3) << x << "," << y; // sigma = 0 is Lambert
      darker |= x >= 48 && albedo < 0.97;
    }
  EXPECT_TRUE(darker); // sigma = 0.5 loses light
}

TEST(WhiteFurnace, CenterAndRimHoldTheAlbedoThere) {
  const MaterialSpec metal = parse_material("ggx_conductor:eta=0.01,k=30");
  const std::array<double, 1> values{1};
  constexpr int size = 100;
  const Image strip = white_furnace(metal, "alpha", values, size);
  const MaterialSpec rough = with_parameter(metal, "alpha", 1);
  EXPECT_NEAR(strip.at(50, 50)[0], sampled_albedo(rough, 0)[0], 3e-3);
  EXPECT_LT(strip.at(50, 50)[0], 0.35);
  const double sine = (88 + 0.5 - 50) / 45; // of the pixel 38.5 right of the centre
  EXPECT_NEAR(strip.at(88, 50)[0], sampled_albedo(rough, std::asin(sine))[0], 5e-3);
}

TEST(WithParameter, SetsBothAxesAndChecksTheDomain) {
  const MaterialSpec metal = parse_material("ggx_conductor");
  EXPECT_EQ(roughness_parameter(metal), "alpha");
  const MaterialSpec rough = with_parameter(metal, "alpha", 0.7);
  const ModelInfo& model = find_model("ggx_conductor");
  EXPECT_EQ(rough.lobes[0].values[model.parameter_index("alpha_x")][0], 0.7);
  EXPECT_EQ(rough.lobes[0].values[model.parameter_index("alpha_y")][0], 0.7);
  EXPECT_EQ(parameter_domain(metal, "alpha")[1], 1);
  EXPECT_THROW(with_parameter(metal, "alpha", 1.5), Error);
  EXPECT_THROW(with_parameter(metal, "alfa", 0.5), Error);
  EXPECT_THROW(roughness_parameter(parse_material("lambert")), Error);
}

TEST(ImageSlice, PixelsAreValuesAtTheirHalfAndDifferenceAngles) {
  constexpr int size = 37;
  const MaterialSpec material = parse_material("ggx_schlick:f0=0.9/0.6/0.3,alpha=0.5");
  const auto reference = make_bsdf<double>(material);
  for (const bool square_root : {true, false}) {
    const Image image = image_slice(material, size, {.square_root = square_root});
    int above = 0;
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const double u = (x + 0.5) / size, theta_h = (square_root ? u * u : u) * pi / 2;
        const double theta_d = (1 - (y + 0.5) / size) * pi / 2;
        const Vec3d h{std::sin(theta_h), 0, std::cos(theta_h)}, across{0, 1, 0}; // phi_d = 90 degrees
        const Vec3d wi = std::cos(theta_d) * h + std::sin(theta_d) * across;
        const Vec3d wo = std::cos(theta_d) * h - std::sin(theta_d) * across;
        above += wi.z > 0;
        for (int c = 0; c < 3; ++c) {
          const double expected = reference.eval(wo, wi)[c];
          EXPECT_NEAR(image.at(x, y)[c], expected, 1e-3 * (1e-3 + expected)) << x << "," << y;
        }
      }
    EXPECT_EQ(above, size * size);
  }
}

} // namespace
} // namespace nacre
