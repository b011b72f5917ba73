#include "render/lights.h"

#include "core/error.h"
#include "core/warp.h"
#include "small_scenes.h"

namespace nacre {
namespace {

using test::fixed_wavelengths;

std::shared_ptr<Image> noise_map(int width, int height) {
  auto image = std::make_shared<Image>(width, height, std::vector<std::string>{"R", "G", "B"});
  for (std::size_t i = 0; i < image->data.size(); ++i) {
    const float x = uniform(5, 0, i, 0);
    image->data[i] = x * x * x * 4 + (i / 3 == 40 ? 50.0f : 0.0f);
  }
  return image;
}
EnvironmentLight environment(std::shared_ptr<const Image> image) {
  EnvironmentLight light;
  light.radiance = std::move(image);
  light.to_world = Transform::rotate({1, 2, 3}, 77);
  return light;
}

/// A picture of one channel that emits: 2 x 2 texels 1 2 / 3 6 from the top, mean 3.
std::shared_ptr<const Texture> four_texels(TextureUse use, BitmapTexture::Filter filter) {
  Image image(2, 2, {"Y"});
  image.data = {1, 2, 3, 6};
  return std::make_shared<Texture>(
      Texture{BitmapTexture(std::move(image), use, filter, BitmapTexture::Wrap::repeat)});
}

struct Case {
  std::string name;
  Scene scene;
};
/// Scenes around the origin whose lights every direction sampling can find.
std::vector<Case> findable_lights() {
  std::vector<Case> cases;
  const auto add = [&](std::string name, const auto& geometry) {
    Scene s;
    s.shapes.push_back(test::light(geometry, 2));
    s.shapes.back().emission = 2.0f;
    cases.push_back({std::move(name), s});
  };
  add("quad", test::ceiling_at(1, 0.7f));
  add("sphere", test::sphere({0.3f, 0.5f, 1.2f}, 0.6f));
  Sphere around = test::sphere({0.2f, 0, 0.1f}, 3);
  around.flip_normals = true;
  add("sphere from inside", around);
  Disk disk;
  disk.to_world =
      Transform::translate({0.2, 0, 1}) * Transform::rotate({1, 0, 0}, 160) * Transform::scale({1, 0.6, 1});
  add("disk", disk);
  Cylinder cylinder;
  cylinder.to_world =
      Transform::translate({-1, 0.5, 1}) * Transform::rotate({0, 1, 0}, 90) * Transform::scale({0.3, 0.6, 2});
  add("cylinder", cylinder);
  TriangleMesh mesh;
  mesh.positions = {{-1, -1, 1}, {1, -1, 1.3f}, {0, 1, 0.8f}, {1.5f, 1, 1}};
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}};
  add("mesh", mesh);
  const auto picture = four_texels(TextureUse::emission, BitmapTexture::Filter::bilinear);
  mesh.uvs = {{0, 0}, {1, 0}, {0.3f, 1}, {2, 1.5f}};
  add("textured mesh", mesh);
  cases.back().scene.shapes[0].emission = picture;
  add("textured quad", test::ceiling_at(1, 0.7f));
  cases.back().scene.shapes[0].emission = picture;
  Scene constant;
  ConstantLight c;
  c.radiance = SpectrumSource::constant(1.5f);
  constant.lights.push_back(c);
  cases.push_back({"constant", constant});
  Scene map;
  map.lights.push_back(environment(noise_map(16, 9)));
  cases.push_back({"environment", map});
  Scene both = map;
  both.lights.push_back(c);
  both.shapes.push_back(test::light(test::ceiling_at(1, 0.7f), 3));
  cases.push_back({"all at once", both});
  return cases;
}

SampledSpectrum incoming(const World& world, const Ray& ray, float& pdf) {
  Hit hit;
  if (!world.accel.intersect(ray, hit)) {
    pdf = world.lights.background_pdf(ray.direction);
    return world.lights.background(ray.direction, fixed_wavelengths());
  }
  const Surface s = world.surfaces.at(ray, hit);
  pdf = world.lights.pdf(ray.origin, s);
  return world.lights.emitted(s, -ray.direction, fixed_wavelengths());
}

