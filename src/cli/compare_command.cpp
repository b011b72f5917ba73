#include "cli/commands.h"
#include "cli/exit_status.h"
#include "cli/number_range.h"
#include "core/error.h"
#include "display/colormap.h"
#include "display/compare.h"
#include "display/rgb_planes.h"
#include "display/ztest.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

struct CompareCommand {
  std::string picture, reference, variance, flip_map, difference, z_map;
  std::vector<std::string> names;
  CompareOptions options;
  double start_exposure = 0, stop_exposure = 0;
  int exposures = 0, spp = 0;
  bool json = false, has_start = false, has_stop = false, has_exposures = false;
};

std::string compare_footer() {
  std::string text = "Measures (a the picture, b the reference, means over pixels and R, G, B):\n";
  for (const ImageMetric& m : metrics())
    text += fmt::format("  {:<15} {}: {}\n", m.name, m.meaning, m.formula);
  return text + "\nWithout --metric: rmse, mae, bias, relmse, relmse-trimmed, psnr and FLIP (hdr-flip if "
                "either is .exr).\n"
                "With --variance and --spp the z-test of Mitsuba's render tests is made; exit status 3 if it "
                "fails.\n"
                "\nExamples:\n"
                "  nacre compare mine.exr reference.exr\n"
                "  nacre compare mine.exr reference.exr --metric rmse,hdr-flip --flip-map error.png --json\n"
                "  nacre compare mine.exr ref.exr --variance ref_var.exr --spp 128";
}

/// The errors of a check of what was typed are errors of usage.
template <class F>
void as_usage(F&& f) {
  try {
    f();
  } catch (const UsageError&) {
    throw;
  } catch (const Error& e) {
    throw UsageError(e.what());
  }
}

bool asked_for(const std::vector<std::string>& names, const char* name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> names_to_measure(const CompareCommand& o) {
  std::vector<std::string> names = o.names;
  const bool hdr = o.picture.ends_with(".exr") || o.reference.ends_with(".exr");
  const char* flip = hdr ? "hdr-flip" : "flip";
  if (names.empty())
    names = {"rmse", "mae", "bias", "relmse", "relmse-trimmed", "psnr", flip};
  else if (!o.flip_map.empty() && !asked_for(names, "flip") && !asked_for(names, "hdr-flip"))
    names.push_back(flip);
  return names;
}

nlohmann::json number(double v) { return std::isfinite(v) ? nlohmann::json(v) : nlohmann::json(); }

nlohmann::json to_json(const FlipResult& flip, const FlipOptions& options, bool hdr) {
  nlohmann::json json{
      {"mean", flip.mean}, {"max", flip.max}, {"pixels_per_degree", options.pixels_per_degree}};
  if (hdr) {
    json["start_exposure"] = flip.start_exposure;
    json["stop_exposure"] = flip.stop_exposure;
    json["exposures"] = flip.exposures;
  }
  return json;
}

nlohmann::json to_json(const ZTestResult& z, int spp) {
  return {
      {"pass", z.pass},
      {"accepted_share", z.accepted_share},
      {"level", z.level},
      {"rms_z", number(z.rms_z)},
      {"largest_z", number(z.largest_z)},
      {"worst", {{"x", z.worst_x}, {"y", z.worst_y}, {"channel", std::string(1, "XYZ"[z.worst_channel])}}},
      {"spp", spp}};
}

void write_map(const Image& errors, const std::string& path) {
  if (path.ends_with(".exr"))
    write_exr(errors, path);
  else
    write_png(colour_map(errors), path);
}

void print(const Comparison& comparison, const std::optional<ZTestResult>& z) {
  for (const auto& [name, value] : comparison.values)
    std::cout << fmt::format("{:<15} {:.6g}{}\n", name, value, name == "psnr" ? " dB" : "");
  if (const auto& flip = comparison.hdr_flip)
    std::cout << fmt::format("                (hdr-flip over {} exposures from {:.4f} to {:.4f} stops)\n",
                             flip->exposures, flip->start_exposure, flip->stop_exposure);
  if (z)
    std::cout << fmt::format(
        "{:<15} {}: {:.3f} % of pixel-channels accepted, largest |z| {:.2f} at ({}, {}) {}, "
        "rms z {:.3f}\n",
        "z-test", z->pass ? "holds" : "fails", 100 * z->accepted_share, z->largest_z, z->worst_x, z->worst_y,
        "XYZ"[z->worst_channel], z -> rms_z);
}

void run_compare(CompareCommand& o) {
  const bool with_z = !o.variance.empty();
  if (with_z != (o.spp != 0)) throw UsageError("the z-test needs both --variance and --spp");
  if (!o.z_map.empty() && !with_z) throw UsageError("--z-map needs --variance and --spp");
  if (!o.flip_map.empty() && !o.flip_map.ends_with(".png") && !o.flip_map.ends_with(".exr"))
    throw UsageError(fmt::format("--flip-map: expected a .png or .exr, found '{}'", o.flip_map));
  for (const std::string& path : {o.difference, o.z_map})
    if (!path.empty() && !path.ends_with(".exr"))
      throw UsageError(fmt::format("--difference and --z-map write .exr, found '{}'", path));
  if (o.has_start) o.options.flip.start_exposure = o.start_exposure;
  if (o.has_stop) o.options.flip.stop_exposure = o.stop_exposure;
  if (o.has_exposures) o.options.flip.exposures = o.exposures;
  const std::vector<std::string> names = names_to_measure(o);
  as_usage([&] { check(names, o.options); });
  if ((o.has_start || o.has_stop || o.has_exposures) && !asked_for(names, "hdr-flip"))
    throw UsageError("exposures are for hdr-flip, which is not asked for");

  const Image picture = read_image_linear(o.picture), reference = read_image_linear(o.reference);
  require_same_size(picture, reference, o.picture, o.reference);
  const Comparison comparison = compare(picture, reference, names, o.options);
  std::optional<ZTestResult> z;
  if (with_z) z = z_test(picture, reference, read_image_linear(o.variance), o.spp);

  if (!o.flip_map.empty())
    write_map((comparison.hdr_flip ? comparison.hdr_flip : comparison.flip)->error, o.flip_map);
  if (!o.difference.empty()) write_exr(difference(picture, reference), o.difference);
  if (!o.z_map.empty()) write_exr(z->z, o.z_map);

  if (comparison.not_finite > 0)
    std::cerr << fmt::format("nacre: warning: {} of {} pixels are not finite and were left out\n",
                             comparison.not_finite, comparison.pixels);
  if (o.json) {
    nlohmann::json json{{"picture", o.picture},
                        {"reference", o.reference},
                        {"width", picture.width},
                        {"height", picture.height},
                        {"not_finite_pixels", comparison.not_finite}};
    for (const auto& [name, value] : comparison.values)
      json["metrics"][name] = number(value);
    if (comparison.flip) json["flip"] = to_json(*comparison.flip, o.options.flip, false);
    if (comparison.hdr_flip) json["hdr_flip"] = to_json(*comparison.hdr_flip, o.options.flip, true);
    if (z) json["z_test"] = to_json(*z, o.spp);
    std::cout << json.dump(2) << "\n";
  } else {
    print(comparison, z);
  }
  if (z && !z->pass) {
    std::cout.flush();
    throw ExitStatus{exit_violated};
  }
}

} // namespace

