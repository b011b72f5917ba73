#include "cli/commands.h"
#include "cli/measured_info.h"
#include "core/error.h"
#include "core/image.h"
#include "measured/formats.h"
#include "measured/material_spec.h"

#include <filesystem>
#include <fmt/format.h>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

struct Range {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo, sum = 0;
  std::size_t count = 0;
  void add(double x) { lo = std::min(lo, x), hi = std::max(hi, x), sum += x, ++count; }
  nlohmann::json json() const {
    if (count == 0) return nullptr;
    return {{"min", lo}, {"max", hi}, {"mean", sum / count}};
  }
};

nlohmann::json describe(const Image& image) {
  nlohmann::json channels = nlohmann::json::array();
  for (int c = 0; c < image.channel_count(); ++c) {
    Range range;
    std::size_t not_finite = 0;
    for (std::size_t p = c; p < image.data.size(); p += image.channel_count())
      if (std::isfinite(image.data[p]))
        range.add(image.data[p]);
      else
        ++not_finite;
    channels.push_back({{"name", image.channels[c]}, {"range", range.json()}, {"not_finite", not_finite}});
  }
  return {{"kind", "image (OpenEXR)"},
          {"width", image.width},
          {"height", image.height},
          {"channels", channels},
          {"metadata", image.metadata}};
}

std::string describe_as_text(const Image& image, const nlohmann::json& json) {
  std::string out =
      fmt::format("  kind        image (OpenEXR)\n  size        {} x {}\n", image.width, image.height);
  for (const auto& c : json["channels"]) {
    const auto& r = c["range"];
    out += fmt::format("  channel     {:<12}", c["name"].get<std::string>());
    if (!r.is_null())
      out += fmt::format(" {:.6g} to {:.6g}, mean {:.6g}", r["min"].get<double>(), r["max"].get<double>(),
                         r["mean"].get<double>());
    if (const auto bad = c["not_finite"].get<std::size_t>(); bad > 0)
      out += fmt::format(", {} not finite", bad);
    out += "\n";
  }
  for (const auto& [key, text] : image.metadata)
    out += fmt::format("  {:<11} {}\n", key, text);
  return out;
}

nlohmann::json describe(const UserModel& model) {
  nlohmann::json parameters = nlohmann::json::array();
  for (std::size_t i = 0; i < model.info().parameters.size(); ++i) {
    const ParameterInfo& p = model.info().parameters[i];
    const auto& v = model.initial_values()[i];
    const char* type = p.per_channel ? "color" : model.is_switch(i) ? "bool" : "float";
    parameters.push_back({{"name", p.name}, {"type", type}, {"lo", p.lo}, {"hi", p.hi}});
    parameters.back()["initial"] = p.per_channel ? nlohmann::json(v) : nlohmann::json(v[0]);
  }
  return {{"kind", "user-written model (.brdf)"}, {"parameters", parameters}};
}

std::string describe_as_text(const UserModel&, const nlohmann::json& json) {
  std::string out = fmt::format("  kind        {}\n", json["kind"].get<std::string>());
  for (const auto& p : json["parameters"])
    out += fmt::format("  {:<11} {} from {} to {}, {}\n", p["type"].get<std::string>(),
                       p["name"].get<std::string>(), p["lo"].dump(), p["hi"].dump(), p["initial"].dump());
  return out;
}

/// Text of a file may be in any encoding; JSON is UTF-8.
std::string dump(const nlohmann::json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

template <class Content>
void report(const std::string& path, const Content& content, bool as_json) {
  nlohmann::json json = describe(content);
  json["file"] = path;
  if (as_json) {
    std::cout << dump(json) << "\n";
  } else {
    std::cout << path << "\n" << describe_as_text(content, json);
  }
}

} // namespace

void add_info_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "info", "describe a measurement (see --formats), an image (.exr) or a model of your own (.brdf)");
  struct Options {
    std::string file;
    bool formats = false, json = false;
  };
  auto o = std::make_shared<Options>();
  CLI::Option* file = command->add_option("FILE", o->file, "a measurement, an .exr image or a .brdf file");
  command->add_flag("--formats", o->formats, "list the formats of measurements that are read and written")
      ->excludes(file);
  command->add_flag("--json", o->json, "one JSON object on standard output");
  command->footer("Examples: nacre info gold.binary --json\n          nacre info --formats");
  command->callback([o] {
    if (o->formats) {
      std::cout << (o->json ? describe_formats().dump(2) + "\n" : describe_formats_as_text());
      return;
    }
    if (o->file.empty()) throw UsageError("info: expected a FILE or --formats; see nacre info --help");
    std::string extension = std::filesystem::path(o->file).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (is_measured_file(o->file)) {
      report(o->file, *read_measured(o->file), o->json);
    } else if (extension == ".brdf") {
      report(o->file, *parse_material(o->file).lobes.front().user, o->json);
    } else if (extension == ".exr") {
      report(o->file, read_exr(o->file), o->json);
    } else {
      std::vector<std::string> known{".exr"};
      for (const MeasuredFormat& f : measured_formats())
        if (f.parse) known.insert(known.end(), f.endings.begin(), f.endings.end());
      throw Error::in_file(o->file, "neither a measurement nor an image by its ending '" + extension + "'" +
                                        suggestion(extension, known) + "; see nacre info --formats");
    }
  });
}

} // namespace nacre
