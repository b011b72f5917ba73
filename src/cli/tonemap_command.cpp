#include "cli/commands.h"
#include "cli/number_range.h"
#include "core/error.h"
#include "core/jpeg.h"
#include "display/tonemap.h"

#include <charconv>
#include <fmt/format.h>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

/// Operators with their parameters, and examples.
std::string tonemap_footer() {
  std::string text = "Operators:\n";
  for (const ToneOperator& op : tone_operators()) {
    text += fmt::format("  {:<15} {} ({})\n", op.name, op.meaning, op.source);
    for (const ToneParameter& p : op.parameters)
      text += fmt::format("      {:<11} {}; in [{:g}, {:g}], default {:g}\n", p.name, p.meaning, p.min, p.max,
                          p.value);
  }
  return text +
         "\nNaN and negative values show as black, infinity as the brightest finite value; each is counted "
         "in a warning.\n"
         "\nExamples:\n"
         "  nacre tonemap desk.exr desk.png\n"
         "  nacre tonemap desk.exr desk.png --operator narkowicz --exposure 1.5\n"
         "  nacre tonemap desk.exr desk.png --operator reinhard -p key=0.36 -p white=4";
}

void add_parameter(ToneMapOptions& options, const std::string& text) {
  const auto equals = text.find('=');
  double value = 0;
  const char* end = text.data() + text.size();
  if (equals == std::string::npos || equals == 0)
    throw UsageError(fmt::format("--param: expected NAME=VALUE, found '{}'", text));
  const auto [stopped, error] = std::from_chars(text.data() + equals + 1, end, value);
  if (error != std::errc() || stopped != end)
    throw UsageError(fmt::format("--param: expected a number after '{}', found '{}'",
                                 text.substr(0, equals + 1), text.substr(equals + 1)));
  if (!options.parameters.emplace(text.substr(0, equals), value).second)
    throw UsageError(fmt::format("--param: {} is given twice", text.substr(0, equals)));
}

void warn(const std::string& file, std::size_t pixels, const char* what) {
  if (pixels > 0)
    std::cerr << fmt::format("nacre: warning: {}: {} {} {}\n", file, pixels, pixels == 1 ? "pixel" : "pixels",
                             what);
}

} // namespace

void add_tonemap_command(CLI::App& app) {
  struct Options {
    std::string in, out;
    ToneMapOptions tone;
    std::vector<std::string> parameters;
    bool json = false;
  };
  CLI::App* command = app.add_subcommand("tonemap", "linear picture to a PNG or JPEG for an sRGB display");
  auto o = std::make_shared<Options>();
  command->add_option("IN", o->in, "linear picture: .exr (or .png .jpg .bmp, which are linearised)")
      ->required();
  command->add_option("OUT", o->out, "picture to write: .png, or .jpg for the eye alone")->required();
  command->add_option("--operator", o->tone.operator_name, "tone operator, see below")->capture_default_str();
  command->add_option("--exposure", o->tone.exposure_stops, "multiply the picture by 2^STOPS")
      ->type_name("STOPS")
      ->check(number_in(-100, 100));
  command->add_option("-p,--param", o->parameters, "parameter of the operator; may be repeated")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  command->add_flag("--json", o->json, "print what was done as one JSON object");
  command->footer(tonemap_footer());
  command->callback([o] {
    const bool jpeg = o->out.ends_with(".jpg") || o->out.ends_with(".jpeg");
    if (!jpeg && !o->out.ends_with(".png"))
      throw UsageError(fmt::format("{}: tonemap writes .png and .jpg", o->out));
    ToneMapOptions options = o->tone;
    for (const std::string& text : o->parameters)
      add_parameter(options, text);
    try {
      check(options);
    } catch (const Error& e) {
      throw UsageError(e.what());
    }
    ToneMapReport report;
    const Image picture = tone_map(read_image_linear(o->in), options, &report);
    jpeg ? write_jpeg(picture, o->out) : write_png(picture, o->out);
    if (o->json) {
      std::cout << nlohmann::json{{"in", o->in},
                                  {"out", o->out},
                                  {"operator", options.operator_name},
                                  {"exposure_stops", options.exposure_stops},
                                  {"pixels",
                                   {{"not_a_number", report.not_a_number},
                                    {"infinite", report.infinite},
                                    {"negative", report.negative},
                                    {"clipped", report.clipped}}}}
                       .dump(2)
                << "\n";
      return;
    }
    warn(o->in, report.not_a_number, "not a number, shown as 0");
    warn(o->in, report.infinite, "infinite, shown as the largest finite value");
    warn(o->in, report.negative, "with a negative value, shown as 0");
  });
}

} // namespace nacre
