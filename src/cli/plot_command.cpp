#include "cli/commands.h"
#include "cli/number_range.h"
#include "core/error.h"
#include "core/file.h"
#include "report/material_plots.h"

#include <fmt/format.h>
#include <iostream>
#include <memory>

namespace nacre {
namespace {

struct PlotArguments {
  std::vector<std::string> materials;
  std::string output = "plot.svg", kind = "lobe";
  std::vector<double> theta_i{0, 30, 60};
  double theta_d = 0;
  bool linear = false;
};

Plot make_plot(const PlotArguments& a, const std::vector<MaterialSpec>& specs) {
  std::vector<PlottedMaterial> materials;
  for (std::size_t i = 0; i < specs.size(); ++i)
    materials.push_back({&specs[i], specs[i].name, false});
  // Of two materials of which one is measured, that one is dots: the other is most likely its fit.
  if (specs.size() == 2) {
    const auto measured = [](const MaterialSpec& m) { return m.lobes.size() == 1 && m.lobes[0].table; };
    if (measured(specs[0]) != measured(specs[1])) {
      if (measured(specs[1])) std::swap(materials[0], materials[1]);
      materials[0].dots = true;
    }
  }
  if (a.kind == "theta_h") return theta_h_plot(materials, a.theta_d, !a.linear);
  if (a.kind == "theta_d") return theta_d_plot(materials, !a.linear);
  if (a.kind == "albedo") return albedo_plot(materials);
  return incidence_plane_plot(materials, a.theta_i, !a.linear);
}

} // namespace

void add_plot_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("plot", "curves of one or several materials as an SVG picture");
  auto a = std::make_shared<PlotArguments>();
  command->add_option("MATERIAL", a->materials, "NAME:PARAM=VALUE,...[+NAME:...], .binary or .json")
      ->required()
      ->check(
          [](const std::string& m) { return m.empty() ? std::string("the name is empty") : std::string(); });
  command->add_option("-o,--output", a->output, "picture to write, .svg")->capture_default_str();
  command
      ->add_option(
          "--kind", a->kind,
          "lobe: plane of incidence over theta_o; theta_h, theta_d: over an angle of the half vector; "
          "albedo: over theta")
      ->check(CLI::IsMember({"lobe", "theta_h", "theta_d", "albedo"}))
      ->capture_default_str();
  command->add_option("--theta-i", a->theta_i, "angles of incidence of lobes, degrees, with commas between")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(number_in(0, 89.9))
      ->capture_default_str();
  command->add_option("--theta-d", a->theta_d, "angle of incidence on the facet of theta_h, degrees")
      ->check(number_in(0, 89.9))
      ->capture_default_str();
  command->add_flag("--linear,!--log", a->linear, "a linear scale of values instead of a logarithmic one");
  command->footer("Examples:\n"
                  "  nacre plot ggx_schlick:f0=0.9/0.6/0.3,alpha=0.2 -o lobe.svg --theta-i 0,30,60\n"
                  "  nacre plot measured.binary fit.json --kind theta_h");
  command->callback([a] {
    if (!a->output.ends_with(".svg")) throw UsageError(fmt::format("{}: plot writes .svg alone", a->output));
    std::vector<MaterialSpec> materials;
    for (const std::string& text : a->materials)
      materials.push_back(parse_material(text));
    write_file_atomically(a->output, svg_file(make_plot(*a, materials)));
    std::cout << a->output << "\n";
  });
}

} // namespace nacre
