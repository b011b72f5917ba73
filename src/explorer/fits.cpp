// Requests to fit models to a measurement.
#include "explorer/desk.h"
#include "fit/fit.h"
#include "measured/material_as_measurement.h"

#include <chrono>

namespace nacre {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

json finite(double x) { return std::isfinite(x) ? json(x) : json(); }

json result_json(const std::string& model, const FitResult& fit) {
  json parameters = json::array();
  for (const FittedParameter& p : fit.parameters)
    parameters.push_back({{"lobe", p.model},
                          {"name", p.channel < 0 ? p.name : p.name + "." + "rgb"[p.channel]},
                          {"value", finite(p.value)},
                          {"error", finite(p.standard_error)},
                          {"at_bound", p.at_bound},
                          {"identifiable", p.identifiable}});
  json errors = json::object();
  for (const Metric metric : all_metrics)
    errors[std::string(metric_name(metric))] = finite(fit.errors.of(metric));
  return {{"model", model},        {"material", resolved(fit.material)}, {"parameters", parameters},
          {"errors", errors},      {"converged", fit.converged},         {"message", fit.message},
          {"seconds", fit.seconds}};
}

} // namespace

Answer answer_fit(const Arguments& request, const Desk& desk) {
  const json& named = request.at("measured");
  const auto material =
      desk.materials.resolve(named.is_string() ? json{{"file", named}} : named, desk.folder);
  // A shader or a sum of models may be what others are to be like.
  const auto measured = as_measurement(*material);
  FitOptions options;
  options.find_file = [&](const std::string& file) { return desk.folder.found(file); };
  options.metric = parse_metric(request.text("metric", std::string(metric_name(options.metric))));
  options.starts = request.whole("starts", 8, 1, 1000);
  std::vector<std::string> models;
  for (const json& model : request.list("models", 64)) {
    if (!model.is_string()) throw Error("'models' is a list of texts such as \"ggx_schlick+lambert\"");
    models.push_back(model.get<std::string>());
  }
  Answer last;
  last.header["results"] = json::array();
  const FitData data(*measured);
  options.stopped = [&] { return desk.is_cancelled(); };
  for (std::size_t i = 0; i < models.size() && !desk.is_cancelled(); ++i) {
    // An error of one model leaves the others.
    try {
      options.model = models[i];
      const auto tell = [&](const MaterialSpec& best, double error, int iteration, double share) {
        Answer answer;
        answer.header = {{"model", models[i]},
                         {"material", resolved(best)},
                         {"best_error", finite(error)},
                         {"iteration", iteration}};
        answer.header["results"] = last.header["results"];
        desk.progress((double(i) + share) / double(models.size()), answer);
      };
      Clock::time_point last_told{};
      int iterations = 0;
      options.on_better = [&](const FitProgress& p) {
        iterations = p.iterations;
        if (Clock::now() - last_told < std::chrono::milliseconds(25)) return;
        tell(p.material, p.error, p.iterations, p.share);
        last_told = Clock::now();
      };
      const FitResult whole = fit(data, options);
      last.header["results"].push_back(result_json(models[i], whole));
      tell(whole.material, whole.fit_error, iterations + 1, 1);
    } catch (const Error& e) {
      if (desk.is_cancelled()) break; // what was fitted before is told
      if (models.size() == 1) throw;
      last.header["results"].push_back({{"model", models[i]},
                                        {"failed", e.what()},
                                        {"material", nullptr},
                                        {"parameters", json::array()},
                                        {"errors", json::object()},
                                        {"seconds", 0}});
    }
  }
  return last;
}

} // namespace nacre
