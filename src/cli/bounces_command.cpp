#include "cli/commands.h"
#include "validate/bounce_report.h"

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

namespace nacre {

void add_bounces_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "bounces", "compare the ways to keep the light of multiple surface bounces with the random walk");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "one JSON object on standard output");
  command->footer("GGX conductors and dielectrics at several roughnesses and angles; some ten seconds. "
                  "docs/models/multiple-bounces.md explains the columns.\nExample: nacre bounces --json");
  command->callback([json] {
    const BounceReport report = compare_bounces();
    if (*json)
      std::cout << to_json(report).dump(2) << "\n";
    else
      std::cout << to_text(report);
  });
}

} // namespace nacre
