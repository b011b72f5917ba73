#include "render/camera.h"

#include "core/error.h"

#include <cmath>

namespace nacre {
namespace {

/// Tangent of half the horizontal field of view.
double half_width_of(const Camera& camera, double aspect) {
  const double t = std::tan(camera.fov_deg * pi / 360);
  switch (camera.fov_axis) {
  case Camera::FovAxis::x:
    return t;
  case Camera::FovAxis::y:
    return t * aspect;
  case Camera::FovAxis::diagonal:
    return t / std::sqrt(1 + 1 / (aspect * aspect));
  case Camera::FovAxis::smaller:
    return aspect > 1 ? t * aspect : t;
  case Camera::FovAxis::larger:
    return aspect > 1 ? t : t * aspect;
  }
  return t;
}

} // namespace

CameraRays::CameraRays(const Camera& camera, const Film& film)
    : projection_(camera.projection), to_camera_(camera.to_world.inverse()),
      origin_(camera.to_world.point({0, 0, 0})), left_(camera.to_world.vector({1, 0, 0})),
      up_(camera.to_world.vector({0, 1, 0})), forward_(camera.to_world.vector({0, 0, 1})), width_(film.width),
      height_(film.height), near_(camera.near_clip), far_(camera.far_clip) {
  if (film.width < 1 || film.height < 1)
    throw Error("the film has " + std::to_string(film.width) + " x " + std::to_string(film.height) +
                " pixels");
  if (!(near_ >= 0 && near_ < far_))
    throw Error("the camera's clip planes must be 0 <= near < far, found near " + std::to_string(near_) +
                " and far " + std::to_string(far_));
  const bool perspective = projection_ == Camera::Projection::perspective;
  if (perspective && !(camera.fov_deg > 0 && camera.fov_deg < 180))
    throw Error("the field of view must lie between 0 and 180 degrees, found " +
                std::to_string(camera.fov_deg));
  half_width_ = perspective ? half_width_of(camera, width_ / height_) : 1;
  half_height_ = half_width_ * height_ / width_;
}

Ray CameraRays::ray(float x, float y) const {
  const double a = (1 - 2 * double(x) / width_) * half_width_;
  const double b = (1 - 2 * double(y) / height_) * half_height_;
  const auto single = [](const Vec3d& v) { return vec3<float>(v); };
  if (projection_ == Camera::Projection::orthographic)
    return {single(origin_ + left_ * a + up_ * b), float(near_), single(normalize(forward_)), float(far_)};
  const Vec3d d = left_ * a + up_ * b + forward_;
  const double stretch = length(d) / length(forward_); // distance along the ray per distance of a plane
  return {single(origin_), float(near_ * stretch), single(normalize(d)), float(far_ * stretch)};
}

Vec3d CameraRays::project(const Vec3d& p) const {
  const Vec3d local = to_camera_.point(p);
  return {0.5 - 0.5 * local.x / (local.z * half_width_), 0.5 - 0.5 * local.y / (local.z * half_height_),
          local.z};
}

} // namespace nacre
