// Sensor, film, reconstruction filter, sampler and integrator.

#include "core/error.h"
#include "core/text_scanner.h"
#include "scene/mitsuba/context.h"

#include <cmath>

namespace nacre::mitsuba {
namespace {

/// The one nested object of that tag, or null.
const Node* at_most_one(Parameters& p, std::string_view tag) {
  const auto nested = p.objects(tag);
  if (nested.size() > 1) nested[1]->fail("more than one <" + std::string(tag) + ">");
  return nested.empty() ? nullptr : nested[0];
}

float positive(Parameters& p, std::string_view name, double initial) {
  const double v = p.number(name, initial);
  if (!(v > 0) || v > 100) p.at(name).fail("'" + std::string(name) + "' must lie in (0, 100] pixels");
  return static_cast<float>(v);
}

void filter(const Node& node, const Document& document, Film& film) {
  Parameters p(node, document);
  const std::string& type = p.type();
  if (type == "box") {
    film.filter = FilterKind::box;
    if (p.has("radius")) film.filter_radius = positive(p, "radius", 0.5);
  } else if (type == "tent") {
    film.filter = FilterKind::tent;
    if (p.has("radius")) film.filter_radius = positive(p, "radius", 1);
  } else if (type == "gaussian") {
    film.filter = FilterKind::gaussian;
    film.filter_stddev = positive(p, "stddev", 0.5);
  } else if (type == "mitchell") {
    film.filter = FilterKind::mitchell;
    for (const std::string_view name : {"A", "B", "C", "a", "b", "c"})
      if (p.has(name) && std::abs(p.number(name, 0) - 1.0 / 3) > 1e-3)
        p.at(name).fail("Mitchell filters other than B = C = 1/3 are not supported");
  } else if (type == "catmullrom") {
    film.filter = FilterKind::catmull_rom;
  } else if (type == "lanczos") {
    film.filter = FilterKind::lanczos;
    const int lobes = p.integer("lobes", 3);
    if (lobes < 1 || lobes > 16) p.at("lobes").fail("'lobes' must lie in [1, 16]");
    film.filter_radius = static_cast<float>(lobes);
  } else {
    Context::unknown_plugin(node, {"box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"});
  }
  p.finish();
}

Film read_film(const Node& node, const Document& document) {
  Parameters p(node, document);
  if (p.type() != "hdrfilm" && p.type() != "ldrfilm") Context::unknown_plugin(node, {"hdrfilm", "ldrfilm"});
  Film film;
  film.width = p.integer("width", film.width);
  film.height = p.integer("height", film.height);
  for (const std::string_view name : {"width", "height"}) {
    const int size = name == "width" ? film.width : film.height;
    if (size < 1 || size > 65536)
      p.at(name).fail("'" + std::string(name) + "' must lie in [1, 65536] pixels, found " +
                      std::to_string(size));
  }
  for (const std::string_view name : {"crop_offset_x", "crop_offset_y", "crop_width", "crop_height"})
    if (p.has(name)) p.at(name).fail("a cropped film is not supported");
  // How the result is written is the command's to say.
  p.ignore({"pixel_format", "component_format", "file_format", "banner", "high_quality_edges", "attach_log",
            "sample_border", "compensate", "gamma", "exposure", "tonemap_method"});
  if (const Node* nested = at_most_one(p, "rfilter")) filter(*nested, document, film);
  p.finish();
  return film;
}

void sampler(const Node& node, const Document& document, Scene& scene) {
  Parameters p(node, document);
  const std::string& type = p.type();
  const std::vector<std::string> known{"independent", "stratified", "multijitter", "orthogonal",
                                       "ldsampler",   "sobol",      "halton",      "hammersley"};
  if (std::find(known.begin(), known.end(), type) == known.end()) Context::unknown_plugin(node, known);
  // Any better sampler differs in noise alone.
  scene.sampler = type == "independent" ? "independent" : "sobol";
  scene.samples_per_pixel = p.integer("sample_count", 4);
  if (scene.samples_per_pixel < 1) p.at("sample_count").fail("'sample_count' must be at least 1");
  p.ignore({"seed", "jitter", "dimension", "strength", "scramble"});
  p.finish();
}

/// Full angle of a 36 mm x 24 mm picture's diagonal behind a lens of that focal length, degrees.
double diagonal_fov_deg(Parameters& p) {
  std::string text = p.text("focal_length", "50mm");
  if (text.ends_with("mm")) text.resize(text.size() - 2);
  double millimetres = 0;
  if (!parse_number(text, millimetres) || !(millimetres > 0) || !std::isfinite(millimetres))
    p.at("focal_length").fail("expected a focal length such as 50mm, found " + in_quotes(text));
  return 2 * std::atan(std::sqrt(36.0 * 36 + 24.0 * 24) / (2 * millimetres)) * 180 / pi;
}

} // namespace

void Context::field_of_view(Parameters& p, Camera& camera) {
  using FovAxis = Camera::FovAxis;
  if (!p.has("fov")) { // as in Mitsuba, a 50 mm lens
    camera.fov_axis = FovAxis::diagonal;
    camera.fov_deg = diagonal_fov_deg(p);
    p.ignore({"fov_axis"});
  } else {
    if (p.has("focal_length")) p.at("focal_length").fail("'fov' and 'focal_length' exclude each other");
    camera.fov_deg = p.number("fov", 50);
    const std::string axis = p.choice("fov_axis", "x", {"x", "y", "diagonal", "smaller", "larger"});
    camera.fov_axis = axis == "x"          ? FovAxis::x
                      : axis == "y"        ? FovAxis::y
                      : axis == "diagonal" ? FovAxis::diagonal
                      : axis == "smaller"  ? FovAxis::smaller
                                           : FovAxis::larger;
  }
  if (!(camera.fov_deg > 0 && camera.fov_deg < 180))
    p.at("fov").fail("'fov' must lie between 0 and 180 degrees");
}

namespace {

void perspective(Parameters& p, Camera& camera) {
  Context::field_of_view(p, camera);
  for (const std::string_view name : {"principal_point_offset_x", "principal_point_offset_y"})
    if (p.number(name, 0) != 0) p.at(name).fail("a shifted principal point is not supported");
}

} // namespace

void Context::sensor(const Node& node) {
  const Opened opened(*this, node);
  Parameters p(node, document);
  Camera& camera = scene.camera;
  if (p.type() == "perspective") {
    camera.projection = Camera::Projection::perspective;
    perspective(p, camera);
  } else if (p.type() == "orthographic") {
    camera.projection = Camera::Projection::orthographic;
  } else {
    unknown_plugin(node, {"perspective", "orthographic"});
  }
  camera.to_world = p.transform();
  located(p.at("to_world"), [&] { return camera.to_world.inverse(); });
  camera.near_clip = p.number("near_clip", camera.near_clip);
  camera.far_clip = p.number("far_clip", camera.far_clip);
  if (!(camera.near_clip > 0)) p.at("near_clip").fail("'near_clip' must be positive");
  if (!(camera.far_clip > camera.near_clip)) p.at("far_clip").fail("'far_clip' must exceed 'near_clip'");
  // A pinhole has no focus, and nothing moves here.
  p.ignore({"focus_distance", "shutter_open", "shutter_close"});
  if (const Node* film = at_most_one(p, "film")) scene.film = read_film(*film, document);
  if (const Node* nested = at_most_one(p, "sampler")) sampler(*nested, document, scene);
  p.finish();
}

void Context::integrator(const Node& node) {
  const Opened opened(*this, node);
  Parameters p(node, document);
  IntegratorSettings& settings = scene.integrator;
  if (p.type() == "moment") { // wraps one whose statistics it gathers; every render here has those
    const auto nested = p.objects("integrator");
    if (nested.size() != 1) node.fail("integrator 'moment' takes one nested integrator");
    p.finish();
    return integrator(*nested[0]);
  }
  if (p.type() == "path") {
    settings.max_depth = p.integer("max_depth", -1);
    settings.russian_roulette_depth = p.integer("rr_depth", 5);
    if (settings.max_depth < -1) p.at("max_depth").fail("'max_depth' must be at least 0, or -1 for no limit");
    if (settings.russian_roulette_depth < 1) p.at("rr_depth").fail("'rr_depth' must be at least 1");
  } else if (p.type() == "direct") {
    settings.max_depth = 2;
    p.ignore({"emitter_samples", "bsdf_samples", "shading_samples"});
  } else {
    unknown_plugin(node, {"path", "direct", "moment"});
  }
  settings.name = p.type();
  settings.hide_emitters = p.boolean("hide_emitters", false);
  if (p.boolean("strict_normals", false)) p.at("strict_normals").fail("'strict_normals' is not supported");
  p.ignore({"samples_per_pass", "block_size", "timeout", "render_priority"});
  p.finish();
}

} // namespace nacre::mitsuba
