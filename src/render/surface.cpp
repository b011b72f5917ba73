#include "render/surface.h"

#include <algorithm>

namespace nacre {
namespace {

Vec3f larger(const Vec3f& a, const Vec3f& b) {
  return {std::max(a.x, std::abs(b.x)), std::max(a.y, std::abs(b.y)), std::max(a.z, std::abs(b.z))};
}
float largest(const Vec3f& a) { return std::max({a.x, a.y, a.z}); }

/// Rounding errors of a point, relative to the coordinates it was computed from: 2^-18 is 64 times the
/// rounding of one operation, some eight times what interpolation and traversal add up to.
constexpr float position_error = 0x1p-18f;

void set_frame(Surface& s, const Vec3f& n, const Vec3f& dp_du, const Vec3f& dp_dv) {
  s.frame = Frame<float>::with_tangent(n, dp_du);
  s.dp_du = dp_du;
  s.dp_dv = dp_dv;
}

/// Object-space point of a triangle; `offset` is left to the caller.
void at_triangle(const TriangleMesh& mesh, const Hit& hit, Surface& s) {
  const auto& index = mesh.triangles[hit.primitive];
  const float b1 = hit.u, b2 = hit.v, b0 = 1 - b1 - b2;
  const auto interpolate = [&](const auto& table) {
    return table[index[0]] * b0 + table[index[1]] * b1 + table[index[2]] * b2;
  };
  const Vec3f p0 = mesh.positions[index[0]];
  const Vec3f e1 = mesh.positions[index[1]] - p0, e2 = mesh.positions[index[2]] - p0;
  s.p = interpolate(mesh.positions);
  s.ng = normalize(cross(e1, e2));
  Vec3f n = s.ng;
  if (!mesh.normals.empty()) {
    const Vec3f smooth = interpolate(mesh.normals);
    const float l2 = length_squared(smooth);
    if (l2 > 1e-20f) {
      n = smooth / std::sqrt(l2);
      // Vertex normals, where given, say which side is outside.
      if (dot(n, s.ng) < 0) s.ng = -s.ng;
    }
  }
  if (mesh.uvs.empty()) {
    s.uv = {b1, b2};
    s.frame = Frame<float>::around(n);
    s.dp_du = e1;
    s.dp_dv = e2;
    return;
  }
  const Vec2f t0 = mesh.uvs[index[0]], t1 = mesh.uvs[index[1]], t2 = mesh.uvs[index[2]];
  s.uv = {t0.x * b0 + t1.x * b1 + t2.x * b2, t0.y * b0 + t1.y * b1 + t2.y * b2};
  const float u1 = t1.x - t0.x, v1 = t1.y - t0.y, u2 = t2.x - t0.x, v2 = t2.y - t0.y;
  const float det = u1 * v2 - v1 * u2;
  if (det != 0) {
    const Vec3f du = e1 * v2 - e2 * v1, dv = e2 * u1 - e1 * u2; // times det, which may be very small
    s.frame = Frame<float>::with_tangent(n, du * std::copysign(1.0f, det));
    s.dp_du = du / det;
    s.dp_dv = dv / det;
  } else {
    s.frame = Frame<float>::around(n);
  }
}

} // namespace

Vec3f SurfaceTable::Placement::point(const Vec3f& p) const {
  const auto& m = to_world;
  return vector(p) + Vec3f{m[0][3], m[1][3], m[2][3]};
}
Vec3f SurfaceTable::Placement::vector(const Vec3f& v) const {
  const auto row = [&](const auto& r) { return r[0] * v.x + r[1] * v.y + r[2] * v.z; };
  return {row(to_world[0]), row(to_world[1]), row(to_world[2])};
}
Vec3f SurfaceTable::Placement::normal(const Vec3f& n) const {
  const auto& m = to_local;
  return {m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z, m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
          m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z};
}
Vec3f SurfaceTable::Placement::local_vector(const Vec3f& v) const {
  const auto row = [&](const auto& r) { return r[0] * v.x + r[1] * v.y + r[2] * v.z; };
  return {row(to_local[0]), row(to_local[1]), row(to_local[2])};
}
Vec3f SurfaceTable::Placement::local_point(const Vec3f& p) const {
  const auto& m = to_local;
  return local_vector(p) + Vec3f{m[0][3], m[1][3], m[2][3]};
}

SurfaceTable::Placement SurfaceTable::place(const Transform& t) {
  const Transform inverse = t.inverse();
  Placement p;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      p.to_world[i][j] = float(t.m[i][j]);
      p.to_local[i][j] = float(inverse.m[i][j]);
    }
  return p;
}

SurfaceTable::Prepared SurfaceTable::prepare(const Shape& shape) {
  Prepared p{&shape, {0, 0, 0}, place(Transform{})};
  const auto reach_of = [&](const Transform& t) {
    Vec3f r;
    float* component[] = {&r.x, &r.y, &r.z};
    for (std::size_t i = 0; i < 3; ++i)
      *component[i] =
          float(std::abs(t.m[i][0]) + std::abs(t.m[i][1]) + std::abs(t.m[i][2]) + std::abs(t.m[i][3]));
    return r;
  };
  std::visit(
      [&](const auto& g) {
        using T = std::decay_t<decltype(g)>;
        if constexpr (std::is_same_v<T, TriangleMesh>) {
          for (const Vec3f& v : g.positions)
            p.reach = larger(p.reach, v);
        } else if constexpr (std::is_same_v<T, Quad>) {
          for (const Vec3f& v :
               {g.corner, g.corner + g.edge_u, g.corner + g.edge_v, g.corner + g.edge_u + g.edge_v})
            p.reach = larger(p.reach, v);
        } else if constexpr (std::is_same_v<T, Sphere>) {
          p.reach = larger({0, 0, 0}, g.center);
          p.reach += Vec3f{g.radius, g.radius, g.radius};
          p.placement = place(g.to_world);
        } else {
          p.reach = reach_of(g.to_world);
          p.placement = place(g.to_world);
        }
      },
      shape.geometry);
  return p;
}

