#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/number_range.h"
#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"
#include "core/version.h"
#include "fit/fit.h"
#include "report/fit_report.h"

#include <filesystem>
#include <fmt/format.h>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

/// "at bound", "not determined: trades off with x", "correlated 0.99 with x".
std::string remark(const FittedParameter& p) {
  std::string text;
  const auto add = [&](const std::string& s) { text += (text.empty() ? "" : "; ") + s; };
  if (p.at_bound) add("at its bound");
  if (!p.identifiable)
    add(p.partner.empty() ? "no effect on these data" : "not determined: trades off with " + p.partner);
  else if (std::abs(p.correlation) > 0.95)
    add(fmt::format("correlated {:+.3f} with {}", p.correlation, p.partner));
  if (!p.tied.empty()) add(p.tied + " is the same");
  return text;
}

std::string to_text(const FitResult& r) {
  std::string text = fmt::format("{:<34} {:>11}    {:<10} {}\n", "parameter", "value", "error", "domain");
  for (const FittedParameter& p : r.parameters)
    text += fmt::format("{:<34} {:>11.6g} +- {:<10} {:<14} {}\n", p.label, p.value,
                        std::isfinite(p.standard_error) ? fmt::format("{:.2g}", p.standard_error) : "-",
                        fmt::format("[{:g}, {:g}]", p.lo, p.hi), remark(p));
  text += fmt::format("error over {} nodes: cosine {:.5g} 1/sr, log {:.5g} (fitted: {})\n", r.errors.nodes,
                      r.errors.cosine, r.errors.log, metric_name(r.metric));
  int same = 0;
  for (const FitStart& s : r.starts)
    same += s.coarse_error <= 1.001 * r.starts[std::size_t(r.best_start)].coarse_error;
  return text + fmt::format("{} of {} starts led here; {} iterations, {:.2f} s; {}{}\n", same,
                            r.starts.size(), r.iterations, r.seconds,
                            r.converged ? "" : "NOT CONVERGED: ", r.message);
}

std::string ranking(const std::vector<FitResult>& results) {
  std::string text = fmt::format("{:<34} {:>11} {:>11} {:>11} {:>8}\n", "model, best first", "parameters",
                                 "cosine", "log", "s");
  for (const FitResult& r : results)
    text += fmt::format("{:<34} {:>11} {:>11.5g} {:>11.5g} {:>8.2f}\n", r.material.name, r.parameters.size(),
                        r.errors.cosine, r.errors.log, r.seconds);
  return text;
}

} // namespace

void add_fit_command(CLI::App& app) {
  struct Options {
    std::string measured, out, report, metric = "log";
    std::vector<std::string> models{"ggx_schlick+lambert"};
    FitOptions fit;
    bool untied = false, json = false;
  };
  CLI::App* command = app.add_subcommand("fit", "parameters of a model from measured reflectance");
  auto o = std::make_shared<Options>();
  command->add_option("MEASURED", o->measured, "measured reflectance, see nacre info --formats")->required();
  command
      ->add_option("--model", o->models,
                   "models joined by +, with values to start from if wanted; several: ranked")
      ->allow_extra_args(false)
      ->type_name("NAME[+NAME...]")
      ->capture_default_str();
  command->add_option("--metric", o->metric, "what is made small: log or cosine")->capture_default_str();
  command->add_option("--starts", o->fit.starts, "starting points")
      ->check(whole_number_in(1, 100000))
      ->capture_default_str();
  command->add_option("--seed", o->fit.seed, "seed of the random starting points")
      ->check(any_whole_number())
      ->capture_default_str();
  command->add_option("--max-theta", o->fit.max_theta_deg, "leave out directions beyond, degrees")
      ->check(number_in(1, 90))
      ->capture_default_str();
  command->add_option("--theta-d-step", o->fit.theta_d_step, "fit to every n-th theta_d; 0: some 30 in all")
      ->check(whole_number_in(0, 4096));
  command->add_option("--phi-d-step", o->fit.phi_d_step, "fit to every n-th phi_d; 0: some 30 in all")
      ->check(whole_number_in(0, 4096));
  command->add_flag("--anisotropic", o->untied, "alpha_x and alpha_y are two parameters");
  command->add_option("-o", o->out, "write the (best) fit as a material: .json")->type_name("FILE");
  command
      ->add_option("--report", o->report, "write a page on the fit: a file .html, or a folder with fit.json")
      ->type_name("FOLDER|FILE.html");
  command->add_flag("--json", o->json, "one JSON object on standard output");
  command->footer(
      "Examples:\n"
      "  nacre fit gold-metallic-paint.binary -o gold.json && nacre validate gold.json\n"
      "  nacre fit alum-bronze.binary --model ggx_conductor+lambert --model ggx_plastic --metric cosine");
  command->callback([o, command] {
    if (!o->out.empty() && !o->out.ends_with(".json"))
      throw UsageError(fmt::format("{}: fit writes .json alone", o->out));
    try {
      o->fit.metric = parse_metric(o->metric);
    } catch (const Error& e) {
      throw UsageError(std::string("--metric: ") + e.what());
    }
    o->fit.isotropic = !o->untied;
    const std::shared_ptr<const MeasuredBsdf> measured = read_measured(o->measured);
    std::vector<FitResult> results;
    for (const std::string& model : o->models) {
      o->fit.model = model;
      results.push_back(fit(*measured, o->fit));
    }
    std::stable_sort(results.begin(), results.end(), [&](const FitResult& a, const FitResult& b) {
      return a.errors.of(o->fit.metric) < b.errors.of(o->fit.metric);
    });
    nlohmann::json best = to_json(results.front());
    best["name"] =
        std::filesystem::path(o->measured).stem().string() + " as " + results.front().material.name;
    best["fit"]["measured"] = o->measured;
    if (!o->out.empty()) write_file_atomically(o->out, best.dump(2) + "\n");
    if (!o->report.empty())
      write_fit_report({std::filesystem::path(o->measured).stem().string(), o->measured,
                        command_line(*command), version(), measured, results},
                       o->report);
    if (o->json) {
      if (results.size() > 1)
        for (const FitResult& r : results)
          best["ranking"].push_back({{"model", r.material.name},
                                     {"parameters", r.parameters.size()},
                                     {"errors", {{"cosine", r.errors.cosine}, {"log", r.errors.log}}},
                                     {"seconds", r.seconds}});
      std::cout << best.dump(2) << "\n";
      return;
    }
    if (results.size() > 1) std::cout << ranking(results) << "\n" << results.front().material.name << "\n";
    std::cout << to_text(results.front());
  });
}

} // namespace nacre
