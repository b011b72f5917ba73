#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/fit_batch.h"
#include "cli/number_range.h"
#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"
#include "core/version.h"
#include "fit/batch.h"
#include "fit/fit.h"
#include "fit/published.h"
#include "report/fit_report.h"

#include <charconv>
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
  std::string text =
      fmt::format("{:<34} {:>11}    {:<10} {}\n", "parameter", "value", "uncertainty", "domain");
  for (const FittedParameter& p : r.parameters) {
    const std::string note = remark(p), domain = fmt::format("[{:g}, {:g}]", p.lo, p.hi);
    text += fmt::format("{:<34} {:>11.6g} +- {:<10} {}\n", p.label, p.value,
                        p.identifiable ? fmt::format("{:.2g}", p.uncertainty()) : "-",
                        note.empty() ? domain : fmt::format("{:<14} {}", domain, note));
  }
  text += fmt::format(
      "uncertainty: all true values lie within at once with {:g} % confidence, if the model is right\n",
      100 * r.confidence);
  text +=
      fmt::format("error over {} nodes: cosine {:.5g} 1/sr, log {:.5g}, cube_root {:.5g}, relative {:.5g} "
                  "(fitted: {}{})\n",
                  r.errors.nodes, r.errors.cosine, r.errors.log, r.errors.cube_root, r.errors.relative,
                  metric_name(r.metric),
                  r.loss.kind == LossKind::squares
                      ? ""
                      : fmt::format(", loss {}:{:.4g}", loss_name(r.loss.kind), r.loss.scale));
  if (r.images.pixels > 0)
    text += fmt::format("lit sphere: image {:.4g}, Delta E {:.4g}\n", r.images.image, r.images.delta_e);
  int same = 0;
  for (const FitStart& s : r.starts)
    same += s.coarse_error <= 1.001 * r.starts[std::size_t(r.best_start)].coarse_error;
  return text + fmt::format("{} of {} starts led here; {} iterations, {:.2f} s; {}{}\n", same,
                            r.starts.size(), r.iterations, r.seconds,
                            r.converged ? "" : "NOT CONVERGED: ", r.message);
}

nlohmann::json errors_json(const FitResult& r) {
  nlohmann::json json;
  for (const Metric m : all_metrics)
    json[std::string(metric_name(m))] = r.errors.of(m);
  return json;
}

std::string ranking(const std::vector<FitResult>& results) {
  const bool images = results.front().images.pixels > 0;
  std::string text = fmt::format("{:<38} {:>10} {:>10} {:>10} {:>10} {:>10}{} {:>7}\n", "model, best first",
                                 "parameters", "cosine", "log", "cube_root", "relative",
                                 images ? fmt::format(" {:>10} {:>10}", "image", "Delta E") : "", "s");
  for (const FitResult& r : results)
    text += fmt::format(
        "{:<38} {:>10} {:>10.5g} {:>10.5g} {:>10.5g} {:>10.5g}{} {:>7.2f}\n", r.material.name,
        r.parameters.size(), r.errors.cosine, r.errors.log, r.errors.cube_root, r.errors.relative,
        images ? fmt::format(" {:>10.4g} {:>10.4g}", r.images.image, r.images.delta_e) : "", r.seconds);
  return text;
}

double number(const std::string& text, const std::string& option) {
  double x = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(x))
    throw UsageError(fmt::format("{}: '{}' is not a number", option, text));
  return x;
}

/// name=lo:hi
ParameterRules::Bound parse_bound(const std::string& text) {
  const auto equals = text.find('='), colon = text.find(':', equals == std::string::npos ? 0 : equals);
  if (equals == std::string::npos || colon == std::string::npos)
    throw UsageError(fmt::format("--bound: expected NAME=LO:HI, found '{}'", text));
  return {text.substr(0, equals), number(text.substr(equals + 1, colon - equals - 1), "--bound"),
          number(text.substr(colon + 1), "--bound")};
}

/// name or name=value
ParameterRules::Fixed parse_fixed(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos) return {text, {}};
  return {text.substr(0, equals), number(text.substr(equals + 1), "--fix")};
}

/// kind or kind:scale
RobustLoss parse_robust_loss(const std::string& text) {
  const auto colon = text.find(':');
  RobustLoss loss{parse_loss(text.substr(0, colon)), 0};
  if (colon != std::string::npos) {
    loss.scale = number(text.substr(colon + 1), "--loss");
    if (!(loss.scale > 0)) throw UsageError("--loss: the scale of a loss is positive");
  }
  return loss;
}

