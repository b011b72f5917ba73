#include "fit/lit_sphere.h"

#include "core/image.h"
#include "fit/synthetic.h"

#include <filesystem>
#include <gtest/gtest.h>

namespace nacre {
namespace {

TEST(LitSphere, OfTheSameMaterialDoesNotDiffer) {
  const std::string material = "lambert:reflectance=0.6/0.4/0.1";
  const ImageErrors e = image_errors(tabulate(material), parse_material(material), studio_lights(), 24);
  EXPECT_GT(e.pixels, 300u);
  EXPECT_LT(e.image, 1e-4); // a table has no value between its last node and the horizon
  EXPECT_LT(e.delta_e, 1e-2);
}

TEST(LitSphere, DiffersByWhatTheReflectanceDiffers) {
  const MerlTable table = tabulate("lambert:reflectance=0.5");
  const ImageErrors e = image_errors(table, parse_material("lambert:reflectance=0.6"), studio_lights(), 24);
  EXPECT_NEAR(e.image, 0.2, 1e-3);
  // One white light from the viewer: the middle pixel has Y = rho, the others rho cos theta; between 0.5 and
  // 0.6 lightness differs by 116 (0.6^(1/3) - 0.5^(1/3)) = 5.77 cos^(1/3), 3/4 of which in the mean over the
  // half sphere's picture: integral of cos^(1/3) sin cos 2 dtheta = 6/7.
  const std::vector<DistantLight> frontal{{{0, 0, 1}, {1, 1, 1}}};
  const ImageErrors lit = image_errors(table, parse_material("lambert:reflectance=0.6"), frontal, 64, 89.9);
  EXPECT_NEAR(lit.delta_e, 116 * (std::cbrt(0.6) - std::cbrt(0.5)) * 6 / 7, 0.05);
}

TEST(LitSphere, EnvironmentsKeepTheirLight) {
  // A white sky of radiance 1 with a brighter patch: the lights' irradiances add up to the integral of
  // radiance.
  Image map(64, 32, {"R", "G", "B"});
  double sum = 0;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const float radiance = x > 50 && y < 10 ? 30.0f : 1.0f;
      for (int c = 0; c < 3; ++c)
        map.at(x, y)[c] = radiance;
      sum += double(radiance) * 2 * pi / map.width *
             (std::cos(pi * y / map.height) - std::cos(pi * (y + 1) / map.height));
    }
  const auto path = std::filesystem::temp_directory_path() / "nacre_lit_sphere_test.exr";
  write_exr(map, path.string());
  double kept = 0;
  Vec3d mean{0, 0, 0};
  for (const DistantLight& light : environment_lights(path.string(), 200)) {
    kept += light.irradiance[1];
    mean = mean + light.direction * light.irradiance[1];
  }
  std::filesystem::remove(path);
  EXPECT_NEAR(kept, sum, 1e-9 * sum);
  EXPECT_GT(mean.y, 0); // the patch is above
}

} // namespace
} // namespace nacre
