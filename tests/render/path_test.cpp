#include "render/path.h"

#include "core/error.h"
#include "core/parallel.h"
#include "render/render.h"
#include "small_scenes.h"

namespace nacre {
namespace {

using test::lambert;
using test::light;
using test::look_down;
using test::material;
using test::radiance;
using test::shape;

/// A Lambertian floor of albedo 0.6 through the origin.
Scene floor_scene() {
  Scene s;
  s.materials.push_back(lambert(0.6f));
  s.shapes.push_back(shape(test::floor_at(0, 10), 0));
  s.integrator.max_depth = 2;
  return s;
}
void expect_irradiance(const Scene& scene, double irradiance, int samples = 20000) {
  const RunningMoments L = radiance(scene, look_down(), samples);
  const double expected = irradiance * 0.6 / pi;
  // Rounding of single-precision directions and positions is some 1e-6 of the value.
  EXPECT_NEAR(L.mean(), expected, 4 * L.standard_error() + 1e-5 * expected);
  EXPECT_LT(L.standard_error(), 0.01 * expected);
}

TEST(PointLights, FollowTheInverseSquareLaw) {
  Scene s = floor_scene();
  s.lights.push_back(PointLight{{1, 0, 2}, SpectrumSource::constant(30)});
  expect_irradiance(s, 30 * (2 / std::sqrt(5.0)) / 5, 10);
}

TEST(DirectionalLights, FollowTheCosine) {
  Scene s = floor_scene();
  s.lights.push_back(DirectionalLight{normalize(Vec3f{1, 1, -2}), SpectrumSource::constant(3)});
  expect_irradiance(s, 3 * 2 / std::sqrt(6.0), 10);
}

TEST(SpotLights, FallLinearlyBetweenBeamAndCutoff) {
  for (const double angle_deg : {5.0, 15.0, 25.0}) {
    Scene s = floor_scene();
    SpotLight spot;
    // Its axis passes the origin at angle_deg.
    spot.to_world = Transform::look_at({0, 0, 2}, {2 * std::tan(angle_deg * pi / 180), 0, 0}, {0, 1, 0});
    spot.intensity = SpectrumSource::constant(7);
    spot.beam_width_rad = float(10 * pi / 180);
    spot.cutoff_rad = float(20 * pi / 180);
    s.lights.push_back(spot);
    const double falloff = angle_deg < 10 ? 1 : angle_deg < 20 ? 0.5 : 0;
    const RunningMoments L = radiance(s, look_down(), 10);
    EXPECT_NEAR(L.mean(), falloff * 7 / 4 * 0.6 / pi, 1e-4);
  }
}

/// Lambert's formula: irradiance of a polygon of radiance 1 on a plane through the origin with normal +z, all
/// corners above it, from the angles its edges subtend (Lambert 1760; Arvo 1994).
double polygon_irradiance(const std::vector<Vec3d>& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d a = normalize(corners[i]), b = normalize(corners[(i + 1) % corners.size()]);
    sum += std::acos(dot(a, b)) * normalize(cross(a, b)).z;
  }
  return std::abs(0.5 * sum);
}

TEST(PolygonLight, MatchesLambertsFormula) {
  const double expected =
      4 * polygon_irradiance({{-0.5, -0.2, 1}, {1.0, -0.2, 1}, {1.0, 0.9, 1}, {-0.5, 0.9, 1}});
  Scene quad = floor_scene();
  quad.shapes.push_back(light(Quad{{-0.5f, -0.2f, 1}, {0, 1.1f, 0}, {1.5f, 0, 0}}, 4));
  expect_irradiance(quad, expected);
  TriangleMesh mesh;
  mesh.positions = {{-0.5f, -0.2f, 1}, {1, -0.2f, 1}, {1, 0.9f, 1}, {-0.5f, 0.9f, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  Scene triangles = floor_scene();
  triangles.shapes.push_back(light(mesh, 4));
  expect_irradiance(triangles, expected);
}

TEST(PolygonLight, ShinesOnTheSideOfItsNormalAlone) {
  Scene s = floor_scene();
  s.shapes.push_back(light(test::floor_at(1, 0.4f), 4)); // normal +z: away from the floor
  EXPECT_EQ(radiance(s, look_down(), 100).mean(), 0);
}

TEST(SphereLight, MatchesTheSolidAngleFormula) {
  // A sphere wholly above the horizon: E = pi L (r/d)^2 cos(theta).
  Scene s = floor_scene();
  s.shapes.push_back(light(test::sphere({1, 0, 2}, 0.5f), 4));
  expect_irradiance(s, pi * 4 * 0.25 / 5 * (2 / std::sqrt(5.0)));
}

TEST(SphereLight, MatchesTheFormulaFarAway) {
  Scene s = floor_scene();
  s.shapes.push_back(light(test::sphere({0, 3000, 4000}, 2), 1e6f));
  expect_irradiance(s, pi * 1e6 * 4 / 25e6 * 0.8, 2000);
}

TEST(DiskLight, MatchesTheViewFactor) {
  // Centred above the point: E = pi L R^2 / (R^2 + h^2).
  Scene s = floor_scene();
  Disk disk;
  disk.to_world =
      Transform::translate({0, 0, 2}) * Transform::rotate({1, 0, 0}, 180) * Transform::scale({0.8, 0.8, 1});
  s.shapes.push_back(light(disk, 4));
  expect_irradiance(s, pi * 4 * 0.64 / 4.64);
}

TEST(Furnace, WhiteSphereVanishes) {
  Scene s;
  s.materials.push_back(lambert(1));
  s.shapes.push_back(shape(test::sphere({0, 0, 0}, 1), 0));
  ConstantLight c;
  c.radiance = SpectrumSource::constant(1);
  s.lights.push_back(c);
  s.integrator.max_depth = 1000;
  const RunningMoments L = radiance(s, look_down(3), 200000);
  EXPECT_LT(4 * L.standard_error(), 4e-3);
  EXPECT_NEAR(L.mean(), 1, 4 * L.standard_error());
}

TEST(Furnace, WhiteSceneWithCavitiesVanishes) {
  Scene s;
  s.materials.push_back(lambert(1));
  s.materials[0].two_sided = true;
  s.shapes.push_back(shape(test::floor_at(0, 2), 0));
  s.shapes.push_back(shape(test::ceiling_at(1, 2), 0)); // what enters between them bounces for long
  Cylinder tube;
  s.shapes.push_back(shape(tube, 0));
  ConstantLight c;
  c.radiance = SpectrumSource::constant(1);
  s.lights.push_back(c);
  Ray ray;
  ray.origin = {0, -5, 0.5f};
  ray.direction = normalize(Vec3f{0.05f, 1, 0.02f});
  const RunningMoments L = radiance(s, ray, 60000);
  EXPECT_LT(L.standard_error(), 0.01);
  EXPECT_NEAR(L.mean(), 1, 4 * L.standard_error());
}

TEST(Furnace, SmoothGlassVanishesAndRoughGlassNearly) {
  ConstantLight c;
  c.radiance = SpectrumSource::constant(1);
  Scene s;
  s.lights.push_back(c);
  s.materials.push_back(material(test::lobe("smooth_dielectric")));
  s.shapes.push_back(shape(test::sphere({0, 0, 0}, 1), 0));
  Ray ray = look_down();
  ray.origin = {0.6f, 0.3f, 3};
  ray.direction = {0, 0, -1};
  const RunningMoments smooth = radiance(s, ray, 20000);
  EXPECT_NEAR(smooth.mean(), 1, 4 * smooth.standard_error() + 1e-4);
  // Facets of single scattering lose what would bounce among them: little at this roughness, and never a
  // gain.
  s.materials[0] = material(test::lobe("ggx_dielectric", {{"alpha_x", 0.05f}, {"alpha_y", 0.05f}}));
  const RunningMoments rough = radiance(s, ray, 40000);
  EXPECT_GT(rough.mean(), 0.985);
  EXPECT_LT(rough.mean(), 1 + 4 * rough.standard_error());
}

TEST(Furnace, ClosedBoxMultipliesEmissionByTheGeometricSeries) {
  // Inside a sphere of albedo rho that emits Le everywhere, L = Le / (1 - rho).
  Scene s;
  s.materials.push_back(lambert(0.5f));
  Sphere inside = test::sphere({1, 2, 3}, 2);
  inside.flip_normals = true;
  s.shapes.push_back(light(inside, 1));
  s.shapes[0].material = 0;
  Ray ray;
  ray.origin = {1.4f, 2.2f, 2.5f};
  ray.direction = normalize(Vec3f{1, -2, 0.4f});
  const RunningMoments L = radiance(s, ray, 40000);
  EXPECT_NEAR(L.mean(), 2, 4 * L.standard_error());
  EXPECT_LT(L.standard_error(), 0.01);
}

TEST(PathTracer, DepthCountsEdgesAsMitsubaDoes) {
  // The series of the test above, cut: depth n keeps n terms.
  Scene s;
  s.materials.push_back(lambert(0.5f));
  Sphere inside = test::sphere({0, 0, 0}, 2);
  inside.flip_normals = true;
  s.shapes.push_back(light(inside, 1));
  s.shapes[0].material = 0;
  const double expected[] = {0, 1, 1.5, 1.75};
  for (int depth = 1; depth <= 3; ++depth) {
    s.integrator.max_depth = depth;
    const RunningMoments L = radiance(s, look_down(), 20000);
    EXPECT_NEAR(L.mean(), expected[depth], 4 * L.standard_error() + 1e-6);
  }
  s.integrator.name = "direct";
  s.integrator.max_depth = -1;
  EXPECT_NEAR(radiance(s, look_down(), 20000).mean(), 1.5, 0.01);
  s.integrator.name = "patth";
  EXPECT_THROW(radiance(s, look_down(), 1), Error);
}

TEST(PathTracer, HidesEmittersFromTheCameraAlone) {
  Scene s = floor_scene();
  ConstantLight c;
  c.radiance = SpectrumSource::constant(1);
  s.lights.push_back(c);
  s.integrator.hide_emitters = true;
  Ray up = look_down();
  up.direction = {0, 0, 1};
  EXPECT_EQ(radiance(s, up, 10).mean(), 0);
  const RunningMoments L = radiance(s, look_down(), 20000);
  EXPECT_NEAR(L.mean(), 0.6, 4 * L.standard_error());
}

TEST(PathTracer, MaskLetsItsShareOfLightThrough) {
  // A black square of opacity 0.3 above a floor that emits: 0.7 of the radiance passes.
  Scene s;
  s.materials.push_back(lambert(0));
  s.materials[0].opacity = 0.3f;
  s.shapes.push_back(light(test::floor_at(0, 10), 2));
  s.shapes.push_back(shape(test::floor_at(1, 10), 0));
  const RunningMoments L = radiance(s, look_down(3), 20000);
  EXPECT_NEAR(L.mean(), 1.4, 4 * L.standard_error());
}

TEST(PathTracer, TwoSidedMaterialsLookTheSameFromBehind) {
  ConstantLight c;
  c.radiance = SpectrumSource::constant(1);
  Scene s;
  s.lights.push_back(c);
  s.materials.push_back(lambert(0.6f));
  s.shapes.push_back(shape(test::floor_at(0, 10), 0));
  Ray from_below = look_down();
  from_below.origin.z = -from_below.origin.z;
  from_below.direction.z = -from_below.direction.z;
  EXPECT_EQ(radiance(s, from_below, 100).mean(), 0);
  s.materials[0].two_sided = true;
  const RunningMoments L = radiance(s, from_below, 20000);
  EXPECT_NEAR(L.mean(), 0.6, 4 * L.standard_error());
}

TEST(PathTracer, NormalMapTurnsTheFloor) {
  // Every texel says n = (sin 30, 0, cos 30) in the frame whose tangent is +x.
  const double a = pi / 6;
  Image image(2, 2, {"R", "G", "B"});
  for (int i = 0; i < 4; ++i) {
    image.data[std::size_t(3 * i)] = float((std::sin(a) + 1) / 2);
    image.data[std::size_t(3 * i + 1)] = 0.5f;
    image.data[std::size_t(3 * i + 2)] = float((std::cos(a) + 1) / 2);
  }
  Scene s = floor_scene();
  s.materials[0].normal_map = std::make_shared<Texture>(Texture{
      BitmapTexture(image, TextureUse::data, BitmapTexture::Filter::bilinear, BitmapTexture::Wrap::repeat)});
  // Light along the turned normal is at normal incidence.
  s.lights.push_back(
      DirectionalLight{{-float(std::sin(a)), 0, -float(std::cos(a))}, SpectrumSource::constant(1)});
  // Bumps shadow each other, as a surface of roughness tan(a)^2 / 8 seen at the angle a from the plane's
  // normal.
  const double tan2 = sqr(std::tan(a)), shadowing = 2 / (1 + std::sqrt(1 + tan2 / 8 * tan2));
  EXPECT_NEAR(radiance(s, look_down(), 4).mean(), shadowing * 0.6 / pi, 1e-5);
}

TEST(PathTracer, TexturesAreLookedUpAtTheHit) {
  Scene s = floor_scene();
  CheckerboardTexture board{SpectrumSource::constant(0.2f), SpectrumSource::constant(0.8f)};
  s.materials[0] =
      material(test::lobe("lambert", {{"reflectance", std::make_shared<const Texture>(Texture{board})}}));
  s.lights.push_back(DirectionalLight{{0, 0, -1}, SpectrumSource::constant(1)});
  const auto at = [&](float x, float y) {
    Ray r;
    r.origin = {x, y, 1}, r.direction = {0, 0, -1};
    return radiance(s, r, 1).mean() * pi;
  };
  EXPECT_NEAR(at(-5, -5), 0.2, 1e-5);
  EXPECT_NEAR(at(5, -5), 0.8, 1e-5);
  EXPECT_NEAR(at(5, 5), 0.2, 1e-5);
}

TEST(PathTracer, LobesAddUp) {
  Scene s = floor_scene();
  Lobe half = test::lobe("lambert", {{"reflectance", 0.4f}});
  half.weight = 0.5f;
  s.materials[0].lobes.push_back(half);
  ConstantLight c;
  c.radiance = SpectrumSource::constant(1);
  s.lights.push_back(c);
  const RunningMoments L = radiance(s, look_down(), 20000);
  EXPECT_NEAR(L.mean(), 0.8, 4 * L.standard_error());
}

TEST(MaterialTable, RefusesValuesOutsideTheirDomain) {
  Scene s = floor_scene();
  s.materials[0] = lambert(1.5f);
  EXPECT_THROW(MaterialTable{s}, Error);
  s.materials[0] = lambert(0.5f);
  s.materials[0].lobes[0].parameters.clear();
  EXPECT_THROW(MaterialTable{s}, Error);
  s.materials[0] = lambert(0.5f);
  s.materials[0].lobes[0].model = "lambertt";
  EXPECT_THROW(MaterialTable{s}, Error);
}

/// Every kind of thing at once, small.
Scene busy_scene() {
  Scene s;
  s.materials = {lambert(0.7f), material(test::lobe("ggx_dielectric")),
                 material(test::lobe("smooth_dielectric")), material(test::lobe("ggx_conductor")),
                 material(test::lobe("smooth_plastic"))};
  s.shapes.push_back(shape(test::floor_at(0, 4), 0));
  for (int i = 1; i < 5; ++i)
    s.shapes.push_back(shape(test::sphere({float(i) - 2.5f, 0, 0.4f}, 0.4f), i));
  s.shapes.push_back(light(test::ceiling_at(3, 0.5f), 20));
  ConstantLight c;
  c.radiance = SpectrumSource::constant(0.3f);
  s.lights.push_back(c);
  s.lights.push_back(PointLight{{2, -2, 2}, SpectrumSource::constant(4)});
  s.camera.to_world = Transform::look_at({0, -5, 2}, {0, 0, 0.4}, {0, 0, 1});
  s.camera.fov_deg = 40;
  s.film.width = 40, s.film.height = 24;
  s.film.filter = FilterKind::mitchell;
  return s;
}

TEST(Render, PictureDoesNotDependOnTheNumberOfThreads) {
  const Scene scene = busy_scene();
  RenderOptions options;
  options.samples_per_pixel = 5;
  options.quiet = options.variance = true;
  const int before = thread_count();
  set_thread_count(1);
  const RenderResult one = render(scene, options);
  set_thread_count(3);
  const RenderResult three = render(scene, options);
  set_thread_count(before);
  EXPECT_EQ(one.image.data, three.image.data);
  EXPECT_EQ(one.rays, three.rays);
  EXPECT_EQ(one.samples, 40u * 24 * 5);
  EXPECT_TRUE(one.complete);
  options.seed = 1;
  EXPECT_NE(render(scene, options).image.data, one.image.data);
}

TEST(Render, HasNoInvalidSamples) {
  RenderOptions options;
  options.samples_per_pixel = 64;
  options.quiet = true;
  const RenderResult result = render(busy_scene(), options);
  EXPECT_EQ(result.invalid_samples, 0u);
  for (const float x : result.image.data)
    EXPECT_TRUE(std::isfinite(x));
}

TEST(Render, IndependentAndSobolSamplesAgree) {
  Scene scene = busy_scene();
  scene.film.filter = FilterKind::box;
  RenderOptions options;
  options.samples_per_pixel = 64;
  options.quiet = options.variance = true;
  const RenderResult sobol = render(scene, options);
  scene.sampler = "independent";
  const RenderResult independent = render(scene, options);
  // Mean over the picture: variances of pixel means add up (an overestimate for Sobol').
  double difference = 0, variance = 0;
  for (int y = 0; y < scene.film.height; ++y)
    for (int x = 0; x < scene.film.width; ++x) {
      difference += double(sobol.image.at(x, y)[1]) - double(independent.image.at(x, y)[1]);
      variance += double(sobol.image.at(x, y)[4]) + double(independent.image.at(x, y)[4]);
    }
  EXPECT_LT(std::abs(difference), 4 * std::sqrt(variance));
}

TEST(Render, TimeLimitKeepsWhatIsDone) {
  Scene scene = busy_scene();
  RenderOptions options;
  options.quiet = true;
  options.time_limit_s = 0.05;
  const RenderResult result = render(scene, options);
  EXPECT_FALSE(result.complete);
  EXPECT_LT(result.seconds, 2);
  EXPECT_GE(result.samples, 40u * 24);
}

TEST(Render, ShowsAPointLightsColour) {
  // White light of luminance 1 is (1, 1, 1); a flat spectrum is not, since the white of sRGB is D65.
  Scene scene;
  ConstantLight c;
  c.radiance = SpectrumSource::d65(1);
  scene.lights.push_back(c);
  scene.film.width = scene.film.height = 4;
  RenderOptions options;
  options.samples_per_pixel = 4096;
  options.quiet = true;
  const RenderResult result = render(scene, options);
  for (const float x : result.image.data)
    EXPECT_NEAR(x, 1, 5e-3);
}

} // namespace
} // namespace nacre