struct Options {
  std::vector<std::string> measured, published, bounds, fixed;
  std::string out, report, command, database, study, metric = "log", loss = "squares";
  std::vector<std::string> models;
  FitOptions fit;
  bool untied = false, json = false, channels = false, retry = false, quiet = false, quick = false,
       thorough = false;

  /// Many fits, kept in a database.
  bool is_batch() const {
    return published.empty() &&
           (!database.empty() || !study.empty() || measured.size() > 1 ||
            (std::filesystem::is_directory(measured.front()) && !is_measured_file(measured.front())));
  }
};

/// What published parameters reach and what a fit reaches: a row a material, a column a set, as Markdown.
std::string published_page(const std::vector<PublishedSet>& sets,
                           const std::vector<PublishedComparison>& comparisons, const std::string& summary) {
  std::string page = "# Published fits and Nacre's\n\n"
                     "Made by `nacre fit TABLES --published FITS -o PAGE`. In each cell: the error of the "
                     "published parameters,\n"
                     "evaluated by Nacre, and that of Nacre's fit of the same model to the same table, in "
                     "the metric of the\n"
                     "paper ([fit.md](fit.md)).\n\n" +
                     summary + "\n| set | metric | source |\n|---|---|---|\n";
  const auto find = [&](const std::string& set, const std::string& material) {
    return std::find_if(comparisons.begin(), comparisons.end(), [&](const PublishedComparison& c) {
      return c.set == set && (material.empty() || c.material == material);
    });
  };
  std::string head = "\n| material |", line = "|---|";
  for (const PublishedSet& set : sets)
    if (const auto any = find(set.name, ""); any != comparisons.end()) {
      page += fmt::format("| `{}` | {} | {} |\n", set.name, metric_name(any->metric), set.source);
      head += " " + set.name + " |";
      line += "---|";
    }
  page += head + "\n" + line + "\n";
  std::vector<std::string> done;
  for (const PublishedComparison& row : comparisons) {
    if (std::find(done.begin(), done.end(), row.material) != done.end()) continue;
    done.push_back(row.material);
    page += "| " + row.material + " |";
    for (const PublishedSet& set : sets) {
      if (find(set.name, "") == comparisons.end()) continue;
      const auto c = find(set.name, row.material);
      page += c == comparisons.end() ? " – |" : fmt::format(" {:.3g} → {:.3g} |", c->published, c->fitted);
    }
    page += "\n";
  }
  return page;
}

/// The same, one line a comparison.
void compare_all(const Options& o) {
  std::vector<PublishedSet> sets;
  for (const std::string& path : o.published)
    sets.push_back(read_published(path));
  std::string table = "| material | fits | model | metric | published | fitted | fitted / published "
                      "|\n|---|---|---|---|---|---|---|\n";
  nlohmann::json json = nlohmann::json::array();
  std::vector<PublishedComparison> comparisons;
  int worse = 0;
  for (const std::string& path : measured_files(o.measured)) {
    const std::shared_ptr<const MeasuredBsdf> measured = read_measured(path);
    const FitData data(*measured);
    const std::string material = std::filesystem::path(path).stem().string();
    for (const PublishedSet& set : sets) {
      const PublishedFit* published = set.find(material);
      if (!published) {
        std::cerr << fmt::format("nacre: {} has no fit of {}\n", set.name, material);
        continue;
      }
      const PublishedComparison c = compare_with_published(data, set, *published, o.fit);
      table += fmt::format("| {} | {} | {} | {} | {:.5g} | {:.5g} | {:.4f} |\n", c.material, c.set, c.model,
                           metric_name(c.metric), c.published, c.fitted, c.fitted / c.published);
      json.push_back({{"material", c.material},
                      {"set", c.set},
                      {"model", c.model},
                      {"metric", metric_name(c.metric)},
                      {"published", c.published},
                      {"fitted", c.fitted},
                      {"fit", to_json(c.fit)}});
      worse += c.fitted > c.published;
      comparisons.push_back(c);
    }
  }
  if (comparisons.empty())
    throw Error("none of the published fits is of a material that was given: the name of the file, "
                "without its ending, is that of the material");
  const std::string summary = fmt::format(
      "{} comparisons; the fit is worse than the published parameters in {}.\n", comparisons.size(), worse);
  table += "\n" + summary;
  if (!o.out.empty())
    write_file_atomically(o.out, o.out.ends_with(".json") ? json.dump(2) + "\n"
                                                          : published_page(sets, comparisons, summary));
  std::cout << (o.json ? json.dump(2) + "\n" : table);
}