TEST(LightSet, SampledAndUniformDirectionsGiveTheSameIrradiance) {
  for (const Case& c : findable_lights()) {
    SCOPED_TRACE(c.name);
    const World world(c.scene);
    RunningMoments by_light, by_direction;
    for (int i = 0; i < 60000; ++i) {
      IndependentSampler sampler(11, 0, std::uint32_t(i));
      const float u_light = sampler.next_1d();
      const LightSample s = world.lights.sample({0, 0, 0}, u_light, sampler.next_2d(), fixed_wavelengths());
      double value = 0;
      if (s.pdf > 0) {
        Ray shadow;
        shadow.direction = s.direction, shadow.t_max = s.distance * (1 - 1e-4f);
        if (!world.accel.occluded(shadow))
          value = double(s.radiance[0]) * std::max(0.0f, s.direction.z) / double(s.pdf);
      }
      by_light.add(value);
      Ray ray;
      ray.direction = square_to_cosine_hemisphere(sampler.next_2d());
      float pdf = 0;
      by_direction.add(double(incoming(world, ray, pdf)[0]) * pi);
    }
    EXPECT_GT(by_light.mean(), 0.05);
    EXPECT_NEAR(by_light.mean(), by_direction.mean(),
                4 * std::hypot(by_light.standard_error(), by_direction.standard_error()) + 1e-5);
  }
}

TEST(LightSet, DensityOfASampleIsTheDensityOfHittingIt) {
  for (const Case& c : findable_lights()) {
    SCOPED_TRACE(c.name);
    const World world(c.scene);
    int compared = 0;
    for (int i = 0; i < 500; ++i) {
      IndependentSampler sampler(12, 0, std::uint32_t(i));
      const float u_light = sampler.next_1d();
      const LightSample s = world.lights.sample({0, 0, 0}, u_light, sampler.next_2d(), fixed_wavelengths());
      if (!(s.pdf > 0)) continue;
      Ray ray;
      ray.direction = s.direction;
      Hit hit;
      const bool found = world.accel.intersect(ray, hit);
      if (found != std::isfinite(s.distance) || (found && std::abs(hit.t - s.distance) > 1e-3f)) continue;
      float pdf = 0;
      const SampledSpectrum Le = incoming(world, ray, pdf);
      ++compared;
      // Densities jump between the cells of a map; a direction may round over a border.
      if (std::abs(pdf - s.pdf) > 1e-2f * s.pdf) --compared;
      EXPECT_NEAR(Le[1], s.radiance[1], 2e-3f * std::max(1.0f, s.radiance[1]));
    }
    EXPECT_GT(compared, 150); // of the others some lie behind their light or on the border of a cell
  }
}

TEST(LightChoice, IsMadeWithTheProbabilityItStates) {
  std::vector<LightSummary> lights{{1, false, {0, 0, 2}, 0},
                                   {0, false, {1, 0, 0}, 0.5f},
                                   {7, true, {0, 0, 0}, 0},
                                   {20, false, {4, 0, 0}, 1},
                                   {0, true, {0, 0, 0}, 0}};
  for (const bool many : {false, true}) {
    if (many) lights.resize(100, {0.2, false, {5, 5, 5}, 1});
    const LightChoice choice(lights);
    for (const Vec3f& p : {Vec3f{0, 0, 1.9f}, Vec3f{3, 0, 0}, Vec3f{0, 0, 2}, Vec3f{1e18f, 0, 0}}) {
      std::vector<int> chosen(lights.size());
      constexpr int n = 1 << 16;
      for (int i = 0; i < n; ++i)
        ++chosen[std::size_t(choice.sample(p, (float(i) + 0.5f) / n))];
      double sum = 0;
      for (std::size_t i = 0; i < lights.size(); ++i) {
        const double probability = choice.probability(int(i), p);
        sum += probability;
        // Each light's share is one or two intervals of u: they hold as many samples but two at each end.
        EXPECT_NEAR(chosen[i], n * probability, 4.1) << i;
        EXPECT_GT(probability, 1e-3);
        if (lights[i].is_far) {
          EXPECT_EQ(float(probability), choice.far_probability(int(i)));
        }
      }
      EXPECT_NEAR(sum, 1, 1e-5);
    }
    if (!many) { // near a weak lamp it is the one to ask
      EXPECT_GT(choice.probability(0, {0, 0, 1.9f}), 2 * choice.probability(3, {0, 0, 1.9f}));
      EXPECT_LT(choice.probability(0, {3, 0, 0}), choice.probability(3, {3, 0, 0}));
    }
  }
}

