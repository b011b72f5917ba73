// Lights.

#include "core/error.h"
#include "scene/mitsuba/context.h"
#include "scene/sky.h"

#include <cmath>

namespace nacre::mitsuba {
namespace {

const std::vector<std::string> known_emitters{"area",     "point",  "spot", "projector", "directional",
                                              "constant", "envmap", "sky",  "sunsky"};

PointLight point(Context& context, Parameters& p) {
  if (p.has("position") && p.has("to_world"))
    p.at("position").fail("'position' and 'to_world' exclude each other");
  const Vec3d position = p.vector("position").value_or(p.transform().point({0, 0, 0}));
  return {vec3<float>(position), context.spectrum(p, "intensity", SpectrumUse::emission, 1)};
}

SpotLight spot(Context& context, Parameters& p) {
  const double cutoff = p.number("cutoff_angle", 20), beam = p.number("beam_width", cutoff * 0.75);
  if (!(cutoff > 0 && cutoff <= 180))
    p.at("cutoff_angle").fail("'cutoff_angle' must lie in (0, 180] degrees");
  if (!(beam >= 0 && beam <= cutoff)) p.at("beam_width").fail("'beam_width' must lie in [0, cutoff_angle]");
  const Transform to_world = p.transform();
  located(p.at("to_world"), [&] { return to_world.inverse(); });
  std::shared_ptr<const Texture> picture;
  if (const Node* texture = p.find("texture")) {
    if (texture->tag != "texture")
      p.at("texture").fail("'texture' must be a texture, found <" + texture->tag + ">");
    if (cutoff >= 90)
      p.at("texture").fail("a spot light with a texture needs a 'cutoff_angle' below 90 degrees");
    picture = context.texture(*texture, TextureUse::reflectance); // 'intensity' brings the light
  }
  return {to_world, context.spectrum(p, "intensity", SpectrumUse::emission, 1),
          static_cast<float>(cutoff * pi / 180), static_cast<float>(beam * pi / 180), std::move(picture)};
}

/// Whether lengths and angles survive the transform, within the digits people write.
bool is_rigid(const Transform& t) {
  const Vec3d axes[3] = {t.vector({1, 0, 0}), t.vector({0, 1, 0}), t.vector({0, 0, 1})};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      if (!(std::abs(dot(axes[i], axes[j]) - (i == j ? 1 : 0)) < 1e-3)) return false;
  return true;
}

ProjectorLight projector(Context& context, Parameters& p) {
  ProjectorLight light;
  const Node* picture = p.find("irradiance");
  if (picture == nullptr) p.node().fail("a projector needs a texture named 'irradiance'");
  if (picture->tag != "texture")
    p.at("irradiance").fail("'irradiance' must be a texture, found <" + picture->tag + ">");
  light.picture = context.texture(*picture, TextureUse::emission);
  Context::field_of_view(p, light.lens);
  light.lens.to_world = p.transform();
  if (!is_rigid(light.lens.to_world))
    p.at("to_world").fail("a projector can be moved and turned, not scaled or sheared");
  const double scale = p.number("scale", 1);
  if (!(scale >= 0)) p.at("scale").fail("'scale' must not be negative");
  light.scale = static_cast<float>(scale);
  return light;
}

DirectionalLight directional(Context& context, Parameters& p) {
  if (p.has("direction") && p.has("to_world"))
    p.at("direction").fail("'direction' and 'to_world' exclude each other");
  const Vec3d d = p.vector("direction").value_or(p.transform().vector({0, 0, 1}));
  const double l = length(d);
  if (!(l > 0) || !std::isfinite(l)) p.at("direction").fail("'direction' must not be 0");
  return {vec3<float>(d / l), context.spectrum(p, "irradiance", SpectrumUse::emission, 1)};
}

EnvironmentLight environment_map(Context& context, Parameters& p) {
  EnvironmentLight light;
  if (p.has("gamma") && p.number("gamma", -1) != -1) p.at("gamma").fail("'gamma' is not supported");
  p.ignore({"mis_compensation", "cache", "sampling_weight", "samples"});
  const std::string path = p.file();
  light.radiance =
      located(p.at("filename"), [&] { return std::make_shared<const Image>(read_image_linear(path)); });
  const Image& image = *light.radiance;
  const bool is_grey = image.channel("Y") >= 0;
  if (!is_grey && (image.channel("R") < 0 || image.channel("G") < 0 || image.channel("B") < 0))
    p.at("filename").fail("the picture '" + path + "' has no channels R, G, B or Y");
  if (image.width < 2 || image.height < 3)
    p.at("filename").fail("an environment map needs at least 2 x 3 pixels");
  // Whoever reads the light wants R, G, B in this order.
  auto rgb = std::make_shared<Image>(image.width, image.height, std::vector<std::string>{"R", "G", "B"});
  const int from[3] = {image.channel(is_grey ? "Y" : "R"), image.channel(is_grey ? "Y" : "G"),
                       image.channel(is_grey ? "Y" : "B")};
  std::size_t negative = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const float v = image.at(x, y)[from[c]];
        if (!std::isfinite(v))
          p.at("filename")
              .fail("pixel (" + std::to_string(x) + ", " + std::to_string(y) + ") of '" + path +
                    "' is not a finite number");
        negative += v < 0;
        rgb->at(x, y)[c] = std::max(v, 0.0f);
      }
  if (negative > 0)
    context.warn(p.at("filename"),
                 std::to_string(negative) + " negative values of '" + path + "' count as 0");
  light.radiance = std::move(rgb);
  const double scale = p.number("scale", 1);
  if (!(scale >= 0)) p.at("scale").fail("'scale' must not be negative");
  light.scale = static_cast<float>(scale);
  light.to_world = p.transform();
  located(p.at("to_world"), [&] { return light.to_world.inverse(); });
  return light;
}

/// Nacre's own: `sunsky` with turbidity, sun_direction or sun_elevation and sun_azimuth in degrees (from
/// north, -z, to east, +x), albedo, sun_scale, sky_scale, scale, resolution (texels from pole to pole); `sky`
/// is the same without the sun.
EnvironmentLight daylight(Context& context, Parameters& p) {
  SkyOptions options;
  options.turbidity = p.number("turbidity", options.turbidity);
  if (p.has("sun_direction") && (p.has("sun_elevation") || p.has("sun_azimuth")))
    p.at("sun_direction").fail("'sun_direction' and 'sun_elevation', 'sun_azimuth' exclude each other");
  const double elevation = p.number("sun_elevation", 45) * pi / 180,
               azimuth = p.number("sun_azimuth", 0) * pi / 180;
  options.sun_direction = p.vector("sun_direction")
                              .value_or(Vec3d{std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                                              -std::cos(elevation) * std::cos(azimuth)});
  const RGB albedo = context.spectrum(p, "albedo", SpectrumUse::reflectance, 0.2f).to_srgb_reflectance();
  const auto unit = [](double v) { return clamp(v, 0.0, 1.0); };
  options.ground_albedo = {unit(albedo[0]), unit(albedo[1]), unit(albedo[2])};
  options.sky_scale = p.number("sky_scale", 1);
  options.sun_scale = p.type() == "sky" ? 0 : p.number("sun_scale", 1);
  options.height = p.integer("resolution", options.height);
  if (options.height > 8192) p.at("resolution").fail("'resolution' must not exceed 8192");
  options.width = 2 * options.height;
  EnvironmentLight light;
  light.radiance = located(p.node(), [&] { return std::make_shared<const Image>(make_sky(options)); });
  const double scale = p.number("scale", 1);
  if (!(scale >= 0)) p.at("scale").fail("'scale' must not be negative");
  light.scale = static_cast<float>(scale);
  light.to_world = p.transform();
  located(p.at("to_world"), [&] { return light.to_world.inverse(); });
  return light;
}

} // namespace

