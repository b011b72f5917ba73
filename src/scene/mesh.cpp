#include "scene/mesh.h"

#include "core/error.h"

#include <cmath>

namespace nacre {
namespace {

Vec3d in_double(const Vec3f& v) { return {v.x, v.y, v.z}; }

double angle_between(const Vec3d& a, const Vec3d& b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

void turn_faces(TriangleMesh& mesh) {
  for (auto& t : mesh.triangles)
    std::swap(t[1], t[2]);
}

} // namespace

void complete_vertex_normals(TriangleMesh& mesh) {
  std::vector<Vec3d> sum(mesh.positions.size(), Vec3d{0, 0, 0});
  for (const auto& t : mesh.triangles) {
    const Vec3d p[3] = {in_double(mesh.positions[t[0]]), in_double(mesh.positions[t[1]]),
                        in_double(mesh.positions[t[2]])};
    const Vec3d area = cross(p[1] - p[0], p[2] - p[0]);
    const double l = length(area);
    if (!(l > 0)) continue;
    for (int i = 0; i < 3; ++i)
      sum[t[i]] += area * (angle_between(p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]) / l);
  }
  mesh.normals.resize(mesh.positions.size(), Vec3f{0, 0, 0});
  for (std::size_t i = 0; i < sum.size(); ++i) {
    if (length_squared(mesh.normals[i]) > 0) continue;
    const double l = length(sum[i]);
    mesh.normals[i] = l > 0 ? vec3<float>(sum[i] / l) : Vec3f{1, 0, 0};
  }
}

void place_mesh(TriangleMesh& mesh, const Transform& to_world, bool flip_normals) {
  const Transform inverse = to_world.inverse();
  for (auto& p : mesh.positions) {
    p = vec3<float>(to_world.point(in_double(p)));
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw Error("a vertex leaves the range of single-precision numbers under to_world");
  }
  const double sign = flip_normals ? -1 : 1;
  for (auto& n : mesh.normals) {
    const Vec3d world = Transform::normal(inverse, in_double(n));
    const double l = length(world);
    n = l > 0 && std::isfinite(l) ? vec3<float>(world * (sign / l)) : Vec3f{1, 0, 0};
  }
  const bool mirrored = !mesh.normals.empty() && to_world.determinant3() < 0;
  if (mirrored != flip_normals) turn_faces(mesh);
}

TriangleMesh cube_mesh() {
  // Corners of each face at uv (0,1), (1,1), (1,0), (0,0), counter-clockwise seen from outside.
  struct Face {
    Vec3f normal;
    Vec3f corners[4];
  };
  static constexpr Face faces[6] = {{{0, -1, 0}, {{1, -1, -1}, {1, -1, 1}, {-1, -1, 1}, {-1, -1, -1}}},
                                    {{0, 1, 0}, {{1, 1, -1}, {-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}}},
                                    {{1, 0, 0}, {{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}}},
                                    {{0, 0, 1}, {{1, -1, 1}, {1, 1, 1}, {-1, 1, 1}, {-1, -1, 1}}},
                                    {{-1, 0, 0}, {{-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1}, {-1, -1, -1}}},
                                    {{0, 0, -1}, {{1, 1, -1}, {1, -1, -1}, {-1, -1, -1}, {-1, 1, -1}}}};
  static constexpr Vec2f uvs[4] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  TriangleMesh mesh;
  for (const Face& face : faces) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int i = 0; i < 4; ++i) {
      mesh.positions.push_back(face.corners[i]);
      mesh.normals.push_back(face.normal);
      mesh.uvs.push_back(uvs[i]);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first + 3, first, first + 2});
  }
  return mesh;
}

} // namespace nacre
