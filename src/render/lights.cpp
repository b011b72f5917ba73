#include "render/lights.h"

#include "core/error.h"
#include "core/warp.h"

namespace nacre {
namespace {

double luminance(const ParameterSource& source) {
  if (const float* x = std::get_if<float>(&source)) return *x;
  if (const auto* s = std::get_if<SpectrumSource>(&source)) return s->luminance();
  return std::get<std::shared_ptr<const Texture>>(source)->mean_luminance();
}

SampledSpectrum evaluate(const ParameterSource& source, Vec2f uv, const Wavelengths& w) {
  if (const float* x = std::get_if<float>(&source)) return SampledSpectrum(*x);
  if (const auto* s = std::get_if<SpectrumSource>(&source)) return s->eval(w);
  return std::get<std::shared_ptr<const Texture>>(source)->eval(uv, w);
}

double triangle_area(const TriangleMesh& mesh, std::size_t i) {
  const auto& t = mesh.triangles[i];
  const Vec3f a = mesh.positions[t[0]], e1 = mesh.positions[t[1]] - a, e2 = mesh.positions[t[2]] - a;
  return 0.5 * length(cross(e1, e2));
}

/// Area per unit of the two local coordinates at a point whose local derivatives are given.
double stretch(const Transform& t, const Vec3d& du, const Vec3d& dv) {
  return length(cross(t.vector(du), t.vector(dv)));
}
double cylinder_stretch(const Cylinder& c, double phi) {
  return stretch(c.to_world, {-std::sin(phi), std::cos(phi), 0}, {0, 0, 1});
}

/// Whether p sees the sphere from outside with a margin in which the cone of directions is well defined.
bool outside(const Sphere& s, const Vec3f& p) {
  return length_squared(p - s.center) > sqr(s.radius * 1.0001f) && !s.flip_normals;
}
/// 1 - cos of the half angle under which the sphere is seen, without cancellation.
float cone_height(const Sphere& s, const Vec3f& p) {
  const float sin2 = sqr(s.radius) / length_squared(p - s.center);
  return sin2 / (1 + safe_sqrt(1 - sin2));
}

/// Centre and extent of a shape, for the choice of lights alone: of skewed shapes roughly.
std::pair<Vec3f, float>
sphere_about(const std::variant<TriangleMesh, Sphere, Quad, Disk, Cylinder>& geometry) {
  // The middle and the half extent of what lies about it.
  const auto placed = [](const Transform& t, const Vec3d& middle, const Vec3d& half) {
    double radius2 = 0;
    for (const Vec3d& edge : {Vec3d{half.x, 0, 0}, Vec3d{0, half.y, 0}, Vec3d{0, 0, half.z}})
      radius2 += length_squared(t.vector(edge));
    return std::pair{vec3<float>(t.point(middle)), float(std::sqrt(radius2))};
  };
  return std::visit(
      [&](const auto& g) -> std::pair<Vec3f, float> {
        using T = std::decay_t<decltype(g)>;
        if constexpr (std::is_same_v<T, Sphere>)
          return {g.center, g.radius};
        else if constexpr (std::is_same_v<T, Quad>)
          return {g.corner + (g.edge_u + g.edge_v) * 0.5f,
                  0.5f * std::sqrt(length_squared(g.edge_u) + length_squared(g.edge_v))};
        else if constexpr (std::is_same_v<T, Disk>)
          return placed(g.to_world, {0, 0, 0}, {1, 1, 0});
        else if constexpr (std::is_same_v<T, Cylinder>)
          return placed(g.to_world, {0, 0, 0.5}, {1, 1, 0.5});
        else {
          Vec3f lo = g.positions[g.triangles[0][0]], hi = lo;
          for (const auto& t : g.triangles)
            for (const std::uint32_t i : t) {
              const Vec3f& p = g.positions[i];
              lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
              hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
            }
          return {(lo + hi) * 0.5f, 0.5f * length(hi - lo)};
        }
      },
      geometry);
}

/// The connection to a light that shines from one point, differently into different directions.
template <class Beam>
LightSample from_point(const Beam& light, const Vec3f& p, const Wavelengths& w) {
  const Vec3d at{p.x, p.y, p.z}, d = light.origin() - at;
  const double r = length(d);
  if (!(r > 0)) return {};
  return {vec3<float>(d / r), float(r), light.intensity(at, w) * float(1 / (r * r)), 1, true};
}

} // namespace

LightSet::LightSet(const Scene& scene, const SurfaceTable& surfaces, float scene_radius)
    : surfaces_(surfaces), light_of_shape_(scene.shapes.size(), -1) {
  for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
    const Shape& shape = scene.shapes[i];
    if (!shape.emission) continue;
    Area light{std::uint32_t(i), &shape, std::nullopt};
    if (const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry)) {
      std::vector<double> areas;
      for (std::size_t k = 0; k < mesh->triangles.size(); ++k)
        areas.push_back(triangle_area(*mesh, k));
      if (areas.empty()) continue;
      light.triangles.emplace(areas);
    }
    if (!(area(light) > 0)) continue;
    light_of_shape_[i] = int(lights_.size());
    lights_.emplace_back(std::move(light));
  }
  for (const Light& light : scene.lights) {
    std::visit(
        [&](const auto& l) {
          using T = std::decay_t<decltype(l)>;
          if constexpr (std::is_same_v<T, EnvironmentLight>)
            lights_.emplace_back(std::in_place_type<EnvironmentMap>, l);
          else if constexpr (std::is_same_v<T, SpotLight>)
            lights_.emplace_back(std::in_place_type<SpotBeam>, l);
          else if constexpr (std::is_same_v<T, ProjectorLight>)
            lights_.emplace_back(std::in_place_type<ProjectorBeam>, l);
          else
            lights_.emplace_back(l);
          if constexpr (std::is_same_v<T, EnvironmentLight> || std::is_same_v<T, ConstantLight>)
            infinite_.push_back(int(lights_.size()) - 1);
        },
        light);
  }
  if (lights_.empty()) return;
  std::vector<LightSummary> summaries;
  for (const Kind& light : lights_)
    summaries.push_back(summary(light, scene_radius));
  choice_ = LightChoice(std::move(summaries));
}

