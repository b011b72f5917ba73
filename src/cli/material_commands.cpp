#include "cli/commands.h"
#include "cli/exit_status.h"
#include "cli/model_reference.h"
#include "cli/number_range.h"
#include "core/error.h"
#include "core/file.h"
#include "measured/material_spec.h"
#include "report/model_table.h"
#include "report/validation_page.h"
#include "validate/validate.h"

#include <fmt/format.h>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

nlohmann::json to_json(const ModelInfo& model) {
  nlohmann::json parameters = nlohmann::json::array();
  for (const ParameterInfo& p : model.parameters)
    parameters.push_back({{"name", p.name},
                          {"unit", p.unit},
                          {"domain", {p.lo, p.hi}},
                          {"default", p.initial},
                          {"per_channel", p.per_channel},
                          {"fitted", p.fitted},
                          {"meaning", p.meaning}});
  return {
      {"name", model.name}, {"summary", model.summary}, {"source", model.source}, {"parameters", parameters}};
}

std::string to_text(const ModelInfo& model) {
  std::string text = fmt::format("{}: {}\n    source: {}\n", model.name, model.summary, model.source);
  for (const ParameterInfo& p : model.parameters)
    text += fmt::format("    {:<24} {:<8} [{:g}, {:g}]  default {:g}  {}\n", p.name,
                        p.per_channel ? "colour" : "number", p.lo, p.hi, p.initial,
                        p.meaning + (p.unit == "1" ? "" : " (" + p.unit + ")"));
  return text;
}

Vec3d direction(double theta_deg, double phi_deg) {
  // Exactly on the normal and the horizon, where sin and cos would miss by a rounding.
  Vec3d w = spherical_direction(theta_deg * pi / 180, phi_deg * pi / 180);
  if (theta_deg == 90) w.z = 0;
  return theta_deg == 0 ? Vec3d{0, 0, 1} : w;
}
/// Taken as it is given: to normalise it would change its last digits.
Vec3d unit_direction(const std::vector<double>& w, const char* option) {
  const double length = std::hypot(w[0], w[1], w[2]);
  if (!(std::abs(length - 1) <= 1e-6))
    throw UsageError(
        fmt::format("{}: expected a direction of length 1, found length {:.9g}", option, length));
  return {w[0], w[1], w[2]};
}

} // namespace

void add_materials_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("materials", "list the models and their parameters");
  auto name = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false), markdown = std::make_shared<bool>(false);
  auto measured = std::make_shared<bool>(false);
  command->add_option("MODEL", *name, "one model only");
  CLI::Option* as_json = command->add_flag("--json", *json, "one JSON object on standard output");
  CLI::Option* as_page =
      command->add_flag("--markdown", *markdown, "a reference page for the docs")->excludes(as_json);
  command
      ->add_flag("--measure", *measured,
                 "a table of laws kept, evaluations a second and sampling variance; a minute or two")
      ->excludes(as_json)
      ->excludes(as_page);
  command->footer("Example: nacre materials ggx_conductor");
  command->callback([=] {
    const std::vector<ModelInfo> models =
        name->empty() ? model_infos() : std::vector<ModelInfo>{find_model(*name)};
    if (*measured) {
      std::vector<ModelMeasurement> rows;
      for (const ModelInfo& model : models)
        rows.push_back(measure(model));
      std::cout << model_table_markdown(rows);
      return;
    }
    if (*markdown) {
      std::cout << model_reference(models);
      return;
    }
    nlohmann::json list = nlohmann::json::array();
    for (const ModelInfo& model : models) {
      if (*json)
        list.push_back(to_json(model));
      else
        std::cout << to_text(model);
    }
    if (*json) std::cout << nlohmann::json{{"models", list}}.dump(2) << "\n";
  });
}

