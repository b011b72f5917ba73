#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/number_range.h"
#include "core/error.h"
#include "core/parallel.h"
#include "measured/published_fits.h"
#include "report/demo.h"

#include <fmt/format.h>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

void print_json(const DemoResult& result) {
  nlohmann::json steps = nlohmann::json::array();
  for (const DemoStep& s : result.steps)
    steps.push_back({{"name", s.name}, {"result", s.what}, {"seconds", s.seconds}});
  std::cout << nlohmann::json{{"material", result.measured.name},
                              {"report", result.report},
                              {"picture", result.picture},
                              {"fit", to_json(result.fit)},
                              {"validation",
                               {{"measured", to_json(result.measured_validation)},
                                {"fit", to_json(result.fit_validation)}}},
                              {"image_error",
                               {{"rmse", result.rmse}, {"flip", result.flip}, {"hdr_flip", result.hdr_flip}}},
                              {"steps", steps},
                              {"seconds", result.seconds}}
                   .dump(2)
            << "\n";
}

} // namespace

void add_demo_command(CLI::App& app) {
  struct Options {
    DemoOptions demo;
    std::string metric = "log";
    bool quiet = false, json = false;
  };
  CLI::App* command =
      app.add_subcommand("demo", "measured reflectance to a fit, its validation, two renders and one report");
  auto o = std::make_shared<Options>();
  CLI::Option* file = command->add_option("FILE", o->demo.file, "measured material, MERL .binary");
  command->add_option("-o,--output", o->demo.folder, "folder to write to")->capture_default_str();
  command->add_option("--material", o->demo.published, "published material, if no FILE is given")
      ->capture_default_str()
      ->excludes(file);
  command->add_option("--model", o->demo.fit.model, "what to fit: one to three models joined by +")
      ->capture_default_str();
  command->add_option("--metric", o->metric, "what to minimise: log, cosine")->capture_default_str();
  command->add_option("--environment", o->demo.environment,
                      "latitude-longitude map to light the renders, .exr, instead of sun and sky");
  command->add_option("--spp", o->demo.samples_per_pixel, "paths a pixel of each render")
      ->capture_default_str()
      ->check(whole_number_in(1, 1 << 20));
  command->add_option("--width", o->demo.width, "pixels across each render, which is 4 by 3")
      ->capture_default_str()
      ->check(whole_number_in(16, 8192));
  command->add_option("--seed", o->demo.seed, "of all chance; the same seed gives the same report")
      ->check(any_whole_number());
  command->add_flag("--quiet", o->quiet, "say only where the results are");
  command->add_flag("--json", o->json, "one JSON object on standard output");
  command->footer("Examples:\n"
                  "  nacre demo\n"
                  "  nacre demo --material blue-metallic-paint -o blue\n"
                  "  nacre demo measured.binary --model ggx_conductor+lambert\n"
                  "Published materials: nacre demo --material help");
  command->callback([o, command] {
    if (o->demo.published == "help") {
      for (const std::string& name : published_materials())
        std::cout << name << "\n";
      return;
    }
    o->demo.command = command_line(*command);
    try {
      o->demo.fit.metric = parse_metric(o->metric);
    } catch (const Error& e) {
      throw UsageError(std::string("--metric: ") + e.what());
    }
    o->demo.height = o->demo.width * 3 / 4;
    o->demo.quiet = o->quiet || o->json;
    if (!o->demo.quiet)
      o->demo.on_step = [](const DemoStep& s) {
        std::cerr << fmt::format("{:<22}{:6.2f} s  {}\n", s.name, s.seconds, s.what);
      };
    catch_ctrl_c();
    const DemoResult result = run_demo(o->demo);
    if (o->json)
      print_json(result);
    else
      std::cout << fmt::format("report:  {}\npicture: {}  (measured | fit | difference)\n", result.report,
                               result.picture);
  });
}

} // namespace nacre