double LightSet::area(const Area& light) {
  return std::visit(
      [&](const auto& g) -> double {
        using T = std::decay_t<decltype(g)>;
        if constexpr (std::is_same_v<T, TriangleMesh>) {
          double sum = 0;
          for (std::size_t i = 0; i < g.triangles.size(); ++i)
            sum += triangle_area(g, i);
          return sum;
        } else if constexpr (std::is_same_v<T, Quad>)
          return length(cross(g.edge_u, g.edge_v));
        else if constexpr (std::is_same_v<T, Sphere>)
          return 4 * pi * sqr(double(g.radius));
        else if constexpr (std::is_same_v<T, Disk>)
          return pi * stretch(g.to_world, {1, 0, 0}, {0, 1, 0});
        else {
          double sum = 0;
          constexpr int n = 64;
          for (int i = 0; i < n; ++i)
            sum += cylinder_stretch(g, 2 * pi * i / n);
          return sum / n * 2 * pi;
        }
      },
      light.description->geometry);
}

double LightSet::power(const Kind& light, double scene_radius) {
  const double cross_section = pi * sqr(scene_radius);
  return std::visit(
      [&](const auto& l) -> double {
        using T = std::decay_t<decltype(l)>;
        if constexpr (std::is_same_v<T, Area>)
          return pi * area(l) * luminance(*l.description->emission);
        else if constexpr (std::is_same_v<T, PointLight>)
          return 4 * pi * l.intensity.luminance();
        else if constexpr (std::is_same_v<T, SpotBeam> || std::is_same_v<T, ProjectorBeam>)
          return l.power();
        else if constexpr (std::is_same_v<T, DirectionalLight>)
          return cross_section * l.irradiance.luminance();
        else if constexpr (std::is_same_v<T, ConstantLight>)
          return 4 * pi * cross_section * l.radiance.luminance();
        else
          return cross_section * l.luminance_integral();
      },
      light);
}

