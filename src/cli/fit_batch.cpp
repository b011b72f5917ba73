#include "cli/fit_batch.h"

#include "cli/exit_status.h"
#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"
#include "fit/batch.h"
#include "report/output_folder.h"
#include "report/study_report.h"

#include <filesystem>
#include <fmt/format.h>
#include <iostream>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

/// Tables and figures of the study.
void write_study(const Study& study, const FitBatch& batch) {
  OutputFolder folder(batch.study);
  const auto add = [&](const std::string& name, const std::string& text) {
    folder.add(name, [&](const std::string& file) { write_file_atomically(file, text); });
  };
  add("study.md", markdown(study));
  add("study.html", study_page(study, batch.command));
  add("errors.csv", csv(study));
  add("sorted-materials.svg", svg_file(sorted_materials_plot(study, 0)));
  add("cumulative.svg", svg_file(cumulative_plot(study)));
  add("behind-the-best.svg", svg_file(performance_plot(study)));
  folder.keep();
}

nlohmann::json to_json(const Study& study, const BatchResult& batch) {
  nlohmann::json json{{"metric", study.metric},
                      {"done", batch.done},
                      {"skipped", batch.skipped},
                      {"failed", batch.failed},
                      {"models", nlohmann::json::array()}};
  const auto number = [](double x) { return std::isfinite(x) ? nlohmann::json(x) : nlohmann::json(); };
  for (std::size_t m = 0; m < study.models.size(); ++m) {
    const Study::Standing& s = study.standings[m];
    json["models"].push_back({{"model", study.models[m]},
                              {"median_error", number(s.median)},
                              {"median_over_best", number(s.median_over_best)},
                              {"wins", s.wins},
                              {"fits", s.fits},
                              {"mean_rank", number(s.mean_rank)},
                              {"median_seconds", number(s.median_seconds)}});
    for (std::size_t i = 0; i < study.materials.size(); ++i)
      json["errors"][study.materials[i]][study.models[m]] = number(study.error[i][m]);
  }
  return json;
}

} // namespace

std::vector<std::string> study_models() {
  return {"lambert",
          "ward+lambert",
          "ward_duer+lambert",
          "blinn_phong+lambert",
          "lafortune+lambert",
          "cook_torrance+lambert",
          "ashikhmin_shirley+lambert",
          "he+lambert",
          "ggx_schlick+lambert",
          "gtr_conductor+lambert",
          "student_t_conductor+lambert",
          "low_microfacet+lambert",
          "low_smooth+lambert",
          "sgd+lambert",
          "two_scale+lambert",
          "disney_2012",
          "ggx_schlick+ggx_schlick+lambert"};
}

void run_fit_batch(const FitBatch& b) {
  std::vector<std::string> models;
  for (const std::string& model : b.models.empty() ? study_models() : b.models) {
    const std::vector<std::string> named = model == "all" ? fittable_materials() : std::vector{model};
    for (const std::string& one : named)
      if (std::find(models.begin(), models.end(), one) == models.end()) models.push_back(one);
  }
  for (const std::string& model : models)
    for (const LobeSpec& lobe : parse_material(model).lobes)
      if (lobe.is_table()) throw UsageError(model + ": a measurement is not a model to fit");
  const std::vector<std::string> files = measured_files(b.paths);
  std::string database = b.database;
  if (database.empty()) {
    database = "fits.sqlite";
    if (!b.study.empty()) {
      std::filesystem::create_directories(b.study);
      database = (std::filesystem::path(b.study) / database).string();
    }
  }
  FitStore store(database);
  if (b.retry) store.forget_failures();
  catch_ctrl_c();
  const BatchResult done = fit_all(files, models, b.thorough ? b.fit : ranking_options(b.fit.model, b.fit),
                                   store, b.quiet || b.json);
  std::size_t failures = 0;
  for (const StoredFit& f : done.failures)
    if (failures++ < 5) std::cerr << fmt::format("nacre: {} as {}: {}\n", f.material, f.key.model, f.failure);
  if (failures > 5) std::cerr << fmt::format("nacre: {} more fits failed, see {}\n", failures - 5, database);
  if (done.stopped) {
    std::cerr << fmt::format(
        "nacre: stopped; {} holds what was done, and the same command goes on from there\n", database);
    throw ExitStatus{exit_interrupted};
  }
  // The study is of everything in the store, whichever call put it there.
  const Study study = make_study(store.all(), std::string(metric_name(b.fit.metric)));
  if (!b.study.empty()) write_study(study, b);
  if (b.json)
    std::cout << to_json(study, done).dump(2) << "\n";
  else
    std::cout << standings_text(study)
              << fmt::format("{} fits done now, {} there before, {} failed; {}\n", done.done, done.skipped,
                             done.failed, database);
}

} // namespace nacre
