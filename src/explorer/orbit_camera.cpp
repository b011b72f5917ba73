#include "explorer/orbit_camera.h"

#include "explorer/arguments.h"

#include <algorithm>
#include <limits>

namespace nacre {
namespace {

constexpr double radians = pi / 180;

struct Axes {
  Vec3d front, side, up; ///< azimuth 0, azimuth 90, elevation 90
};
Axes axes(bool z_up) {
  if (z_up) return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};
}

/// The middle of all shapes' boxes, those of groups left out.
Vec3d middle(const Scene& scene) {
  constexpr double far = std::numeric_limits<double>::max();
  Vec3d lo{far, far, far}, hi{-far, -far, -far};
  const auto add = [&](const Vec3d& p) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  };
  const auto add_float = [&](const Vec3f& p) { add({p.x, p.y, p.z}); };
  for (const Shape& shape : scene.shapes)
    std::visit(
        [&](const auto& g) {
          using G = std::decay_t<decltype(g)>;
          if constexpr (std::is_same_v<G, TriangleMesh>) {
            for (const Vec3f& p : g.positions)
              add_float(p);
          } else if constexpr (std::is_same_v<G, Sphere>) {
            add_float(g.center);
          } else if constexpr (std::is_same_v<G, Quad>) {
            add_float(g.corner + g.edge_u * 0.5f + g.edge_v * 0.5f);
          } else {
            add(g.to_world.point({0, 0, 0}));
          }
        },
        shape.geometry);
  for (const Instance& instance : scene.instances)
    add(instance.to_world.point({0, 0, 0}));
  return lo.x <= hi.x ? (lo + hi) * 0.5 : Vec3d{0, 0, 0};
}

} // namespace

OrbitCamera OrbitCamera::parse(const Arguments& request, const OrbitCamera& otherwise) {
  OrbitCamera c = otherwise;
  if (request.has("target")) {
    const auto& list = request.list("target", 3);
    if (list.size() != 3) throw Error("'target' has three numbers");
    const auto number = [&](std::size_t i) {
      if (!list[i].is_number() || !(std::abs(list[i].get<double>()) < 1e9))
        throw Error("'target' has three numbers");
      return list[i].get<double>();
    };
    c.target = {number(0), number(1), number(2)};
  }
  c.distance = request.number("distance", c.distance, 1e-6, 1e9);
  c.azimuth = request.number("azimuth", c.azimuth, -36000, 36000);
  c.elevation = request.number("elevation", c.elevation, -90, 90);
  c.fov = request.number("fov", c.fov, 0.1, 179);
  return c;
}

OrbitCamera OrbitCamera::of(const Scene& scene) {
  OrbitCamera c;
  const Transform& t = scene.camera.to_world;
  const Vec3d origin = t.point({0, 0, 0}), forward = normalize(t.vector({0, 0, 1})), up = t.vector({0, 1, 0});
  c.z_up_ = std::abs(up.z) > std::abs(up.y);
  const Axes a = axes(c.z_up_);
  const double along = dot(middle(scene) - origin, forward);
  c.distance = along > 1e-3 ? along : 1;
  c.target = origin + forward * c.distance;
  c.elevation = std::asin(clamp(-dot(forward, a.up), -1.0, 1.0)) / radians;
  c.azimuth = std::atan2(-dot(forward, a.side), -dot(forward, a.front)) / radians;
  c.fov = scene.camera.fov_deg;
  return c;
}

nlohmann::json OrbitCamera::to_json() const {
  return {{"target", {target.x, target.y, target.z}},
          {"distance", distance},
          {"azimuth", azimuth},
          {"elevation", elevation},
          {"fov", fov}};
}

void OrbitCamera::place(Camera& camera) const {
  const Axes a = axes(z_up_);
  const double e = elevation * radians, z = azimuth * radians;
  const Vec3d away =
      a.front * (std::cos(e) * std::cos(z)) + a.side * (std::cos(e) * std::sin(z)) + a.up * std::sin(e);
  // Above the pole the picture's upper edge is the far side.
  const Vec3d up = std::abs(elevation) < 89.99
                       ? a.up
                       : (a.front * std::cos(z) + a.side * std::sin(z)) * (elevation > 0 ? -1.0 : 1.0);
  camera.to_world = Transform::look_at(target + away * distance, target, up);
  camera.fov_deg = fov;
}

} // namespace nacre