LightSummary LightSet::summary(const Kind& light, double scene_radius) {
  LightSummary result;
  result.power = power(light, scene_radius);
  std::visit(
      [&](const auto& l) {
        using T = std::decay_t<decltype(l)>;
        if constexpr (std::is_same_v<T, Area>)
          std::tie(result.center, result.radius) = sphere_about(l.description->geometry);
        else if constexpr (std::is_same_v<T, PointLight>)
          result.center = l.position;
        else if constexpr (std::is_same_v<T, SpotBeam> || std::is_same_v<T, ProjectorBeam>)
          result.center = vec3<float>(l.origin());
        else
          result.is_far = true;
      },
      light);
  return result;
}

float LightSet::area_density(const Area& light, const Surface& point) {
  return std::visit(
      [&](const auto& g) -> float {
        using T = std::decay_t<decltype(g)>;
        if constexpr (std::is_same_v<T, TriangleMesh>)
          return float(light.triangles->probability(int(point.primitive)) /
                       triangle_area(g, point.primitive));
        else if constexpr (std::is_same_v<T, Cylinder>)
          return float(1 / (2 * pi * cylinder_stretch(g, 2 * pi * point.uv.x)));
        else
          return float(1 / area(light));
      },
      light.description->geometry);
}

float LightSet::solid_angle_density(const Area& light, const Vec3f& p, const Surface& point) const {
  if (const auto* sphere = std::get_if<Sphere>(&light.description->geometry))
    if (outside(*sphere, p)) return float(0.5 * inv_pi) / cone_height(*sphere, p);
  const Vec3f d = point.p - p;
  const float distance2 = length_squared(d), cosine = -dot(d, point.ng) / std::sqrt(distance2);
  return cosine > 0 ? area_density(light, point) * distance2 / cosine : 0;
}

LightSample LightSet::connect(const Area& light, const Vec3f& p, Vec2f u, const Wavelengths& w) const {
  Hit hit;
  hit.shape = light.shape;
  hit.t = 0;
  Ray at; // of a sphere, whose points are told by position
  std::visit(
      [&](const auto& g) {
        using T = std::decay_t<decltype(g)>;
        if constexpr (std::is_same_v<T, TriangleMesh>) {
          const auto s = light.triangles->sample(u.x);
          hit.primitive = std::uint32_t(s.index);
          const float reused =
              clamp(s.x * float(light.triangles->size()) - float(s.index), 0.0f, 0x1.fffffep-1f);
          const Vec2f b = square_to_triangle(Vec2f{reused, u.y});
          hit.u = b.x, hit.v = b.y;
        } else if constexpr (std::is_same_v<T, Quad>) {
          hit.u = u.x, hit.v = u.y;
        } else if constexpr (std::is_same_v<T, Disk>) {
          const Vec2f d = square_to_disk(u);
          hit.u = d.x, hit.v = d.y;
        } else if constexpr (std::is_same_v<T, Cylinder>) {
          hit.u = float(2 * pi) * u.x, hit.v = u.y;
        } else if (outside(g, p)) {
          // A direction in the cone, and from it the point where it enters: in the plane of p, the centre and
          // that point, the angle alpha at the centre follows from sin(theta).
          const Vec3f axis = g.center - p;
          const float distance = length(axis), drop = u.x * cone_height(g, p);
          const float cos_theta = 1 - drop, sin2_theta = drop * (2 - drop), ratio = g.radius / distance;
          const float sin2_max = sqr(ratio);
          const float cos_alpha = sin2_theta / ratio + cos_theta * safe_sqrt(1 - sin2_theta / sin2_max);
          const float sin_alpha = safe_sqrt(1 - sqr(cos_alpha)), phi = float(2 * pi) * u.y;
          const Frame<float> frame = Frame<float>::around(axis / -distance);
          at.origin =
              g.center +
              frame.to_world({sin_alpha * std::cos(phi), sin_alpha * std::sin(phi), cos_alpha}) * g.radius;
        } else {
          at.origin = g.center + square_to_sphere(u) * g.radius;
        }
      },
      light.description->geometry);
  const Surface point = surfaces_.at(at, hit);
  const Vec3f d = point.p - p;
  const float distance = length(d);
  LightSample s;
  if (!(distance > 0)) return s;
  s.direction = d / distance;
  s.distance = distance;
  s.pdf = solid_angle_density(light, p, point);
  s.radiance = emitted(point, -s.direction, w);
  return s;
}

