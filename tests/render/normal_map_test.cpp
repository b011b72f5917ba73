// Perturbed normals: frames turned by a map, facets that keep all light, and bumps as maps of normals.
#include "core/error.h"
#include "core/random.h"
#include "core/warp.h"
#include "small_scenes.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

using test::lambert;
using test::look_down;
using test::material;
using test::radiance;
using test::shape;

std::shared_ptr<const Texture> picture(Image image, BitmapTexture::Wrap wrap = BitmapTexture::Wrap::repeat,
                                       BitmapTexture::Filter filter = BitmapTexture::Filter::nearest) {
  return std::make_shared<const Texture>(
      Texture{BitmapTexture(std::move(image), TextureUse::data, filter, wrap)});
}
/// Normals tilted by up to `tilt_deg`, each texel on its own.
std::shared_ptr<const Texture> rough_normals(double tilt_deg) {
  Image image(64, 64, {"R", "G", "B"});
  for (std::size_t i = 0; i < 64 * 64; ++i) {
    const Vec3d n = spherical_direction(tilt_deg * pi / 180 * std::sqrt(unit_double(hash(3, i, 0))),
                                        2 * pi * unit_double(hash(3, i, 1)));
    image.data[3 * i] = float((n.x + 1) / 2);
    image.data[3 * i + 1] = float((n.y + 1) / 2);
    image.data[3 * i + 2] = float((n.z + 1) / 2);
  }
  return picture(std::move(image));
}
Ray look(double theta_deg, float x, float y) {
  const Vec3f w = vec3<float>(spherical_direction(theta_deg * pi / 180, 0.7));
  return {Vec3f{x, y, 0} + w, 0, -w, infinity};
}
/// A floor under uniform light of radiance 1.
Scene furnace(Material m) {
  Scene s;
  s.materials.push_back(std::move(m));
  s.shapes.push_back(shape(test::floor_at(0, 10), 0));
  s.lights.push_back(ConstantLight{SpectrumSource::constant(1)});
  s.integrator.max_depth = 2;
  return s;
}
/// Mean over many texels.
RunningMoments floor_radiance(const Scene& scene, double theta_deg) {
  const World world(scene);
  const PathTracer tracer(world, scene.integrator);
  RunningMoments moments;
  for (std::uint32_t i = 0; i < 20000; ++i) {
    IndependentSampler sampler(1, 0, i);
    const Ray ray = look(theta_deg, 18 * unit_float(std::uint32_t(hash(5, i, 0))) - 9,
                         18 * unit_float(std::uint32_t(hash(5, i, 1))) - 9);
    moments.add(double(tracer.radiance(ray, test::fixed_wavelengths(), sampler).radiance[0]));
  }
  return moments;
}

TEST(NormalMapping, FacetsKeepAllLightOfAWhiteFloorAndATurnedFrameDoesNot) {
  Material white = lambert(1);
  white.normal_map = rough_normals(65);
  const Scene turned = furnace(white);
  white.normal_mapping = NormalMapping::microfacet;
  const Scene facets = furnace(white);
  for (const double theta : {0.0, 50.0, 80.0, 88.0}) {
    const RunningMoments L = floor_radiance(facets, theta);
    EXPECT_NEAR(L.mean(), 1, 4 * L.standard_error() + 1e-4) << theta;
    EXPECT_GE(L.mean(), 0.97) << theta;
    EXPECT_LT(floor_radiance(turned, theta).mean(), 0.9) << theta;
  }
}

TEST(NormalMapping, FacetsKeepAllLightOfAMirror) {
  // Reflects 0.9999.
  Material mirror = material(test::lobe("smooth_conductor", {{"eta", 0.01f}, {"k", 20.0f}}));
  mirror.normal_map = rough_normals(50);
  mirror.normal_mapping = NormalMapping::microfacet;
  for (const double theta : {0.0, 60.0, 85.0}) {
    const RunningMoments L = floor_radiance(furnace(mirror), theta);
    EXPECT_NEAR(L.mean(), 1, 4 * L.standard_error() + 1e-3) << theta;
  }
}

