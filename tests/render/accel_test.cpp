#include "render/accel.h"

#include "core/error.h"
#include "render/surface.h"
#include "small_scenes.h"

namespace nacre {
namespace {

using test::shape;

float u(int i, int dimension) { return uniform(7, 0, std::uint64_t(i), std::uint64_t(dimension)); }
Vec3f random_point(int i, int dimension, float extent = 1) {
  return Vec3f{2 * u(i, dimension) - 1, 2 * u(i, dimension + 1) - 1, 2 * u(i, dimension + 2) - 1} * extent;
}
Ray random_ray(int i) {
  Ray r;
  r.origin = random_point(i, 100, 2);
  r.direction = random_point(i, 110, 1) - r.origin;
  return r;
}

TriangleMesh random_triangles(int n) {
  TriangleMesh mesh;
  for (int i = 0; i < n; ++i) {
    const Vec3f p = random_point(i, 0);
    const auto first = std::uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(),
                          {p, p + random_point(i, 3, 0.3f), p + random_point(i, 6, 0.3f)});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

/// Nearest crossing in double precision (Moeller and Trumbore 1997).
std::pair<double, int> brute_force(const TriangleMesh& mesh, const Ray& ray) {
  const auto d = [](const Vec3f& v) { return Vec3d{v.x, v.y, v.z}; };
  double best = std::numeric_limits<double>::infinity();
  int index = -1;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const Vec3d a = d(mesh.positions[t[0]]), e1 = d(mesh.positions[t[1]]) - a,
                e2 = d(mesh.positions[t[2]]) - a;
    const Vec3d p = cross(d(ray.direction), e2);
    const double inv = 1 / dot(e1, p);
    const Vec3d s = d(ray.origin) - a, q = cross(s, e1);
    const double b1 = dot(s, p) * inv, b2 = dot(d(ray.direction), q) * inv, t_hit = dot(e2, q) * inv;
    if (b1 >= 0 && b2 >= 0 && b1 + b2 <= 1 && t_hit > ray.t_min && t_hit < std::min(best, double(ray.t_max)))
      best = t_hit, index = int(i);
  }
  return {best, index};
}

TEST(Accel, FindsTheNearestTriangleThatBruteForceFinds) {
  Scene scene;
  const TriangleMesh mesh = random_triangles(300);
  scene.shapes.push_back(shape(mesh));
  const Accel accel(scene);
  int hits = 0, disagreements = 0;
  for (int i = 0; i < 2000; ++i) {
    const Ray ray = random_ray(i);
    const auto [t, index] = brute_force(mesh, ray);
    Hit hit;
    const bool found = accel.intersect(ray, hit);
    hits += found;
    if (found != (index >= 0) || (found && int(hit.primitive) != index)) {
      ++disagreements; // only rays through an edge may differ
      continue;
    }
    EXPECT_EQ(accel.occluded(ray), found);
    if (found) {
      EXPECT_NEAR(hit.t, t, 1e-5 * t + 1e-6);
    }
  }
  EXPECT_GT(hits, 800);
  EXPECT_LE(disagreements, 2);
}

TEST(Accel, PacketsFindWhatSingleRaysFind) {
  Scene scene;
  scene.shapes.push_back(shape(random_triangles(300)));
  scene.shapes.push_back(shape(test::sphere({0.2f, 0, 0}, 0.5f)));
  scene.groups.push_back({"g", {shape(Disk{})}});
  scene.instances.push_back({0, Transform::translate({0, 0, 0.5})});
  const Accel accel(scene);
  std::vector<Ray> rays; // not a multiple of 16
  for (int i = 0; i < 1003; ++i)
    rays.push_back(random_ray(i));
  std::vector<Hit> hits(rays.size());
  std::vector<std::uint8_t> occluded(rays.size());
  accel.intersect(rays, hits);
  accel.occluded(rays, occluded);
  int differ = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Hit hit;
    accel.intersect(rays[i], hit);
    // Packets and single rays use different kernels, whose rounding may differ on an edge.
    differ +=
        hit.shape != hits[i].shape || hit.primitive != hits[i].primitive || hit.instance != hits[i].instance;
    if (hit.shape == hits[i].shape && hit.primitive == hits[i].primitive && hit) {
      EXPECT_NEAR(hit.t, hits[i].t, 1e-5f * hit.t);
    }
    EXPECT_EQ(bool(occluded[i]), bool(hits[i]));
  }
  EXPECT_LE(differ, 2);
}

TEST(Accel, SphereIsExactFromInsideOutsideAndAtGrazing) {
  for (const float radius : {1e-3f, 1.0f, 1e3f}) {
    Scene scene;
    const Vec3f center{5, -3, 2};
    scene.shapes.push_back(shape(test::sphere(center, radius)));
    const Accel accel(scene);
    const SurfaceTable surfaces(scene);
    for (int i = 0; i < 500; ++i) {
      const Vec3f n = normalize(random_point(i, 0));
      const Vec3f tangent = normalize(cross(n, normalize(random_point(i, 3))));
      // Starts on the sphere, as a path does, and goes inwards at angles down to 1e-3 above the tangent
      // plane.
      const float angle = i % 2 ? 1e-3f : 1.5f * u(i, 6) + 0.02f;
      Surface start;
      Ray toward;
      toward.origin = center + n * (2 * radius);
      toward.direction = -n;
      Hit hit;
      ASSERT_TRUE(accel.intersect(toward, hit));
      start = surfaces.at(toward, hit);
      const Vec3f d = normalize(tangent * std::cos(angle) - n * std::sin(angle));
      const Ray inside = start.spawn(d);
      // The far wall from where the ray really starts, a little inside: in long double, by the textbook.
      const auto wide = [](const Vec3f& v) { return Vec3<long double>{v.x, v.y, v.z}; };
      const auto o = wide(inside.origin) - wide(center), dir = wide(inside.direction);
      const long double b = dot(o, dir), dd = dot(dir, dir);
      const long double wall =
          (-b + sqrt(b * b - dd * (dot(o, o) - (long double)radius * (long double)radius))) / dd;
      ASSERT_TRUE(accel.intersect(inside, hit)) << radius << " " << i;
      EXPECT_NEAR(hit.t, double(wall), 1e-6 * double(wall)) << radius << " " << angle;
      // Outwards it meets nothing, at however small an angle.
      EXPECT_FALSE(
          accel.intersect(start.spawn(normalize(tangent * std::cos(angle) + n * std::sin(angle))), hit));
    }
  }
}

TEST(Accel, InstancesEqualTransformedTriangles) {
  const TriangleMesh mesh = random_triangles(60);
  const Transform to_world = Transform::translate({1, 2, -1}) * Transform::rotate({1, 2, 3}, 50) *
                             Transform::scale({-2, 0.5, 1.3}); // mirrors
  Scene instanced, baked;
  instanced.groups.push_back({"g", {shape(mesh)}});
  instanced.instances.push_back({0, to_world});
  TriangleMesh moved = mesh;
  for (Vec3f& p : moved.positions)
    p = vec3<float>(to_world.point({p.x, p.y, p.z}));
  baked.shapes.push_back(shape(moved));
  const Accel a(instanced), b(baked);
  const SurfaceTable sa(instanced), sb(baked);
  int hits = 0, differ = 0;
  for (int i = 0; i < 2000; ++i) {
    Ray ray = random_ray(i);
    ray.origin = vec3<float>(to_world.point({ray.origin.x, ray.origin.y, ray.origin.z}));
    ray.direction =
        normalize(vec3<float>(to_world.vector({ray.direction.x, ray.direction.y, ray.direction.z})));
    Hit ha, hb;
    a.intersect(ray, ha);
    b.intersect(ray, hb);
    if (bool(ha) != bool(hb) || ha.primitive != hb.primitive) {
      ++differ;
      continue;
    }
    if (!ha) continue;
    ++hits;
    EXPECT_EQ(ha.instance, 0u);
    EXPECT_NEAR(ha.t, hb.t, 1e-4f);
    const Surface pa = sa.at(ray, ha), pb = sb.at(ray, hb);
    EXPECT_LT(length(pa.p - pb.p), 4e-5f);
    // The mirror turns triangles around; what was outside of the object stays outside.
    EXPECT_NEAR(dot(pa.ng, pb.ng), -1, 1e-4f);
    EXPECT_NEAR(std::abs(dot(pa.frame.n, pa.ng)), 1, 1e-4f);
  }
  EXPECT_GT(hits, 200);
  EXPECT_LE(differ, 2);
}

TEST(Accel, NoRayHitsTheSurfaceItLeaves) {
  Scene scene;
  // Far from the origin, large, small, and crossing the origin with large vertices.
  scene.shapes.push_back(shape(test::floor_at(0, 1e4f)));
  TriangleMesh far;
  far.positions = {{1000, 1000, 1000}, {1001, 1000, 1000.3f}, {1000, 1001.5f, 1000.7f}};
  far.triangles = {{0, 1, 2}};
  scene.shapes.push_back(shape(far));
  scene.shapes.push_back(shape(test::sphere({-500, 30, 40}, 1e-1f)));
  scene.groups.push_back({"g", {shape(far)}});
  scene.instances.push_back({0, Transform::translate({-3000, 10, 10}) * Transform::rotate({1, 1, 0}, 33)});
  const Accel accel(scene);
  const SurfaceTable surfaces(scene);
  const Vec3f targets[] = {{1, 2, 0}, {1000.3f, 1000.4f, 1000.3f}, {-500, 30, 40}};
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    Vec3f target = targets[i % 3];
    if (i % 7 == 0) {
      const Vec3d p = scene.instances[0].to_world.point({1000.3, 1000.4, 1000.28});
      target = vec3<float>(p);
    }
    Ray ray;
    ray.origin = target + random_point(i, 0, 3);
    ray.direction = normalize(target - ray.origin);
    Hit hit;
    if (!accel.intersect(ray, hit)) continue;
    ++hits;
    const Surface s = surfaces.at(ray, hit);
    const Vec3f side = s.ng * (dot(s.ng, ray.direction) < 0 ? 1.0f : -1.0f);
    const Vec3f d = normalize(side * (i % 2 ? 1e-3f : u(i, 8)) + normalize(cross(s.ng, random_point(i, 10))));
    Ray away = s.spawn(d);
    away.t_max = 0.5f;
    EXPECT_FALSE(accel.occluded(away)) << i << " shape " << hit.shape;
  }
  EXPECT_GT(hits, 1500);
}