LightSample LightSet::connect(const PointLight& light, const Vec3f& p, Vec2f, const Wavelengths& w) const {
  const Vec3f d = light.position - p;
  const float r2 = length_squared(d), r = std::sqrt(r2);
  if (!(r2 > 0)) return {};
  return {d / r, r, light.intensity.eval(w) / r2, 1, true};
}

LightSample LightSet::connect(const SpotBeam& light, const Vec3f& p, Vec2f, const Wavelengths& w) const {
  return from_point(light, p, w);
}

LightSample LightSet::connect(const ProjectorBeam& light, const Vec3f& p, Vec2f, const Wavelengths& w) const {
  return from_point(light, p, w);
}

LightSample LightSet::connect(const DirectionalLight& light, const Vec3f&, Vec2f,
                              const Wavelengths& w) const {
  return {-normalize(light.direction), infinity, light.irradiance.eval(w), 1, true};
}

LightSample LightSet::connect(const ConstantLight& light, const Vec3f&, Vec2f u, const Wavelengths& w) const {
  return {square_to_sphere(u), infinity, light.radiance.eval(w), float(0.25 * inv_pi), false};
}

LightSample LightSet::connect(const EnvironmentMap& light, const Vec3f&, Vec2f u,
                              const Wavelengths& w) const {
  const auto s = light.sample(u);
  return {s.direction, infinity, light.radiance(s.direction, w), s.pdf, false};
}

LightSample LightSet::sample(const Vec3f& p, float u_light, Vec2f u, const Wavelengths& w) const {
  if (choice_.empty()) return {};
  const int chosen = choice_.sample(p, u_light);
  LightSample s =
      std::visit([&](const auto& l) { return connect(l, p, u, w); }, lights_[std::size_t(chosen)]);
  if (s.pdf > 0 && infinite_.size() > 1 && s.distance == infinity && !s.is_delta) {
    // Several lights share a direction from infinity: the sample stands for all of them, as a ray that
    // escapes does.
    s.radiance = background(s.direction, w);
    s.pdf = background_pdf(s.direction);
    return s;
  }
  s.pdf *= choice_.probability(chosen, p);
  return s;
}

SampledSpectrum LightSet::emitted(const Surface& s, const Vec3f& wo, const Wavelengths& w) const {
  if (s.instance != Hit::none || light_of_shape_[s.shape] < 0 || dot(s.ng, wo) <= 0) return {};
  const auto& light = std::get<Area>(lights_[std::size_t(light_of_shape_[s.shape])]);
  return evaluate(*light.description->emission, s.uv, w);
}

float LightSet::pdf(const Vec3f& p, const Surface& s) const {
  if (s.instance != Hit::none || light_of_shape_[s.shape] < 0) return 0;
  const int i = light_of_shape_[s.shape];
  return choice_.probability(i, p) * solid_angle_density(std::get<Area>(lights_[std::size_t(i)]), p, s);
}

SampledSpectrum LightSet::background(const Vec3f& d, const Wavelengths& w) const {
  SampledSpectrum sum;
  for (const int i : infinite_) {
    const Kind& light = lights_[std::size_t(i)];
    if (const auto* map = std::get_if<EnvironmentMap>(&light))
      sum += map->radiance(d, w);
    else
      sum += std::get<ConstantLight>(light).radiance.eval(w);
  }
  return sum;
}

float LightSet::background_pdf(const Vec3f& d) const {
  float sum = 0;
  for (const int i : infinite_) {
    const auto* map = std::get_if<EnvironmentMap>(&lights_[std::size_t(i)]);
    sum += choice_.far_probability(i) * (map ? map->pdf(d) : float(0.25 * inv_pi));
  }
  return sum;
}

} // namespace nacre
