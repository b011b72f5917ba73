#include "explorer/object_scene.h"

#include "core/error.h"
#include "report/curves.h"
#include "report/preview_scene.h"
#include "scene/mesh.h"
#include "scene/scene_material.h"
#include "scene/teapot.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <mutex>

namespace nacre {
namespace {

namespace fs = std::filesystem;

/// To the origin, and as large as fits into the unit sphere.
void fit_into_unit_sphere(TriangleMesh& mesh, const std::string& name) {
  if (mesh.positions.empty()) throw Error::in_file(name, "holds no triangle");
  constexpr float far = std::numeric_limits<float>::max();
  Vec3f lo{far, far, far}, hi{-far, -far, -far};
  for (const Vec3f& p : mesh.positions) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  const Vec3f middle = lo * 0.5f + hi * 0.5f;
  float radius = 0;
  for (const Vec3f& p : mesh.positions)
    radius = std::max(radius, length(p - middle));
  if (!(radius > 0)) throw Error::in_file(name, "all its points are one");
  for (Vec3f& p : mesh.positions)
    p = (p - middle) / radius;
}

std::string lower_ending(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return ending;
}

Shape make_shape(const ObjectView& view, const Folder& folder) {
  if (view.mesh == "sphere") return {"sphere", Sphere{}, 0, std::nullopt};
  if (view.mesh == "plane") return {"plane", Quad{{-1, 0, -1}, {0, 0, 2}, {2, 0, 0}}, 0, std::nullopt};
  TriangleMesh mesh;
  if (view.mesh == "teapot") {
    mesh = teapot_mesh(16);
  } else {
    const fs::path path = folder.existing(view.mesh);
    const std::string ending = lower_ending(path);
    if (ending == ".obj")
      mesh = read_obj(path.string());
    else if (ending == ".ply")
      mesh = read_ply(path.string());
    else if (ending == ".serialized")
      mesh = read_serialized(path.string()).mesh;
    else if (ending == ".gltf" || ending == ".glb")
      mesh = read_gltf(path.string());
    else
      throw Error::in_file(view.mesh,
                           "not a mesh: expected sphere, teapot, plane, or an .obj, .ply, .gltf, .glb or "
                           ".serialized file");
  }
  fit_into_unit_sphere(mesh, view.mesh);
  return {view.mesh, std::move(mesh), 0, std::nullopt};
}

/// The last picture read, and the sky: a slider must not read them anew.
class EnvironmentCache {
public:
  std::shared_ptr<const Image> sky() {
    const std::lock_guard lock(mutex_);
    if (!sky_) sky_ = preview_sky();
    return sky_;
  }
  std::shared_ptr<const Image> file(const fs::path& path) {
    std::error_code error;
    const auto key = fmt::format("{}\n{}\n{}", path.string(), fs::file_size(path, error),
                                 fs::last_write_time(path, error).time_since_epoch().count());
    const std::lock_guard lock(mutex_);
    if (key != key_) {
      file_ = std::make_shared<const Image>(read_image_linear(path.string()));
      key_ = key;
    }
    return file_;
  }

private:
  std::mutex mutex_;
  std::shared_ptr<const Image> sky_, file_;
  std::string key_;
};

EnvironmentCache& environments() {
  static EnvironmentCache cache;
  return cache;
}

} // namespace

Scene object_scene(const MaterialSpec& material, const ObjectView& view, const Folder& folder) {
  Scene scene;
  scene.file = "object";
  scene.film.width = view.width, scene.film.height = view.height;
  scene.integrator.max_depth = 12;
  scene.materials = {scene_material(material)};
  // A sheet, and what a file holds, is seen from both sides.
  scene.materials[0].two_sided = view.mesh != "sphere" && !transmits(material);
  scene.shapes.push_back(make_shape(view, folder));
  scene.camera.fov_axis = Camera::FovAxis::smaller;
  if (view.environment == "white") {
    scene.lights.push_back(ConstantLight{SpectrumSource::d65()});
    return scene;
  }
  EnvironmentLight light;
  light.radiance = view.environment == "sky" ? environments().sky()
                                             : environments().file(folder.existing(view.environment));
  light.to_world = Transform::rotate({0, 1, 0}, view.turn_deg);
  scene.lights.push_back(light);
  return scene;
}

} // namespace nacre