SurfaceTable::SurfaceTable(const Scene& scene) {
  for (const Shape& s : scene.shapes)
    shapes_.push_back(prepare(s));
  for (const Group& g : scene.groups) {
    groups_.emplace_back();
    for (const Shape& s : g.shapes)
      groups_.back().push_back(prepare(s));
  }
  for (const Instance& i : scene.instances) {
    instances_.push_back(place(i.to_world));
    instance_group_.push_back(std::uint32_t(i.group));
  }
}

void SurfaceTable::set_local(Surface& s, const Prepared& prepared, const Hit& hit,
                             const Vec3f& approximate_p) {
  s.material = prepared.shape->material;
  s.shape = hit.shape;
  s.instance = hit.instance;
  s.primitive = hit.primitive;
  const Placement& place = prepared.placement;
  std::visit(
      [&](const auto& g) {
        using T = std::decay_t<decltype(g)>;
        if constexpr (std::is_same_v<T, TriangleMesh>) {
          at_triangle(g, hit, s);
        } else if constexpr (std::is_same_v<T, Quad>) {
          s.p = g.corner + g.edge_u * hit.u + g.edge_v * hit.v;
          s.ng = normalize(cross(g.edge_u, g.edge_v));
          s.uv = {hit.u, hit.v};
          set_frame(s, s.ng, g.edge_u, g.edge_v);
        } else if constexpr (std::is_same_v<T, Sphere>) {
          const Vec3f outward = normalize(approximate_p - g.center);
          s.p = g.center + outward * g.radius;
          s.ng = g.flip_normals ? -outward : outward;
          const Vec3f l = normalize(place.local_vector(outward));
          const float phi = std::atan2(l.y, l.x), theta = std::acos(std::clamp(l.z, -1.0f, 1.0f));
          s.uv = {(phi < 0 ? phi + float(2 * pi) : phi) * float(0.5 * inv_pi), theta * float(inv_pi)};
          const float r = std::max(std::hypot(l.x, l.y), 1e-12f);
          set_frame(s, s.ng, place.vector({-l.y, l.x, 0}) * float(2 * pi),
                    place.vector({l.z * l.x / r, l.z * l.y / r, -r}) * float(pi));
        } else if constexpr (std::is_same_v<T, Disk>) {
          s.p = place.point({hit.u, hit.v, 0});
          s.ng = normalize(place.normal({0, 0, 1}));
          const float r = std::hypot(hit.u, hit.v), phi = std::atan2(hit.v, hit.u);
          s.uv = {r, (phi < 0 ? phi + float(2 * pi) : phi) * float(0.5 * inv_pi)};
          set_frame(s, s.ng, place.vector(r > 0 ? Vec3f{hit.u / r, hit.v / r, 0} : Vec3f{1, 0, 0}),
                    place.vector({-hit.v, hit.u, 0}) * float(2 * pi));
        } else {
          const float c = std::cos(hit.u), sn = std::sin(hit.u);
          s.p = place.point({c, sn, hit.v});
          s.ng = normalize(place.normal({c, sn, 0})) * (g.flip_normals ? -1.0f : 1.0f);
          s.uv = {(hit.u < 0 ? hit.u + float(2 * pi) : hit.u) * float(0.5 * inv_pi), hit.v};
          set_frame(s, s.ng, place.vector({-sn, c, 0}) * float(2 * pi), place.vector({0, 0, 1}));
        }
      },
      prepared.shape->geometry);
}

Surface SurfaceTable::at(const Ray& ray, const Hit& hit) const {
  const Vec3f p = ray.origin + ray.direction * hit.t;
  Surface s;
  if (hit.instance == Hit::none) {
    const Prepared& prepared = shapes_[hit.shape];
    set_local(s, prepared, hit, p);
    s.offset = position_error * largest(prepared.reach);
    return s;
  }
  const Placement& place = instances_[hit.instance];
  const Prepared& prepared = groups_[instance_group_[hit.instance]][hit.shape];
  set_local(s, prepared, hit, place.local_point(p));
  s.p = place.point(s.p);
  s.ng = normalize(place.normal(s.ng));
  s.frame = Frame<float>::with_tangent(normalize(place.normal(s.frame.n)), place.vector(s.frame.s));
  s.dp_du = place.vector(s.dp_du);
  s.dp_dv = place.vector(s.dp_dv);
  // Traversal takes the ray to the object and back, so both spaces round; in units of the world.
  float reach = 0;
  const Vec3f r = prepared.reach;
  for (const auto& row : place.to_world)
    reach = std::max(reach, std::abs(row[0]) * r.x + std::abs(row[1]) * r.y + std::abs(row[2]) * r.z +
                                std::abs(row[3]));
  s.offset = position_error * std::max(reach, largest(larger({0, 0, 0}, s.p)));
  return s;
}

} // namespace nacre
