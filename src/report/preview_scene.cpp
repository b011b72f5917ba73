#include "report/preview_scene.h"

#include "scene/scene_material.h"
#include "scene/sky.h"

namespace nacre {
namespace {

Material matte(const std::string& id, float r, float g, float b) {
  Material m;
  m.id = id;
  m.lobes.push_back({"lambert", {SpectrumSource::rgb_reflectance(r, g, b)}, nullptr, 1});
  m.two_sided = true;
  return m;
}

Material chequered(float squares) {
  Material m;
  m.id = "mat";
  m.two_sided = true;
  const CheckerboardTexture pattern{SpectrumSource::rgb_reflectance(0.50f, 0.49f, 0.47f),
                                    SpectrumSource::rgb_reflectance(0.10f, 0.10f, 0.105f)};
  // One unit of the pattern holds two squares a side.
  const auto texture = std::make_shared<Texture>(Texture{pattern, {squares / 2, 0, 0, 0, squares / 2, 0}});
  m.lobes.push_back({"lambert", {ParameterSource(std::shared_ptr<const Texture>(texture))}, nullptr, 1});
  return m;
}

/// A photographer's backdrop: the floor bends up into a wall without an edge.
TriangleMesh sweep() {
  constexpr float half_width = 14, front = 9, bend = -2.6f, radius = 3.2f, top = 9;
  struct Point {
    float y, z, normal_y, normal_z;
  };
  std::vector<Point> profile{{0, front, 1, 0}};
  constexpr int segments = 48;
  for (int i = 0; i <= segments; ++i) {
    const float angle = static_cast<float>(pi / 2) * static_cast<float>(i) / segments;
    profile.push_back(
        {radius * (1 - std::cos(angle)), bend - radius * std::sin(angle), std::cos(angle), std::sin(angle)});
  }
  profile.push_back({top, bend - radius, 0, 1});
  TriangleMesh mesh;
  for (const Point& p : profile)
    for (const float x : {-half_width, half_width}) {
      mesh.positions.push_back({x, p.y, p.z});
      mesh.normals.push_back({0, p.normal_y, p.normal_z});
    }
  for (std::uint32_t i = 0; i + 3 < mesh.positions.size(); i += 2) {
    mesh.triangles.push_back({i, i + 1, i + 3});
    mesh.triangles.push_back({i, i + 3, i + 2});
  }
  return mesh;
}

} // namespace

std::shared_ptr<const Image> preview_sky() {
  SkyOptions sky;
  sky.turbidity = 3;
  // Over the viewer's left shoulder: highlights stand clear of the outline and shadows fall back and right.
  const double elevation = 38 * pi / 180, azimuth = 52 * pi / 180;
  sky.sun_direction = {-std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                       std::cos(elevation) * std::cos(azimuth)};
  sky.ground_albedo = {0.22, 0.21, 0.20};
  return std::make_shared<const Image>(make_sky(sky));
}

Scene preview_scene(const MaterialSpec& material, std::shared_ptr<const Image> environment, int width,
                    int height) {
  Scene scene;
  scene.file = "preview";
  scene.film.width = width, scene.film.height = height;
  scene.integrator.max_depth = 8;
  scene.materials = {scene_material(material), matte("backdrop", 0.13f, 0.135f, 0.145f), chequered(9)};
  scene.shapes.push_back({"backdrop", sweep(), 1, std::nullopt});
  constexpr float half = 2.25f, above = 0.002f; // of the mat
  scene.shapes.push_back(
      {"mat", Quad{{-half, above, -half}, {0, 0, 2 * half}, {2 * half, 0, 0}}, 2, std::nullopt});
  scene.shapes.push_back({"sphere", Sphere{{-0.1f, 1 + above, 0}, 1, {}, false}, 0, std::nullopt});
  scene.shapes.push_back(
      {"small sphere", Sphere{{1.22f, 0.42f + above, 0.78f}, 0.42f, {}, false}, 0, std::nullopt});

  scene.camera.to_world = Transform::look_at({0.35, 2.5, 6.6}, {0.30, 0.80, 0}, {0, 1, 0});
  scene.camera.fov_deg = 32;
  scene.camera.fov_axis = Camera::FovAxis::x;
  EnvironmentLight light;
  light.radiance = environment ? std::move(environment) : preview_sky();
  scene.lights.push_back(light);
  return scene;
}

} // namespace nacre
