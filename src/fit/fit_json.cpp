#include "fit/fit.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

nlohmann::json number(double x) { return std::isfinite(x) ? nlohmann::json(x) : nlohmann::json(nullptr); }

nlohmann::json to_json(const FittedParameter& p) {
  nlohmann::json json{{"label", p.label},
                      {"model", p.model},
                      {"lobe", p.lobe},
                      {"name", p.name},
                      {"unit", p.unit},
                      {"value", number(p.value)},
                      {"standard_error", number(p.standard_error)},
                      {"uniform_noise_error", number(p.uniform_noise_error)},
                      {"domain", {p.lo, p.hi}},
                      {"interval", {number(p.interval_lo), number(p.interval_hi)}},
                      {"uncertainty", number(p.uncertainty())},
                      {"at_bound", p.at_bound},
                      {"identifiable", p.identifiable}};
  if (p.channel >= 0) json["channel"] = std::string(1, "rgb"[p.channel]);
  if (!p.partner.empty())
    json["most_correlated"] = {{"with", p.partner}, {"correlation", number(p.correlation)}};
  if (!p.tied.empty()) json["tied"] = p.tied;
  return json;
}

} // namespace

nlohmann::json to_json(const FitResult& result) {
  nlohmann::json parameters = nlohmann::json::array(), starts = nlohmann::json::array();
  for (const FittedParameter& p : result.parameters)
    parameters.push_back(to_json(p));
  for (const FitStart& s : result.starts)
    starts.push_back(
        {{"coarse_error", number(s.coarse_error)},
         {"refined_error", s.refined_error < 0 ? nlohmann::json(nullptr) : number(s.refined_error)},
         {"iterations", s.iterations}});
  nlohmann::json covariance = nlohmann::json::array();
  for (const FittedParameter& p : result.parameters) {
    covariance.push_back(nlohmann::json::array());
    for (const double c : p.covariance)
      covariance.back().push_back(number(c));
  }
  nlohmann::json json = to_json(result.material);
  json["fit"] = {{"metric", metric_name(result.metric)},
                 {"errors",
                  {{"cosine", result.errors.cosine},
                   {"log", result.errors.log},
                   {"cube_root", result.errors.cube_root},
                   {"relative", result.errors.relative}}},
                 {"nodes_compared", result.errors.nodes},
                 {"grid",
                  {{"error", result.fit_error},
                   {"nodes", result.nodes},
                   {"theta_d_step", result.theta_d_step},
                   {"phi_d_step", result.phi_d_step},
                   {"max_theta_deg", result.max_theta_deg}}},
                 {"isotropic", result.isotropic},
                 {"parameters", parameters},
                 {"covariance", covariance},
                 {"starts", starts},
                 {"best_start", result.best_start},
                 {"iterations", result.iterations},
                 {"converged", result.converged},
                 {"message", result.message},
                 {"seconds", result.seconds}};
  json["fit"]["confidence"] = result.confidence;
  if (result.channel >= 0) json["fit"]["channel"] = std::string(1, "rgb"[result.channel]);
  if (result.loss.kind != LossKind::squares)
    json["fit"]["loss"] = {{"kind", loss_name(result.loss.kind)}, {"scale", result.loss.scale}};
  if (result.images.pixels > 0)
    json["fit"]["images"] = {{"image", result.images.image}, {"delta_e", result.images.delta_e}};
  return json;
}

} // namespace nacre
