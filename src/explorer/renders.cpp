// Requests that trace paths: the lit object, and scenes.
#include "core/parallel.h"
#include "explorer/desk.h"
#include "explorer/object_scene.h"
#include "explorer/orbit_camera.h"
#include "render/film.h"
#include "scene/reader.h"
#include "scene/scene_material.h"

#include <chrono>

namespace nacre {
namespace {

using Clock = std::chrono::steady_clock;

/// Renders pass after pass; the page sees the first at once and then some a second.
Answer trace(std::shared_ptr<Picture> picture, int samples, const Desk& desk, nlohmann::json first) {
  constexpr auto pause = std::chrono::milliseconds(150);
  desk.pictures.keep(desk.id, picture);
  constexpr int without_end = 1 << 20;
  RenderOptions options;
  options.samples_per_pixel = samples > 0 ? samples : without_end;
  options.quiet = true;
  options.variance = true;
  options.stopped = [&] { return desk.is_cancelled(); };
  Clock::time_point last_told{};
  const auto describe = [&](Answer& answer, double per_pixel) {
    answer.header.update(first);
    answer.header["samples"] = per_pixel;
    first = nlohmann::json::object();
  };
  options.on_pass = [&](const FilmBuffer& film, int done) {
    if (Clock::now() - last_told < pause || done == options.samples_per_pixel) return;
    const auto image = std::make_shared<const Image>(film.to_image(true));
    picture->show(image, done);
    Answer answer;
    describe(answer, done);
    answer.add_image("image", *image);
    desk.progress(samples > 0 ? double(done) / samples : 0, answer);
    last_told = Clock::now();
  };
  RenderResult result = picture->renderer().render(options);
  const double pixels = double(picture->scene().film.width) * picture->scene().film.height;
  const double per_pixel = double(result.samples) / pixels;
  const auto image = std::make_shared<const Image>(std::move(result.image));
  picture->show(image, per_pixel);
  Answer answer;
  describe(answer, per_pixel);
  answer.header["seconds"] = result.seconds;
  answer.header["complete"] = result.complete;
  answer.header["invalid_samples"] = result.invalid_samples;
  answer.add_image("image", *image);
  return answer;
}

constexpr int largest_side = 4096;
constexpr int most_samples = 1 << 20;

} // namespace

Answer answer_object(const Arguments& request, const Desk& desk) {
  const auto material = desk.materials.resolve(request.at("material"), desk.folder);
  ObjectView view;
  view.mesh = request.text("mesh", "sphere");
  view.environment = request.text("environment", "sky");
  view.width = request.whole("width", 512, 1, largest_side);
  view.height = request.whole("height", 512, 1, largest_side);
  view.turn_deg = request.angle("turn", 0, -36000, 36000);
  OrbitCamera camera;
  camera.distance = 4.2, camera.azimuth = 30, camera.elevation = 20;
  if (request.has("camera")) camera = OrbitCamera::parse(request.object("camera"), camera);
  Scene scene = object_scene(*material, view, desk.folder);
  camera.place(scene.camera);
  const std::string sampling = request.text("sampling", "mis");
  const std::vector<std::string> known{"mis", "bsdf", "light"};
  if (std::find(known.begin(), known.end(), sampling) == known.end())
    throw Error(fmt::format("unknown sampling '{}'{}", sampling, suggestion(sampling, known)));
  scene.integrator.light_finding = sampling == "mis"    ? LightFinding::both
                                   : sampling == "bsdf" ? LightFinding::bsdf
                                                        : LightFinding::lights;
  return trace(std::make_shared<Picture>(std::move(scene)), request.whole("samples", 64, 0, most_samples),
               desk, nlohmann::json::object());
}

Answer answer_render(const Arguments& request, const Desk& desk) {
  SceneOptions options;
  if (request.has("definitions"))
    for (const auto& [name, value] : request.at("definitions").items())
      options.definitions[name] = value.is_string() ? value.get<std::string>() : value.dump();
  const std::string name = request.text("scene");
  Scene scene = read_scene(desk.folder.existing(name).string(), options);
  if (const std::string integrator = request.text("integrator", ""); !integrator.empty())
    scene.integrator.name = integrator;
  const double scale = request.number("scale", 1, 0.01, 4);
  const auto scaled = [&](int n) { return std::clamp(int(std::lround(n * scale)), 1, largest_side); };
  scene.film.width = scaled(scene.film.width), scene.film.height = scaled(scene.film.height);
  OrbitCamera camera = OrbitCamera::of(scene);
  if (request.has("camera")) {
    camera = OrbitCamera::parse(request.object("camera"), camera);
    camera.place(scene.camera);
  }
  nlohmann::json ids = nlohmann::json::array();
  for (const Material& m : scene.materials)
    ids.push_back(m.id);
  if (request.has("swap"))
    for (const auto& [id, replacement] : request.at("swap").items()) {
      const auto found = std::find_if(scene.materials.begin(), scene.materials.end(),
                                      [&, &key = id](const Material& m) { return m.id == key; });
      if (found == scene.materials.end()) {
        const auto known = ids.get<std::vector<std::string>>();
        throw Error(fmt::format("{}: no material '{}' to swap{}", name, id, suggestion(id, known)));
      }
      Material swapped = scene_material(*desk.materials.resolve(replacement, desk.folder));
      swapped.id = id, swapped.two_sided = found->two_sided;
      *found = std::move(swapped);
    }
  const int samples =
      request.has("samples") ? request.whole("samples", 0, 0, most_samples) : scene.samples_per_pixel;
  nlohmann::json first{{"materials", ids},
                       {"integrator", scene.integrator.name},
                       {"camera", camera.to_json()},
                       {"warnings", scene.warnings}};
  return trace(std::make_shared<Picture>(std::move(scene)), samples, desk, std::move(first));
}

} // namespace nacre
