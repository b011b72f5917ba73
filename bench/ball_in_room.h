#pragma once
// The scene that traversal and rendering are measured on: a bumpy ball of some 69,000 triangles in a closed
// room of six quads with a light under the ceiling. Made here, so that anyone can repeat the figures.

#include "bsdf/list.h"
#include "scene/scene.h"

namespace nacre::bench {

/// A sphere of latitude-longitude triangles with smooth bumps and vertex normals.
inline TriangleMesh bumpy_ball(int rows = 132, int columns = 264) {
  TriangleMesh mesh;
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double theta = pi * i / rows, phi = 2 * pi * j / columns;
      const double r = 1 + 0.06 * std::sin(9 * theta) * std::sin(theta) * std::cos(11 * phi);
      mesh.positions.push_back(vec3<float>(spherical_direction(theta, phi) * r));
    }
  const auto at = [&](int i, int j) { return std::uint32_t(i * columns + j % columns); };
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  mesh.normals.assign(mesh.positions.size(), {0, 0, 0});
  for (const auto& t : mesh.triangles) {
    const Vec3f a = mesh.positions[t[0]];
    const Vec3f n = cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
    for (const auto v : t)
      mesh.normals[v] += n;
  }
  for (std::size_t i = 0; i < mesh.normals.size(); ++i)
    mesh.normals[i] = normalize(length_squared(mesh.normals[i]) > 0 ? mesh.normals[i] : mesh.positions[i]);
  return mesh;
}

/// @param ball  name of the model of the ball, at its defaults; the room is white Lambert
inline Scene ball_in_room(const std::string& ball = "lambert") {
  Scene s;
  const auto material = [](const std::string& model) {
    Material m;
    m.id = model;
    Lobe lobe;
    lobe.model = model;
    for (const ParameterInfo& p : find_model(model).parameters)
      lobe.parameters.emplace_back(float(p.initial));
    m.lobes.push_back(lobe);
    return m;
  };
  s.materials = {material("lambert"), material(ball)};
  const auto add = [&](auto geometry, int material_index) {
    Shape shape;
    shape.geometry = std::move(geometry);
    shape.material = material_index;
    s.shapes.push_back(std::move(shape));
  };
  add(bumpy_ball(), 1);
  constexpr float h = 2;
  add(Quad{{-h, -h, -1.1f}, {2 * h, 0, 0}, {0, 2 * h, 0}}, 0); // floor
  add(Quad{{-h, -h, 2.9f}, {0, 2 * h, 0}, {2 * h, 0, 0}}, 0);  // ceiling
  add(Quad{{-h, -h, -1.1f}, {0, 2 * h, 0}, {0, 0, 4}}, 0);     // walls
  add(Quad{{h, -h, -1.1f}, {0, 0, 4}, {0, 2 * h, 0}}, 0);
  add(Quad{{-h, h, -1.1f}, {2 * h, 0, 0}, {0, 0, 4}}, 0);
  add(Quad{{-h, -h, -1.1f}, {0, 0, 4}, {2 * h, 0, 0}}, 0);
  add(Quad{{-0.5f, -0.5f, 2.89f}, {0, 1, 0}, {1, 0, 0}}, 0); // light
  s.shapes.back().emission = SpectrumSource::d65(15);
  s.camera.to_world = Transform::look_at({0, -1.95, 1.2}, {0, 0, 0}, {0, 0, 1});
  s.camera.fov_deg = 70;
  s.integrator.max_depth = 8;
  return s;
}

} // namespace nacre::bench
