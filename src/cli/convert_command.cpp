#include "cli/commands.h"
#include "cli/number_range.h"
#include "core/error.h"
#include "core/file.h"
#include "core/image.h"
#include "display/tonemap.h"
#include "measured/conversion.h"
#include "measured/hole_filling.h"
#include "measured/material_as_measurement.h"
#include "report/material_images.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

struct Arguments {
  std::string in, out, to;
  bool fill = false, json = false;
  int size = 256;
};

constexpr const char* slice = "slice";

bool writes_slice(const Arguments& a) {
  if (!a.to.empty()) return a.to == slice;
  return a.out.ends_with(".exr") || a.out.ends_with(".png");
}

/// The table of a measurement, filled; the counts go into `json`.
std::shared_ptr<const MeasuredBsdf> filled(const std::shared_ptr<const MeasuredBsdf>& measured,
                                           nlohmann::json& json) {
  if (!measured->is_isotropic() || measured->sides().reflects_back || measured->sides().transmits())
    throw Error("--fill: fills the holes of isotropic reflection from the front, and this is more: " +
                measured->kind());
  const auto* table = dynamic_cast<const MerlTable*>(measured.get());
  FilledTable result = table ? fill_holes(*table) : fill_holes(tabulate_merl(*measured));
  json["filled"] = {{"resampled", table == nullptr},
                    {"by_reciprocity", result.by_reciprocity},
                    {"by_mirror_image", result.by_mirror_image},
                    {"by_extrapolation", result.by_extrapolation}};
  return std::make_shared<const MerlTable>(std::move(result.table));
}

void write_slice(const std::shared_ptr<const MeasuredBsdf>& measured, const Arguments& a,
                 nlohmann::json& json) {
  if (!measured->sides().reflects_front)
    throw Error("a slice shows reflection on the front, and this measurement has none: " + measured->kind());
  LobeSpec lobe;
  lobe.measured = measured;
  Image image = image_slice({a.in, {lobe}}, a.size);
  image.metadata["nacre.slice"] = "f in 1/sr at phi_d = 90 degrees; x: sqrt(theta_h / 90 degrees) from 0 to "
                                  "1, y: theta_d from 90 (top) to 0";
  if (a.out.ends_with(".exr")) {
    write_exr(image, a.out);
  } else {
    ToneMapOptions options;
    options.operator_name = "clip";
    write_png(tone_map(image, options), a.out);
  }
  json["format"] = slice;
  json["lost"] = {"all but phi_d = 90 degrees"};
}

void write_measurement(const MeasuredBsdf& measured, const Arguments& a, nlohmann::json& json) {
  const MeasuredFormat& format = format_to_write(a.out, a.to);
  const std::vector<std::uint8_t> bytes = format.encode(measured);
  json["format"] = format.name;
  json["description"] = format.description;
  json["bytes"] = bytes.size();
  if (format.parse) {
    // What is written is what will be read: the comparison is with the bytes.
    const auto back = format.parse(bytes, a.out);
    const ConversionLoss loss = conversion_loss(measured, *back);
    json["lost"] = loss.changes;
    json["difference"] = {{"pairs", loss.pairs},
                          {"holes_now", loss.lost},
                          {"values_where_holes_were", loss.gained},
                          {"mean", loss.mean},
                          {"worst", loss.worst}};
    if (loss.worst > 0)
      json["difference"]["worst_at"] = {{"wo", {loss.wo.x, loss.wo.y, loss.wo.z}},
                                        {"wi", {loss.wi.x, loss.wi.y, loss.wi.z}}};
    const auto* table = dynamic_cast<const MerlTable*>(back.get());
    const auto* in = dynamic_cast<const MerlTable*>(&measured);
    if (in && in->filled_count() > 0 && !(table && table->filled_count() > 0))
      json["lost"].push_back("marks of filled entries: the format has no place for them");
  }
  write_file_atomically(a.out, bytes);
}

std::string angles(const nlohmann::json& w) {
  const double z = std::clamp(w[2].get<double>(), -1.0, 1.0);
  return fmt::format("theta {:.1f} phi {:.1f}", std::acos(z) * 180 / pi,
                     std::atan2(w[1].get<double>(), w[0].get<double>()) * 180 / pi);
}