void fit_models(const Options& o) {
  const std::shared_ptr<const MeasuredBsdf> measured = read_measured(o.measured.front());
  const FitData data(*measured);
  std::vector<FitOptions> wanted;
  const std::vector<std::string> models = o.models.empty() ? std::vector{o.fit.model} : o.models;
  for (const std::string& model : models)
    for (const std::string& one : model == "all" ? fittable_materials() : std::vector{model})
      for (int channel = o.channels ? 0 : -1; channel < (o.channels ? 3 : 0); ++channel) {
        wanted.push_back(o.quick || (model == "all" && !o.thorough) ? ranking_options(one, o.fit) : o.fit);
        wanted.back().model = one;
        wanted.back().channel = channel;
      }
  std::vector<FitResult> results(wanted.size());
  {
    Progress progress("fits", wanted.size(), o.json || wanted.size() < 4);
    parallel_for(wanted.size(), [&](std::size_t i) {
      results[i] = fit(data, wanted[i]);
      progress.advance();
    });
  }
  for (FitResult& r : results)
    if (r.channel >= 0)
      r.material.name += fmt::format(" ({})", std::array{"red", "green", "blue"}[std::size_t(r.channel)]);
  if (!o.channels)
    std::stable_sort(results.begin(), results.end(), [&](const FitResult& a, const FitResult& b) {
      return a.errors.of(o.fit.metric) < b.errors.of(o.fit.metric);
    });
  nlohmann::json best = to_json(results.front());
  best["name"] =
      std::filesystem::path(o.measured.front()).stem().string() + " as " + results.front().material.name;
  best["fit"]["measured"] = o.measured.front();
  if (!o.out.empty()) write_file_atomically(o.out, best.dump(2) + "\n");
  if (!o.report.empty())
    write_fit_report({std::filesystem::path(o.measured.front()).stem().string(), o.measured.front(),
                      o.command, version(), measured, results},
                     o.report);
  if (o.json) {
    if (results.size() > 1)
      for (const FitResult& r : results)
        best["ranking"].push_back({{"model", r.material.name},
                                   {"parameters", r.parameters.size()},
                                   {"errors", errors_json(r)},
                                   {"seconds", r.seconds}});
    if (o.channels)
      for (const FitResult& r : results)
        best["channels"].push_back(to_json(r));
    std::cout << best.dump(2) << "\n";
    return;
  }
  if (o.channels) {
    for (const FitResult& r : results)
      std::cout << r.material.name << "\n" << to_text(r) << "\n";
    return;
  }
  if (results.size() > 1) std::cout << ranking(results) << "\n" << results.front().material.name << "\n";
  std::cout << to_text(results.front());
}

} // namespace

