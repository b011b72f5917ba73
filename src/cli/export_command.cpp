#include "cli/commands.h"
#include "cli/number_range.h"
#include "core/error.h"
#include "fit/export_material.h"

#include <filesystem>
#include <fmt/format.h>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

nlohmann::json to_json(const Translation& t, const std::string& file) {
  return {{"file", file},
          {"format", t.format},
          {"exact", t.is_exact()},
          {"fitted", t.fitted},
          {"error",
           {{"log", t.error.log},
            {"cosine", t.error.cosine},
            {"largest_relative", t.error.relative},
            {"at", t.error.where}}},
          {"remarks", t.remarks},
          {"target", to_json(t.target)}};
}

} // namespace

void add_export_command(CLI::App& app) {
  struct Options {
    std::string material, out;
    ExportOptions options;
    bool json = false;
  };
  CLI::App* command = app.add_subcommand("export", "a material in the words of other programs");
  auto o = std::make_shared<Options>();
  command
      ->add_option("MATERIAL", o->material,
                   "NAME:PARAM=VALUE,...[+NAME:...], the .json of a fit, or a "
                   "measurement")
      ->required();
  command->add_option("-o,--output", o->out, "file to write; its ending says the format")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--as", o->options.model,
                   "which of the format's models to use (default: the one of the least error)")
      ->type_name("NAME[+NAME...]");
  command->add_option("--seed", o->options.seed, "seed of the starting points of a fit")
      ->check(any_whole_number());
  command->add_flag("--json", o->json, "one JSON object on standard output");
  command->footer(""); // the one that it was given by the program
  // Made when it is asked for: which models there are is of no interest to other commands.
  command->footer([] {
    std::string formats =
        "Formats, and the models that are fitted where a format lacks the material's own:\n";
    for (const ExportFormat& f : export_formats()) {
      std::string models;
      for (const std::string& model : f.models)
        models += (models.empty() ? "" : ", ") + model;
      formats += fmt::format("  {:<6} {:<21} {}\n", f.ending, f.name, f.ending == ".json" ? "" : models);
    }
    return formats +
           "\nExamples:\n"
           "  nacre export gold.json -o gold.xml\n"
           "  nacre export ggx_conductor:metal=Au,alpha_x=0.2,alpha_y=0.2 -o gold.mtlx --as openpbr";
  });
  command->callback([o] {
    const std::string ending = std::filesystem::path(o->out).extension().string();
    std::vector<std::string> known;
    for (const ExportFormat& f : export_formats())
      known.push_back(f.ending);
    if (std::find(known.begin(), known.end(), ending) == known.end())
      throw UsageError(
          fmt::format("{}: no material is written as '{}'{}", o->out, ending, suggestion(ending, known)));
    const Translation t = export_material(parse_material(o->material), o->out, o->options);
    if (o->json)
      std::cout << to_json(t, o->out).dump(2) << "\n";
    else
      std::cout << o->out << "\n" << to_text(t);
  });
}

} // namespace nacre
