#include "report/preview_scene.h"

#include "scene/sky.h"
#include "spectra/rgb.h"

namespace nacre {
namespace {

SpectrumSource linear_reflectance(const std::array<double, 3>& rgb) {
  if (rgb[0] == rgb[1] && rgb[1] == rgb[2]) return SpectrumSource::constant(static_cast<float>(rgb[0]));
  constexpr int first = 360, last = 830, step = 5; // the table behind the basis has this step
  std::vector<float> values;
  for (int nm = first; nm <= last; nm += 4 * step) {
    Wavelengths w;
    for (int i = 0; i < 4; ++i)
      w.lambda_nm[static_cast<std::size_t>(i)] = static_cast<float>(std::min(nm + i * step, last));
    const auto basis = rgb_basis(w);
    for (int i = 0; i < 4 && nm + i * step <= last; ++i)
      values.push_back(clamp(static_cast<float>(rgb[0]) * basis[0][i] +
                                 static_cast<float>(rgb[1]) * basis[1][i] +
                                 static_cast<float>(rgb[2]) * basis[2][i],
                             0.0f, 1.0f));
  }
  return SpectrumSource::regular(first, last, values);
}

ParameterSource source_of(const ParameterInfo& parameter, const std::array<double, 3>& v) {
  if (!parameter.per_channel) return static_cast<float>(v[0]);
  if (parameter.hi <= 1) return linear_reflectance(v);
  if (v[0] == v[1] && v[1] == v[2]) return SpectrumSource::constant(static_cast<float>(v[0]));
  return SpectrumSource::rgb_unbounded(static_cast<float>(v[0]), static_cast<float>(v[1]),
                                       static_cast<float>(v[2]));
}

Material matte(const std::string& id, float r, float g, float b) {
  Material m;
  m.id = id;
  m.lobes.push_back({"lambert", {SpectrumSource::rgb_reflectance(r, g, b)}, nullptr, 1});
  m.two_sided = true;
  return m;
}

Material chequered_floor(float squares) {
  Material m;
  m.id = "floor";
  m.two_sided = true;
  CheckerboardTexture pattern{SpectrumSource::rgb_reflectance(0.42f, 0.40f, 0.37f),
                              SpectrumSource::rgb_reflectance(0.16f, 0.155f, 0.15f)};
  // One unit of the pattern holds two squares a side.
  const auto texture = std::make_shared<Texture>(Texture{pattern, {squares / 2, 0, 0, 0, squares / 2, 0}});
  m.lobes.push_back({"lambert", {ParameterSource(std::shared_ptr<const Texture>(texture))}, nullptr, 1});
  return m;
}

} // namespace

Material scene_material(const MaterialSpec& spec) {
  Material m;
  m.id = spec.name;
  for (const LobeSpec& lobe : spec.lobes) {
    if (lobe.table) {
      m.lobes.push_back({"merl", {}, lobe.table, static_cast<float>(lobe.weight)});
      continue;
    }
    const ModelInfo& model = model_infos()[static_cast<std::size_t>(lobe.model)];
    Lobe out{model.name, {}, nullptr, static_cast<float>(lobe.weight)};
    for (std::size_t i = 0; i < model.parameters.size(); ++i)
      out.parameters.push_back(source_of(model.parameters[i], lobe.values[i]));
    m.lobes.push_back(std::move(out));
  }
  return m;
}

std::shared_ptr<const Image> preview_sky() {
  SkyOptions sky;
  sky.turbidity = 3;
  // Over the viewer's left shoulder: highlights stand clear of the outline and shadows fall back and right.
  const double elevation = 38 * pi / 180, azimuth = 52 * pi / 180;
  sky.sun_direction = {-std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                       std::cos(elevation) * std::cos(azimuth)};
  sky.ground_albedo = {0.22, 0.21, 0.20};
  return std::make_shared<const Image>(make_sky(sky));
}

Scene preview_scene(const MaterialSpec& material, std::shared_ptr<const Image> environment, int width,
                    int height) {
  Scene scene;
  scene.file = "preview";
  scene.film.width = width, scene.film.height = height;
  scene.integrator.max_depth = 8;
  scene.materials = {scene_material(material), chequered_floor(60), matte("wall", 0.32f, 0.35f, 0.40f)};
  constexpr float half = 15;
  scene.shapes.push_back(
      {"floor", Quad{{-half, 0, -half}, {0, 0, 2 * half}, {2 * half, 0, 0}}, 1, std::nullopt});
  scene.shapes.push_back({"sphere", Sphere{{0, 1, 0}, 1, {}, false}, 0, std::nullopt});
  scene.shapes.push_back({"small sphere", Sphere{{1.28f, 0.42f, 0.78f}, 0.42f, {}, false}, 0, std::nullopt});

  scene.camera.to_world = Transform::look_at({0.25, 1.9, 6.2}, {0.25, 0.82, 0}, {0, 1, 0});
  scene.camera.fov_deg = 34;
  scene.camera.fov_axis = Camera::FovAxis::x;
  EnvironmentLight light;
  light.radiance = environment ? std::move(environment) : preview_sky();
  scene.lights.push_back(light);
  return scene;
}

} // namespace nacre