void add_fit_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("fit", "parameters of a model from measured reflectance");
  auto o = std::make_shared<Options>();
  command
      ->add_option("MEASURED", o->measured,
                   "measured reflectance, see nacre info --formats; several files or folders: a batch")
      ->required();
  command
      ->add_option(
          "--model", o->models,
          "models joined by +, with values to start from if wanted; several: ranked; all: every model "
          "(default: ggx_schlick+lambert, of a batch those of a study)")
      ->allow_extra_args(false)
      ->type_name("NAME[+NAME...]");
  command
      ->add_option("--metric", o->metric,
                   "what is made small: log, cosine, cube_root or relative (docs/fit.md)")
      ->capture_default_str();
  command
      ->add_option(
          "--loss", o->loss,
          "squares, or huber, soft_l1, cauchy: outliers count less; with the residual where that begins")
      ->type_name("KIND[:SCALE]")
      ->capture_default_str();
  command->add_option("--bound", o->bounds, "narrower bounds of a parameter")
      ->allow_extra_args(false)
      ->type_name("NAME=LO:HI");
  command
      ->add_option("--fix", o->fixed, "a parameter that is not fitted, at a value or as the model gives it")
      ->allow_extra_args(false)
      ->type_name("NAME[=VALUE]");
  command->add_option("--free", o->fit.rules.freed, "fit a parameter that is not fitted otherwise")
      ->allow_extra_args(false)
      ->type_name("NAME");
  command->add_option("--shared", o->fit.rules.shared, "one number for all channels")
      ->allow_extra_args(false)
      ->type_name("NAME");
  command->add_flag("--each-channel", o->channels,
                    "fit red, green and blue apart, every parameter for itself");
  command->add_option("--starts", o->fit.starts, "starting points")
      ->check(whole_number_in(1, 100000))
      ->capture_default_str();
  command->add_option("--screened", o->fit.screened, "points of the domain to choose them from")
      ->check(whole_number_in(1, 10000000))
      ->capture_default_str();
  command->add_option("--seed", o->fit.seed, "seed of these points")
      ->check(any_whole_number())
      ->capture_default_str();
  command->add_option("--confidence", o->fit.confidence, "of the stated uncertainties")
      ->check(number_in(0.01, 0.999999))
      ->capture_default_str();
  command->add_option("--max-theta", o->fit.max_theta_deg, "leave out directions beyond, degrees")
      ->check(number_in(1, 90))
      ->capture_default_str();
  command->add_option("--theta-d-step", o->fit.theta_d_step, "fit to every n-th theta_d; 0: some 30 in all")
      ->check(whole_number_in(0, 4096));
  command->add_option("--phi-d-step", o->fit.phi_d_step, "fit to every n-th phi_d; 0: some 30 in all")
      ->check(whole_number_in(0, 4096));
  command->add_flag("--anisotropic", o->untied, "alpha_x and alpha_y are two parameters");
  command->add_flag(
      "--quick", o->quick,
      "fewer nodes, as for all models and in a batch: errors to some two digits, for a ranking");
  command->add_flag("--thorough", o->thorough, "every node also for all models and in a batch");
  command->add_flag("--images", o->fit.images, "compare lit spheres too");
  command->add_option("--environment", o->fit.environment, "the same in the light of this picture")
      ->type_name("FILE");
  command
      ->add_option("--published", o->published,
                   "published fits (JSON): their error and that of a fit of the same model, as a table")
      ->allow_extra_args(false)
      ->type_name("FILE");
  command
      ->add_option("-o", o->out,
                   "write the (best) fit as a material: .json; of --published the table: .md, .json")
      ->type_name("FILE");
  command
      ->add_option("--report", o->report, "write a page on the fit: a file .html, or a folder with fit.json")
      ->type_name("FOLDER|FILE.html");
  command
      ->add_option("--database", o->database,
                   "of a batch: SQLite file that keeps each fit; what is there is not fitted again")
      ->type_name("FILE");
  command->add_option("--study", o->study, "of a batch: write tables and figures that rank the models")
      ->type_name("FOLDER");
  command->add_flag("--retry", o->retry, "of a batch: try again what failed before");
  command->add_flag("--quiet", o->quiet, "no progress");
  command->add_flag("--json", o->json, "one JSON object on standard output");
  command->footer(
      "Examples:\n"
      "  nacre fit gold-metallic-paint.binary -o gold.json && nacre validate gold.json\n"
      "  nacre fit alum-bronze.binary --model ggx_conductor+lambert --model ggx_plastic --metric cosine\n"
      "  nacre fit alum-bronze.binary --model all\n"
      "  nacre fit merl/ --study study        # all files of a folder, the models of a study; goes on after "
      "a kill\n"
      "  nacre fit *.binary --published ngan_ward.json --published bagher_sgd.json -o table.md");
  command->callback([o, command] {
    const bool table = !o->published.empty();
    if (!o->out.empty() && !o->out.ends_with(".json") && !(table && o->out.ends_with(".md")))
      throw UsageError(fmt::format("{}: fit writes .json alone{}", o->out, table ? ", or .md" : ""));
    if (o->is_batch() && (!o->out.empty() || !o->report.empty() || o->channels))
      throw UsageError(
          "-o, --report and --each-channel are for one measurement; a batch has --study and --database");
    if (o->channels && !o->out.empty())
      throw UsageError("-o holds one material, and --each-channel makes three: red, green and blue. For one "
                       "material whose parameters differ between channels, leave --each-channel out; --json "
                       "prints all three");
    if (o->quick && o->thorough) throw UsageError("--quick or --thorough, not both");
    o->command = command_line(*command);
    try {
      o->fit.metric = parse_metric(o->metric);
    } catch (const Error& e) {
      throw UsageError(std::string("--metric: ") + e.what());
    }
    try {
      o->fit.loss = parse_robust_loss(o->loss);
    } catch (const UsageError&) {
      throw;
    } catch (const Error& e) {
      throw UsageError(std::string("--loss: ") + e.what());
    }
    for (const std::string& text : o->bounds)
      o->fit.rules.bounds.push_back(parse_bound(text));
    for (const std::string& text : o->fixed)
      o->fit.rules.fixed.push_back(parse_fixed(text));
    o->fit.isotropic = !o->untied;
    if (table)
      compare_all(*o);
    else if (o->is_batch())
      run_fit_batch({o->measured, o->models, o->fit, o->database, o->study, o->command, o->retry, o->thorough,
                     o->quiet, o->json});
    else
      fit_models(*o);
  });
}

} // namespace nacre