TEST(NormalMapping, TwoSidedFacetsKeepAllLightFromBehind) {
  Material white = lambert(1);
  white.normal_map = rough_normals(50);
  white.normal_mapping = NormalMapping::microfacet;
  white.two_sided = true;
  Ray from_below = look(40, 0.1f, 0.2f);
  from_below.origin.z = -from_below.origin.z;
  from_below.direction.z = -from_below.direction.z;
  const RunningMoments L = radiance(furnace(white), from_below, 20000);
  EXPECT_NEAR(L.mean(), 1, 4 * L.standard_error() + 1e-4);
}

// What eval says of a quarter of the hemisphere is what sample sends there, for a narrow lobe too.
TEST(NormalMapping, SamplesOfFacetsAreTheirValues) {
  for (const char* model : {"lambert", "ggx_conductor"}) {
    Material m =
        material(std::string(model) == "lambert" ? test::lobe(model, {{"reflectance", 0.8f}})
                                                 : test::lobe(model, {{"alpha_x", 0.3f}, {"alpha_y", 0.2f}}));
    Image tilted(1, 1, {"R", "G", "B"});
    const Vec3d n = spherical_direction(0.8, 0.5);
    tilted.data = {float((n.x + 1) / 2), float((n.y + 1) / 2), float((n.z + 1) / 2)};
    m.normal_map = picture(tilted);
    m.normal_mapping = NormalMapping::microfacet;
    const Scene scene = furnace(m);
    const World world(scene);
    for (const double phi : {0.5, 2.5, 4.0}) {
      const Vec3f wo = vec3<float>(spherical_direction(1.0, phi));
      Surface surface;
      surface.frame = Frame<float>::with_tangent({0, 0, 1}, {1, 0, 0});
      surface.material = 0;
      const SurfaceBsdf bsdf = world.materials.resolve(surface, wo, test::fixed_wavelengths());
      const auto quarter = [](const Vec3f& w) { return std::size_t((w.x > 0) + 2 * (w.y > 0)); };
      std::array<RunningMoments, 4> sampled, evaluated;
      for (std::uint32_t i = 0; i < 100000; ++i) {
        const auto u = [&](int d) { return unit_float(std::uint32_t(hash(9, i, d))); };
        const auto s = bsdf.sample(u(0), {u(1), u(2)});
        const Vec3f wi = square_to_cosine_hemisphere(Vec2f{u(3), u(4)});
        const double f = bsdf.eval(wi)[0] / (wi.z * inv_pi);
        for (std::size_t q = 0; q < 4; ++q) {
          sampled[q].add(s.pdf > 0 && quarter(s.wi) == q ? double(s.weight[0]) : 0.0);
          evaluated[q].add(quarter(wi) == q ? f : 0.0);
        }
        if (s.pdf > 0) {
          ASSERT_GT(s.wi.z, 0);
        }
      }
      for (std::size_t q = 0; q < 4; ++q) {
        const double error = std::hypot(sampled[q].standard_error(), evaluated[q].standard_error());
        EXPECT_NEAR(sampled[q].mean(), evaluated[q].mean(), 4 * error + 1e-4)
            << model << " " << phi << " " << q;
      }
    }
  }
}

TEST(NormalMapping, FacetsAreForWhatReflects) {
  Material glass = material(test::lobe("smooth_dielectric"));
  glass.normal_map = rough_normals(20);
  EXPECT_NO_THROW(MaterialTable{furnace(glass)});
  glass.normal_mapping = NormalMapping::microfacet;
  EXPECT_THROW(MaterialTable{furnace(glass)}, Error);
}

/// Heights that rise by 1 a texel along u.
std::shared_ptr<const Texture> ramp() {
  Image image(4, 1, {"Y"});
  image.data = {0, 1, 2, 3};
  return picture(image, BitmapTexture::Wrap::clamp, BitmapTexture::Filter::bilinear);
}