TEST(Accel, DiskAndCylinderFollowTheirTransforms) {
  Scene scene;
  Disk disk;
  disk.to_world = Transform::translate({0, 0, 2}) * Transform::scale({2, 0.5, 1});
  Cylinder cylinder;
  cylinder.to_world = Transform::translate({10, 0, 0}) * Transform::scale({0.5, 0.5, 3});
  scene.shapes = {shape(disk), shape(cylinder)};
  const Accel accel(scene);
  const SurfaceTable surfaces(scene);
  const auto shoot = [&](Vec3f o, Vec3f d) {
    Ray r;
    r.origin = o, r.direction = d;
    Hit h;
    accel.intersect(r, h);
    return std::pair(r, h);
  };
  EXPECT_TRUE(shoot({1.9f, 0, 0}, {0, 0, 1}).second);
  EXPECT_FALSE(shoot({0, 0.6f, 0}, {0, 0, 1}).second);
  EXPECT_FALSE(shoot({1.8f, 0.4f, 0}, {0, 0, 1}).second);
  const auto [ray, hit] = shoot({8, 0, 1.5f}, {1, 0, 0});
  ASSERT_TRUE(hit);
  EXPECT_FLOAT_EQ(hit.t, 1.5f);
  const Surface s = surfaces.at(ray, hit);
  EXPECT_NEAR(s.ng.x, -1, 1e-6f);
  EXPECT_NEAR(s.uv.x, 0.5f, 1e-6f);
  EXPECT_NEAR(s.uv.y, 0.5f, 1e-6f);
  // Through the open end onto the inner wall.
  EXPECT_TRUE(shoot({10, 0, -1}, {0.2f, 0, 1}).second);
  EXPECT_FALSE(shoot({10, 0, -1}, {0, 0, 1}).second);
}

TEST(Accel, RefusesTrianglesWithoutVertices) {
  Scene scene;
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 3}};
  scene.shapes.push_back(shape(mesh));
  EXPECT_THROW(Accel{scene}, Error);
}

TEST(Accel, EmptySceneIsEmpty) {
  const Scene scene;
  const Accel accel(scene);
  Hit hit;
  EXPECT_FALSE(accel.intersect(random_ray(0), hit));
  EXPECT_EQ(accel.radius(), 0);
}

} // namespace
} // namespace nacre
