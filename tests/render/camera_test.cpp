#include "render/camera.h"

#include "core/error.h"

namespace nacre {
namespace {

Camera camera_at_origin() {
  Camera c;
  c.to_world = Transform::look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0});
  c.fov_deg = 90;
  return c;
}

TEST(CameraRays, CentreLooksForwardAndLeftIsPlusX) {
  Film film;
  film.width = 200, film.height = 100;
  const CameraRays camera(camera_at_origin(), film);
  const Ray centre = camera.ray(100, 50);
  EXPECT_NEAR(centre.direction.z, 1, 1e-6f);
  // 90 degrees across: the left border lies at 45 degrees, towards +x; the upper one at atan(1/2), towards
  // +y.
  const Vec3f left = camera.ray(0, 50).direction, top = camera.ray(100, 0).direction;
  EXPECT_NEAR(left.x, std::sqrt(0.5f), 1e-6f);
  EXPECT_NEAR(left.y, 0, 1e-6f);
  EXPECT_NEAR(top.y / top.z, 0.5f, 1e-6f);
}

TEST(CameraRays, FieldOfViewIsMeasuredAlongItsAxis) {
  Film film;
  film.width = 200, film.height = 100;
  Camera c = camera_at_origin();
  const auto edge_tangents = [&] {
    const CameraRays camera(c, film);
    const Vec3f l = camera.ray(0, 50).direction, t = camera.ray(100, 0).direction;
    return Vec2f{l.x / l.z, t.y / t.z};
  };
  c.fov_axis = Camera::FovAxis::y;
  EXPECT_NEAR(edge_tangents().y, 1, 1e-6f);
  c.fov_axis = Camera::FovAxis::smaller;
  EXPECT_NEAR(edge_tangents().y, 1, 1e-6f);
  c.fov_axis = Camera::FovAxis::larger;
  EXPECT_NEAR(edge_tangents().x, 1, 1e-6f);
  c.fov_axis = Camera::FovAxis::diagonal;
  EXPECT_NEAR(std::hypot(edge_tangents().x, edge_tangents().y), 1, 1e-6f);
}

TEST(CameraRays, ClipPlanesAreMeasuredAlongTheAxis) {
  Film film;
  film.width = film.height = 10;
  Camera c = camera_at_origin();
  c.near_clip = 2, c.far_clip = 5;
  const CameraRays camera(c, film);
  const Ray corner = camera.ray(0, 0);
  EXPECT_NEAR((corner.direction * corner.t_min).z, 2, 1e-5f);
  EXPECT_NEAR((corner.direction * corner.t_max).z, 5, 1e-5f);
}

TEST(CameraRays, OrthographicRaysAreParallelAndScaled) {
  Film film;
  film.width = 200, film.height = 100;
  Camera c;
  c.projection = Camera::Projection::orthographic;
  c.to_world = Transform::translate({0, 0, -4}) * Transform::scale({3, 3, 1});
  const CameraRays camera(c, film);
  const Ray a = camera.ray(0, 50), b = camera.ray(100, 0);
  EXPECT_NEAR(a.direction.z, 1, 1e-6f);
  EXPECT_NEAR(a.origin.x, 3, 1e-6f);
  EXPECT_NEAR(b.origin.y, 1.5f, 1e-6f);
  EXPECT_NEAR(b.origin.z, -4, 1e-6f);
}

TEST(CameraRays, RefuseWhatMakesNoPicture) {
  Film film;
  Camera c = camera_at_origin();
  c.fov_deg = 180;
  EXPECT_THROW(CameraRays(c, film), Error);
  c = camera_at_origin();
  c.near_clip = 10, c.far_clip = 1;
  EXPECT_THROW(CameraRays(c, film), Error);
  film.width = 0;
  EXPECT_THROW(CameraRays(camera_at_origin(), film), Error);
}

} // namespace
} // namespace nacre