ParameterSource Context::area_emission(const Node& node) {
  area_emitter_is_used[&node] = true;
  Parameters p(node, document);
  if (p.type() != "area") node.fail("a shape can hold an emitter of type area, found '" + p.type() + "'");
  p.ignore({"sampling_weight", "samples"});
  ParameterSource emission = color(p, "radiance", SpectrumUse::emission).value_or(SpectrumSource::d65(1));
  p.finish();
  return emission;
}

void Context::emitter(const Node& node) {
  if (node.get("type") == "area") {
    area_emitter_is_used.emplace(&node, false);
    return;
  }
  Parameters p(node, document);
  p.ignore({"sampling_weight", "samples"});
  const std::string& type = p.type();
  std::optional<Light> light;
  if (type == "point")
    light = point(*this, p);
  else if (type == "spot")
    light = spot(*this, p);
  else if (type == "projector")
    light = projector(*this, p);
  else if (type == "directional")
    light = directional(*this, p);
  else if (type == "constant")
    light = ConstantLight{spectrum(p, "radiance", SpectrumUse::emission, 1)};
  else if (type == "envmap")
    light = environment_map(*this, p);
  else if (type == "sky" || type == "sunsky")
    light = daylight(*this, p);
  else
    unknown_plugin(node, known_emitters);
  p.finish();
  scene.lights.push_back(std::move(*light));
}

} // namespace nacre::mitsuba
