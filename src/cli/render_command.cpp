#include "cli/commands.h"
#include "cli/exit_status.h"
#include "cli/number_range.h"
#include "core/error.h"
#include "core/parallel.h"
#include "render/render.h"
#include "scene/reader.h"

#include <filesystem>
#include <fmt/format.h>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace nacre {
namespace {

struct RenderArguments {
  std::string scene, output, integrator;
  std::vector<std::string> definitions, folders;
  RenderOptions options;
  bool strict = false, json = false;
};

/// A long render must not fail at its end for a reason that is known at its beginning.
void check_output(const std::string& path) {
  namespace fs = std::filesystem;
  const fs::path p(path);
  if (p.extension() != ".exr")
    throw UsageError(fmt::format(
        "'{}': render writes linear pictures, .exr; turn one into .png with 'nacre tonemap'", path));
  const fs::path folder = p.has_parent_path() ? p.parent_path() : fs::path(".");
  if (!fs::is_directory(folder)) throw Error(fmt::format("the folder '{}' does not exist", folder.string()));
  if (fs::is_directory(p)) throw Error(fmt::format("'{}' is a folder", path));
  if (access(folder.c_str(), W_OK) != 0)
    throw Error(fmt::format("the folder '{}' is not writable", folder.string()));
}

std::map<std::string, std::string> parse_definitions(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> result;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw UsageError(fmt::format("-D expects NAME=VALUE, found '{}'", text));
    result[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return result;
}

void run(const RenderArguments& a) {
  check_output(a.output);
  for (const std::string& folder : a.folders)
    if (!std::filesystem::is_directory(folder))
      throw Error(fmt::format("-I: there is no folder '{}'", folder));
  Scene scene = read_scene(a.scene, {a.folders, parse_definitions(a.definitions), a.strict});
  for (const std::string& warning : scene.warnings)
    std::cerr << "nacre: warning: " << warning << "\n";
  if (!a.integrator.empty()) scene.integrator.name = a.integrator;

  catch_ctrl_c();
  const RenderResult result = render(scene, a.options);
  const bool interrupted = stop_requested();
  if (result.samples == 0) {
    std::cerr << "nacre: stopped before the first sample: nothing is written\n";
    throw ExitStatus{exit_interrupted};
  }
  if (result.invalid_samples > 0)
    std::cerr << fmt::format("nacre: warning: {} of {} samples were infinite or NaN and count as black\n",
                             result.invalid_samples, result.samples);
  write_exr(result.image, a.output);

  const double per_pixel = double(result.samples) / (double(scene.film.width) * scene.film.height);
  if (a.json) {
    std::cout << nlohmann::json{{"output", a.output},
                                {"width", scene.film.width},
                                {"height", scene.film.height},
                                {"samples_per_pixel", per_pixel},
                                {"samples", result.samples},
                                {"rays", result.rays},
                                {"invalid_samples", result.invalid_samples},
                                {"seconds", result.seconds},
                                {"complete", result.complete},
                                {"warnings", scene.warnings}}
                     .dump(2)
              << "\n";
  } else if (!a.options.quiet) {
    std::cerr << fmt::format("{}: {} x {}, {:g} samples a pixel, {:.1f} s, {:.2f} million rays a second\n",
                             a.output, scene.film.width, scene.film.height, per_pixel, result.seconds,
                             double(result.rays) / result.seconds * 1e-6);
  }
  if (interrupted) {
    std::cout.flush();
    throw ExitStatus{exit_interrupted};
  }
}

} // namespace

void add_render_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("render", "light a scene and write the picture");
  auto a = std::make_shared<RenderArguments>();
  command->add_option("SCENE", a->scene, "scene file")->required();
  command->add_option("-o,--output", a->output, "picture to write, .exr, linear sRGB")->required();
  command->add_option("--spp", a->options.samples_per_pixel, "samples per pixel, instead of the scene's")
      ->check(whole_number_in(1, 1 << 20));
  command->add_option("--integrator", a->integrator, "instead of the scene's: path, direct")
      ->check(CLI::IsMember({"path", "direct"}));
  command->add_option("--time", a->options.time_limit_s, "seconds after which no new work begins")
      ->check(number_in(1e-3, 1e9));
  command->add_option("-D", a->definitions, "NAME=VALUE: a parameter of the scene; may be repeated")
      ->allow_extra_args(false);
  command
      ->add_option("-I", a->folders,
                   "folder in which files named by the scene are looked up; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--seed", a->options.seed, "of all chance; the same seed gives the same picture")
      ->check(any_whole_number());
  command->add_flag("--variance", a->options.variance, "also write the variance of each pixel");
  command->add_flag("--strict", a->strict, "a warning is an error");
  command->add_flag("--quiet", a->options.quiet, "no progress");
  command->add_flag("--json", a->json, "one JSON object on standard output");
  command->footer("Ctrl-C writes what is done, and the exit status is 130.\n"
                  "\nExamples:\n"
                  "  nacre render scene.xml -o picture.exr --spp 64\n"
                  "  nacre render scene.xml -o picture.exr --time 60 -D spp=256 --variance");
  command->callback([a] { run(*a); });
}

} // namespace nacre