std::string to_text(const nlohmann::json& json) {
  std::string text = fmt::format("{}\n  from        {}, {}\n  format      {}",
                                 json["output"].get<std::string>(), json["input"].get<std::string>(),
                                 json["kind"].get<std::string>(), json["format"].get<std::string>());
  if (json.contains("description")) text += fmt::format(", {}", json["description"].get<std::string>());
  text += "\n";
  if (json.contains("filled")) {
    const auto& f = json["filled"];
    text += fmt::format("  filled      {} holes by reciprocity, {} by mirror image, {} by extrapolation\n",
                        f["by_reciprocity"].get<std::size_t>(), f["by_mirror_image"].get<std::size_t>(),
                        f["by_extrapolation"].get<std::size_t>());
    if (f["resampled"].get<bool>()) text += "              on the grid of a MERL table\n";
  }
  for (const auto& change : json.value("lost", nlohmann::json::array()))
    text += fmt::format("  lost        {}\n", change.get<std::string>());
  if (json.contains("difference")) {
    const auto& d = json["difference"];
    const double mean = d["mean"].get<double>(), worst = d["worst"].get<double>();
    if (worst == 0)
      text +=
          fmt::format("  difference  none at {} random pairs of directions\n", d["pairs"].get<std::size_t>());
    else
      text += fmt::format(
          "  difference  resampled: {:.3g} of the mean of both on average, {:.3g} at worst (o {}, i "
          "{}), at {} random pairs of directions\n",
          mean, worst, angles(d["worst_at"]["wo"]), angles(d["worst_at"]["wi"]),
          d["pairs"].get<std::size_t>());
    if (const auto n = d["holes_now"].get<std::size_t>(); n > 0)
      text += fmt::format("  difference  at {} pairs that had a value there is a hole\n", n);
    if (const auto n = d["values_where_holes_were"].get<std::size_t>(); n > 0)
      text += fmt::format("  difference  at {} pairs that were a hole there is a value\n", n);
  }
  return text;
}

} // namespace

void add_convert_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("convert", "write a measurement or a material in another format of measurements");
  auto a = std::make_shared<Arguments>();
  command
      ->add_option("IN", a->in, "a measurement, a .json that a fit wrote, or NAME:PARAM=VALUE,...[+NAME:...]")
      ->required();
  command
      ->add_option(
          "OUT", a->out,
          "file to write; its ending says the format (nacre info --formats); .exr or .png: the slice "
          "of Burley 2012, theta_h by theta_d at phi_d = 90 degrees")
      ->required();
  command->add_option("--to", a->to, "name of the format, whatever the ending");
  command->add_flag(
      "--fill", a->fill,
      "fill the holes above the horizon: by reciprocity, mirror image, then smooth extrapolation");
  command->add_option("--size", a->size, "pixels of a slice's side")
      ->check(whole_number_in(8, 8192))
      ->capture_default_str();
  command->add_flag("--json", a->json, "one JSON object on standard output");
  command->footer(
      "Says what was lost: changes of channels and sides, and the difference between IN and what was "
      "written.\n\n"
      "Examples: nacre convert gold.binary gold.csv\n"
      "          nacre convert ggx_conductor:metal=Au,alpha=0.2 gold.binary\n"
      "          nacre convert paint.binary filled.binary --fill");
  command->callback([a] {
    // Before long work.
    if (!writes_slice(*a))
      format_to_write(a->out, a->to);
    else if (!a->out.ends_with(".exr") && !a->out.ends_with(".png"))
      throw UsageError(a->out + ": a slice is an image, .exr or .png");
    auto measured = as_measurement(parse_material(a->in));
    nlohmann::json json{{"input", a->in}, {"output", a->out}, {"kind", measured->kind()}};
    if (a->fill) measured = filled(measured, json);
    if (writes_slice(*a))
      write_slice(measured, *a, json);
    else
      write_measurement(*measured, *a, json);
    if (a->json)
      std::cout << json.dump(2) << "\n";
    else
      std::cout << to_text(json);
  });
}

} // namespace nacre