TEST(BumpMap, IsTheNormalMapOfItsSlope) {
  // 4 texels on a floor 20 wide: a scale of 5 tan(a) is a slope of tan(a) along x.
  const double a = pi / 6;
  Scene s = furnace(lambert(0.6f));
  s.materials[0].bump_map = ramp();
  s.materials[0].bump_scale = float(5 * std::tan(a));
  s.lights = {DirectionalLight{{float(std::sin(a)), 0, -float(std::cos(a))}, SpectrumSource::constant(1)}};
  const double tan2 = sqr(std::tan(a)), shadowing = 2 / (1 + std::sqrt(1 + tan2 / 8 * tan2));
  EXPECT_NEAR(radiance(s, look_down(), 4).mean(), shadowing * 0.6 / pi, 1e-5);
  // A dent, seen by light along the other side's normal.
  s.materials[0].bump_scale *= -1;
  std::get<DirectionalLight>(s.lights[0]).direction.x *= -1;
  EXPECT_NEAR(radiance(s, look_down(), 4).mean(), shadowing * 0.6 / pi, 1e-5);
}

TEST(BumpMap, OfMirroredTextureCoordinatesStillPointsOut) {
  Scene s = furnace(lambert(1));
  s.materials[0].bump_map = ramp();
  TriangleMesh mesh;
  mesh.positions = {{-10, -10, 0}, {10, -10, 0}, {10, 10, 0}, {-10, 10, 0}};
  mesh.uvs = {{1, 0}, {0, 0}, {0, 1}, {1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  s.shapes[0] = shape(mesh, 0);
  // Heights fall along x here.
  s.materials[0].bump_scale = 5;
  s.lights = {DirectionalLight{normalize(Vec3f{-1, 0, -1}), SpectrumSource::constant(1)}};
  EXPECT_NEAR(radiance(s, look_down(), 4).mean(), 2 / (1 + std::sqrt(1 + 0.125)) / pi, 1e-5);
}

// p changes as dp/du and dp/dv say, between two points a little apart.
TEST(Surfaces, DerivativesArePositionsOverTextureCoordinates) {
  Scene s;
  s.materials.push_back(lambert(1));
  const Transform turned = Transform::rotate({1, 2, 3}, 40) * Transform::scale({2, 2, 2});
  TriangleMesh mesh;
  mesh.positions = {{-3, -3, 0}, {3, -2, 0.5f}, {0, 4, 1}};
  const TriangleMesh bare = mesh;
  mesh.uvs = {{0.1f, 0.2f}, {0.9f, 0.1f}, {0.4f, 0.8f}};
  mesh.triangles = {{0, 1, 2}};
  TriangleMesh without = bare;
  without.triangles = {{0, 1, 2}};
  Sphere ball = test::sphere({0, 0, 0}, 2);
  ball.to_world = turned;
  const std::vector<std::variant<TriangleMesh, Sphere, Quad, Disk, Cylinder>> geometries = {
      mesh, without, ball, Quad{{-3, -3, 0}, {6, 1, 0}, {0, 6, 1}}, Disk{turned}, Cylinder{turned}};
  for (const auto& geometry : geometries) {
    s.shapes = {shape(geometry, 0)};
    const World world(s);
    int tried = 0;
    for (std::uint32_t i = 0; i < 200; ++i) {
      const auto at = [&](float x, float y) -> std::optional<Surface> {
        Ray ray;
        ray.origin = {x, y, 20};
        ray.direction = {0, 0, -1};
        Hit hit;
        if (!world.accel.intersect(ray, hit)) return {};
        return world.surfaces.at(ray, hit);
      };
      const float x = 2.4f * unit_float(std::uint32_t(hash(2, i, 0))) - 1.2f;
      const float y = 2.4f * unit_float(std::uint32_t(hash(2, i, 1))) - 1.2f;
      const auto a = at(x, y), b = at(x + 4e-3f, y + 3e-3f);
      if (!a || !b || std::abs(a->uv.x - b->uv.x) > 0.05f || std::abs(a->ng.z) < 0.3f) continue;
      if (length(a->dp_du) < 1 || length(a->dp_dv) < 1) continue; // near a pole
      ++tried;
      const Vec3f dp = b->p - a->p;
      const Vec3f du = (a->dp_du + b->dp_du) * 0.5f, dv = (a->dp_dv + b->dp_dv) * 0.5f;
      const Vec3f expected = du * (b->uv.x - a->uv.x) + dv * (b->uv.y - a->uv.y);
      EXPECT_LT(length(dp - expected), 2e-2f * length(dp)) << geometry.index() << " at " << x << " " << y;
    }
    EXPECT_GT(tried, 20) << geometry.index();
  }
}

} // namespace
} // namespace nacre
