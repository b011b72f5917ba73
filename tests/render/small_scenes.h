#pragma once
// Scenes of a few shapes, and estimates of radiance at fixed wavelengths, so that tests meet no spectral
// noise.

#include "bsdf/list.h"
#include "core/statistics.h"
#include "render/path.h"

#include <memory>
#include <string>

namespace nacre::test {

inline const Wavelengths& fixed_wavelengths() {
  static const Wavelengths w = sample_wavelengths(0.1f);
  return w;
}

/// A lobe with every parameter at its default but those given.
inline Lobe lobe(const std::string& model, const std::map<std::string, ParameterSource>& values = {}) {
  Lobe l;
  l.model = model;
  for (const ParameterInfo& p : find_model(model).parameters) {
    const auto given = values.find(p.name);
    l.parameters.push_back(given == values.end() ? ParameterSource(float(p.initial)) : given->second);
  }
  return l;
}
inline Material material(Lobe l) {
  Material m;
  m.id = l.model;
  m.lobes.push_back(std::move(l));
  return m;
}
inline Material lambert(float reflectance) {
  return material(lobe("lambert", {{"reflectance", reflectance}}));
}

inline Shape shape(std::variant<TriangleMesh, Sphere, Quad, Disk, Cylinder> geometry,
                   int material_index = -1) {
  Shape s;
  s.id = "shape";
  s.geometry = std::move(geometry);
  s.material = material_index;
  return s;
}
inline Shape light(std::variant<TriangleMesh, Sphere, Quad, Disk, Cylinder> geometry, float radiance) {
  Shape s = shape(std::move(geometry));
  s.emission = radiance;
  return s;
}
inline Sphere sphere(Vec3f center, float radius) {
  Sphere s;
  s.center = center;
  s.radius = radius;
  s.to_world =
      Transform::translate({center.x, center.y, center.z}) * Transform::scale({radius, radius, radius});
  return s;
}
/// The square |x|, |y| < half in the plane z, normal +z.
inline Quad floor_at(float z, float half) { return {{-half, -half, z}, {2 * half, 0, 0}, {0, 2 * half, 0}}; }
/// The same with normal -z.
inline Quad ceiling_at(float z, float half) {
  return {{-half, -half, z}, {0, 2 * half, 0}, {2 * half, 0, 0}};
}

/// Mean and standard error of the radiance along `ray` at the first of the fixed wavelengths.
inline RunningMoments radiance(const Scene& scene, const Ray& ray, int samples, std::uint64_t seed = 1) {
  const World world(scene);
  const PathTracer tracer(world, scene.integrator);
  RunningMoments moments;
  for (int i = 0; i < samples; ++i) {
    IndependentSampler sampler(seed, 0, std::uint32_t(i));
    moments.add(double(tracer.radiance(ray, fixed_wavelengths(), sampler).radiance[0]));
  }
  return moments;
}
/// A ray that looks at the origin from above, a little aside, starting `height` above it.
inline Ray look_down(float height = 0.9f) {
  Ray r;
  r.origin = {0.3f, 0.2f, height};
  r.direction = normalize(-r.origin);
  return r;
}

} // namespace nacre::test