void add_compare_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("compare", "how far a picture is from its reference");
  auto o = std::make_shared<CompareCommand>();
  command->add_option("PICTURE", o->picture, ".exr, or .png .jpg .bmp, which are linearised")->required();
  command->add_option("REFERENCE", o->reference, "picture of the same size to measure against")->required();
  command->add_option("--metric", o->names, "measures separated by commas, see below")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAME,...");
  command->add_option("--flip-map", o->flip_map, "write FLIP per pixel: .png in colour, .exr as numbers");
  command->add_option("--difference", o->difference, "write picture - reference: .exr");
  command
      ->add_option("--pixels-per-degree", o->options.flip.pixels_per_degree,
                   "density of the display for FLIP")
      ->check(number_in(1, 1000))
      ->capture_default_str();
  CLI::Option* start =
      command->add_option("--start-exposure", o->start_exposure, "hdr-flip: stops; else from the reference")
          ->check(number_in(-100, 100));
  CLI::Option* stop =
      command->add_option("--stop-exposure", o->stop_exposure, "hdr-flip: stops; else from the reference")
          ->check(number_in(-100, 100));
  CLI::Option* exposures =
      command->add_option("--exposures", o->exposures, "hdr-flip: how many; else one a stop")
          ->check(whole_number_in(1, 1000));
  command->add_option("--variance", o->variance,
                      "z-test: variance of one sample per pixel, of the reference");
  command->add_option("--spp", o->spp, "z-test: samples per pixel of the picture")
      ->check(whole_number_in(1, 1 << 30));
  command->add_option("--z-map", o->z_map, "z-test: write z per pixel in X, Y, Z: .exr");
  command->add_flag("--json", o->json, "print one JSON object; null stands for infinity");
  command->footer(compare_footer());
  command->callback([=] {
    o->has_start = start->count() > 0;
    o->has_stop = stop->count() > 0;
    o->has_exposures = exposures->count() > 0;
    run_compare(*o);
  });
}

} // namespace nacre