TEST(TexturedAreaLight, SeenFromAfarIsItsMeanRadiance) {
  const SampledSpectrum daylight = SpectrumSource::d65(1).eval(fixed_wavelengths());
  Scene scene;
  scene.shapes.push_back(test::light(test::ceiling_at(1, 0.005f), 0));
  scene.shapes[0].emission = four_texels(TextureUse::emission, BitmapTexture::Filter::bilinear);
  const World world(scene);
  RunningMoments irradiance;
  for (int i = 0; i < 20000; ++i) {
    IndependentSampler sampler(21, 0, std::uint32_t(i));
    const float u_light = sampler.next_1d();
    const LightSample s = world.lights.sample({0, 0, 0}, u_light, sampler.next_2d(), fixed_wavelengths());
    irradiance.add(double(s.radiance[0] * s.direction.z / s.pdf));
  }
  // The mean texel is 3, the solid angle 1e-4 but for 1e-4 of itself.
  EXPECT_NEAR(irradiance.mean(), 3e-4 * daylight[0],
              4 * irradiance.standard_error() + 2e-4 * irradiance.mean());
}

TEST(SpotLight, ProjectsItsPicture) {
  Scene scene;
  SpotLight spot;
  spot.to_world = Transform::look_at({1, 2, 3}, {1, 2, 0}, {0, 1, 0});
  spot.intensity = SpectrumSource::constant(7);
  spot.cutoff_rad = float(40 * pi / 180), spot.beam_width_rad = float(20 * pi / 180);
  spot.picture = four_texels(TextureUse::reflectance, BitmapTexture::Filter::nearest);
  scene.lights.push_back(spot);
  const World world(scene);
  // u grows along the light's +x and v along its +y; the first texel is that of (0, 0).
  struct Spot {
    double x, y, texel;
  };
  for (const Spot& at : {Spot{-0.2, -0.2, 1}, {0.2, -0.2, 2}, {-0.2, 0.2, 3}, {0.5, 0.3, 6}}) {
    const Vec3d p = spot.to_world.point({2 * at.x, 2 * at.y, 2});
    const LightSample s = world.lights.sample(vec3<float>(p), 0.5f, {0.5f, 0.5f}, fixed_wavelengths());
    const double tangent = std::hypot(at.x, at.y), degrees = std::atan(tangent) * 180 / pi;
    const double falloff = degrees < 20 ? 1 : (40 - degrees) / 20, r2 = 4 * (1 + tangent * tangent);
    EXPECT_NEAR(s.radiance[0] / s.pdf, 7 * at.texel * falloff / r2, 1e-4) << at.x << ", " << at.y;
    EXPECT_NEAR(s.distance, std::sqrt(r2), 1e-5);
  }
}

TEST(ProjectorLight, ShowsItsPictureOnAScreen) {
  const SampledSpectrum daylight = SpectrumSource::d65(1).eval(fixed_wavelengths());
  Image image(2, 1, {"Y"});
  image.data = {1, 4};
  ProjectorLight projector;
  projector.lens.to_world = Transform::look_at({1, 2, 3}, {1, 2, 0}, {0, 1, 0});
  projector.lens.fov_deg = 90; // across: the screen at distance 1 is 2 x 1
  projector.scale = 0.5f;
  projector.picture = std::make_shared<Texture>(Texture{BitmapTexture(
      image, TextureUse::emission, BitmapTexture::Filter::nearest, BitmapTexture::Wrap::repeat)});
  Scene scene;
  scene.lights.push_back(projector);
  const World world(scene);
  const auto irradiance = [&](double x, double y, double z) { // on a screen that faces the projector
    const Vec3d p = projector.lens.to_world.point({x, y, z});
    const LightSample s = world.lights.sample(vec3<float>(p), 0.5f, {0.5f, 0.5f}, fixed_wavelengths());
    return s.pdf > 0 ? double(s.radiance[0] / s.pdf) * std::abs(double(s.direction.z)) : 0.0;
  };
  // +x is left, as in a camera: there the picture begins. pi E of radiance E, the same all over a texel.
  const double unit = pi * 0.5 * double(daylight[0]);
  for (const double y : {-0.45, 0.0, 0.3}) {
    EXPECT_NEAR(irradiance(0.1, y, 1), unit, 1e-4 * unit);
    EXPECT_NEAR(irradiance(0.9, y, 1), unit, 1e-4 * unit);
    EXPECT_NEAR(irradiance(-0.7, y, 1), 4 * unit, 4e-4 * unit);
  }
  EXPECT_NEAR(irradiance(0.2, 0.2, 2), unit / 4, 1e-4 * unit);
  EXPECT_EQ(irradiance(0.1, 0.55, 1), 0);
  EXPECT_EQ(irradiance(-1.05, 0, 1), 0);
  EXPECT_EQ(irradiance(0.1, 0.1, -1), 0);
  // Power: 2.5 unit on average over an area of 2, in luminance.
  EXPECT_NEAR(ProjectorBeam(projector).power(), pi * 0.5 * 2.5 * 2, 1e-5);
}