void add_eval_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("eval", "value of a material at given directions");
  struct Options {
    std::string material;
    double theta_i = 0, theta_o = 0, phi = 0, phi_i = 0, phi_o = 0;
    std::vector<double> wo, wi;
    bool albedo = false, json = false;
  };
  auto o = std::make_shared<Options>();
  command
      ->add_option("MATERIAL", o->material, "NAME:PARAM=VALUE,...[+NAME:...], a measurement, .brdf or .json")
      ->required();
  CLI::Option* theta_i = command->add_option("--theta-i", o->theta_i, "degrees from the normal to the light")
                             ->check(number_in(0, 180));
  CLI::Option* theta_o = command->add_option("--theta-o", o->theta_o, "degrees from the normal to the viewer")
                             ->check(number_in(0, 180));
  CLI::Option* phi = command->add_option("--phi", o->phi, "degrees of azimuth from viewer to light")
                         ->check(number_in(-360, 360));
  CLI::Option* phi_i =
      command->add_option("--phi-i", o->phi_i, "azimuth of the light from the tangent, degrees")
          ->check(number_in(-360, 360))
          ->excludes(phi);
  CLI::Option* phi_o =
      command->add_option("--phi-o", o->phi_o, "azimuth of the viewer from the tangent, degrees")
          ->check(number_in(-360, 360))
          ->excludes(phi);
  const auto add_direction = [&](const char* name, std::vector<double>& w, const char* what) {
    return command->add_option(name, w, what)
        ->delimiter(',')
        ->expected(3)
        ->check(number_in(-1, 1))
        ->excludes(phi);
  };
  add_direction("--wi", o->wi, "the light's direction instead, as x,y,z of length 1, to the last digit")
      ->excludes(theta_i)
      ->excludes(phi_i);
  add_direction("--wo", o->wo, "the viewer's direction instead, as x,y,z of length 1, to the last digit")
      ->excludes(theta_o)
      ->excludes(phi_o);
  command->add_flag("--albedo", o->albedo,
                    "the sampling laws and the directional albedo of the material too");
  command->add_flag("--json", o->json, "one JSON object on standard output");
  command->footer(
      "Example: nacre eval ggx_conductor:alpha_x=0.1,alpha_y=0.3 --theta-i 30 --theta-o 40 --phi 180");
  command->callback([o] {
    const MaterialSpec material = parse_material(o->material);
    const Scattering bsdf = Scattering::of(material); // not clamped: a negative value is shown
    const Vec3d wo = o->wo.empty() ? direction(o->theta_o, o->phi_o) : unit_direction(o->wo, "--wo");
    const Vec3d wi = o->wi.empty() ? direction(o->theta_i, o->phi_i + o->phi) : unit_direction(o->wi, "--wi");
    const auto f = bsdf.eval(wo, wi);
    const double pdf = bsdf.pdf(wo, wi);
    if (o->json) {
      nlohmann::json json{{"material", material.name},
                          {"f", f.c},
                          {"pdf", pdf},
                          {"wo", {wo.x, wo.y, wo.z}},
                          {"wi", {wi.x, wi.y, wi.z}}};
      if (o->albedo) json["validation"] = to_json(validate(material));
      std::cout << json.dump(2) << "\n";
    } else {
      std::cout << fmt::format("f   {:.9g} {:.9g} {:.9g}  1/sr, linear RGB\npdf {:.9g}  1/sr\n", f[0], f[1],
                               f[2], pdf);
      if (o->albedo) std::cout << to_text(validate(material));
    }
  });
}

void add_validate_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "validate", "judge a material by the laws of reflectance; exit status 3 if one is violated");
  struct Options {
    std::string material;
    ValidateOptions validate;
    std::string page;
    bool json = false;
  };
  auto o = std::make_shared<Options>();
  command
      ->add_option("MATERIAL", o->material, "NAME:PARAM=VALUE,...[+NAME:...], a measurement, .brdf or .json")
      ->required();
  command->add_option("--samples", o->validate.samples, "samples a viewing angle")
      ->check(whole_number_in(1000, 100000000));
  command->add_option("--directions", o->validate.directions, "random pairs of directions")
      ->check(whole_number_in(100, 100000000));
  command->add_option("--seed", o->validate.seed, "seed of the random numbers")->check(any_whole_number());
  command->add_flag("--json", o->json, "one JSON object on standard output");
  command->add_option("--report", o->page, "an HTML page with maps and curves, besides what is printed");
  command->footer("Examples:\n"
                  "  nacre validate oren_nayar:reflectance=1,sigma=0.2\n"
                  "  nacre validate ward:specular_reflectance=1,alpha_x=0.5,alpha_y=0.5 --report ward.html");
  command->callback([o] {
    const MaterialSpec material = parse_material(o->material);
    const ValidationReport report = validate(material, o->validate);
    if (!o->page.empty()) write_file_atomically(o->page, validation_page(material, report));
    if (o->json)
      std::cout << to_json(report).dump(2) << "\n";
    else
      std::cout << to_text(report);
    if (!report.holds()) throw ExitStatus{exit_violated};
  });
}

} // namespace nacre