TEST(EnvironmentMap, DensityIntegratesToOne) {
  const EnvironmentMap map(environment(noise_map(32, 17)));
  RunningMoments sum;
  for (int i = 0; i < 200000; ++i) {
    const Vec3f d =
        square_to_sphere(Vec2f{uniform(4, 0, std::uint64_t(i), 0), uniform(4, 0, std::uint64_t(i), 1)});
    sum.add(double(map.pdf(d)) * 4 * pi);
  }
  EXPECT_NEAR(sum.mean(), 1, 4 * sum.standard_error());
}

TEST(EnvironmentMap, FollowsMitsubasOrientation) {
  // Up +y; the left border of the image lies at -z, a quarter further is +x.
  auto image = std::make_shared<Image>(64, 33, std::vector<std::string>{"R", "G", "B"});
  for (int y = 0; y < 33; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c)
        image->at(x, y)[c] = y < 8 ? 10.0f : x >= 12 && x < 20 ? 5.0f : 1.0f;
  EnvironmentLight light;
  light.radiance = image;
  const EnvironmentMap map(light);
  const auto brightness = [&](Vec3f d) {
    return map.radiance(d, fixed_wavelengths())[1] / map.radiance({0, -1, 0}, fixed_wavelengths())[1];
  };
  EXPECT_NEAR(brightness({0, 1, 0}), 10, 1e-3f);
  EXPECT_NEAR(brightness({1, 0, 0}), 5, 1e-3f);
  EXPECT_NEAR(brightness({-1, 0, 0}), 1, 1e-3f);
  EXPECT_NEAR(brightness({0, 0, 1}), 1, 1e-3f);
}

TEST(EnvironmentMap, OfOneColourIsAConstantLight) {
  auto image = std::make_shared<Image>(8, 5, std::vector<std::string>{"R", "G", "B"});
  for (float& x : image->data)
    x = 2;
  const EnvironmentMap map(environment(image));
  const SampledSpectrum expected = SpectrumSource::d65(2).eval(fixed_wavelengths());
  for (int i = 0; i < 100; ++i) {
    const Vec3f d =
        square_to_sphere(Vec2f{uniform(4, 0, std::uint64_t(i), 0), uniform(4, 0, std::uint64_t(i), 1)});
    const SampledSpectrum L = map.radiance(d, fixed_wavelengths());
    for (int c = 0; c < 4; ++c)
      EXPECT_NEAR(L[c], expected[c], 1e-3f * expected[c]);
  }
}

TEST(EnvironmentMap, RefusesWhatIsNotAMap) {
  auto image = std::make_shared<Image>(8, 5, std::vector<std::string>{"R", "G", "B"});
  image->at(3, 2)[1] = std::nanf("");
  EXPECT_THROW(EnvironmentMap(environment(image)), Error);
  EXPECT_THROW(
      EnvironmentMap(environment(std::make_shared<Image>(1, 1, std::vector<std::string>{"R", "G", "B"}))),
      Error);
  EnvironmentLight skewed = environment(noise_map(8, 5));
  skewed.to_world.m[0][1] = 1;
  EXPECT_THROW(EnvironmentMap{skewed}, Error);
}

} // namespace
} // namespace nacre
