#include "cli/commands.h"
#include "cli/number_range.h"
#include "core/error.h"
#include "core/file.h"
#include "display/tonemap.h"
#include "report/material_images.h"
#include "report/pictures.h"
#include "report/surface_plots.h"

#include <fmt/format.h>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>

namespace nacre {
namespace {

struct PlotArguments {
  std::vector<std::string> materials;
  std::string output, kind = "lobe", parameter;
  std::vector<double> theta{0, 30, 60}, range;
  double theta_d = 0, wavelength = 550, exposure = 0;
  int size = 256;
  bool linear = false, no_cosine = false;
};

struct PlotKind {
  std::string_view name, shows;
  bool image = false;      ///< a PNG or EXR; else an SVG
  bool substances = false; ///< takes names of metals and glasses instead of materials
};

constexpr std::array<PlotKind, 15> kinds{
    {{"lobe", "f over theta_o in the plane of incidence, a curve a --theta"},
     {"theta_i", "f over theta_i for fixed viewers at --theta"},
     {"polar",
      "the lobes in the plane of incidence: f cos theta_o as the length of rays, its root without --linear"},
     {"theta_h", "f over the half vector's angle at --theta-d"},
     {"theta_d", "f in the mirror direction"},
     {"phi", "f over the azimuth at theta_i = theta_o = --theta"},
     {"albedo", "directional albedo over theta"},
     {"albedo-roughness", "directional albedo over --parameter, a curve a --theta"},
     {"D", "distribution of facet normals"},
     {"G1", "masking"},
     {"fresnel", "reflectance of named metals and glasses over the angle", false, true},
     {"fresnel-wavelength", "and over the wavelength, at normal incidence", false, true},
     {"sphere", "a lit sphere, one a material", true},
     {"furnace", "7 spheres of rising --parameter in uniform light of 1, a row a material", true},
     {"slice", "f over theta_h and theta_d, one square a material", true}}};

std::vector<PlottedMaterial> plotted(const std::vector<MaterialSpec>& specs) {
  std::vector<PlottedMaterial> materials;
  for (const MaterialSpec& spec : specs)
    materials.push_back({&spec, spec.name, false});
  // Of two materials of which one is measured, that one is dots: the other is most likely its fit.
  if (specs.size() == 2) {
    const auto measured = [](const MaterialSpec& m) { return m.lobes.size() == 1 && m.lobes[0].measured; };
    if (measured(specs[0]) != measured(specs[1])) {
      if (measured(specs[1])) std::swap(materials[0], materials[1]);
      materials[0].dots = true;
    }
  }
  return materials;
}

std::string varied_parameter(const PlotArguments& a, const MaterialSpec& material) {
  return a.parameter.empty() ? roughness_parameter(material) : a.parameter;
}

/// What --range says; else of the domain that all materials share what lies below 1.
std::array<double, 2> varied_range(const PlotArguments& a, std::span<const MaterialSpec> materials,
                                   const std::string& parameter) {
  if (!a.range.empty()) return {a.range[0], a.range[1]};
  double lo = -std::numeric_limits<double>::infinity(), hi = 1;
  for (const MaterialSpec& material : materials) {
    const auto domain = parameter_domain(material, parameter);
    lo = std::max(lo, domain[0]), hi = std::min(hi, domain[1]);
  }
  lo = std::max(lo, 0.05 * hi); // the smoothest take as long as all others
  if (!(lo < hi)) throw UsageError("--parameter " + parameter + ": name its --range from,to");
  return {lo, hi};
}

std::string make_svg(const PlotArguments& a, const std::vector<MaterialSpec>& specs) {
  const std::vector<PlottedMaterial> materials = plotted(specs);
  const bool log = !a.linear;
  const std::map<std::string_view, std::function<std::string()>> draw{
      {"lobe", [&] { return svg_file(incidence_plane_plot(materials, a.theta, log)); }},
      {"theta_i", [&] { return svg_file(theta_i_plot(materials, a.theta, log)); }},
      {"polar", [&] { return polar_svg(materials, a.theta, a.linear ? 1 : 0.5); }},
      {"theta_h", [&] { return svg_file(theta_h_plot(materials, a.theta_d, log)); }},
      {"theta_d", [&] { return svg_file(theta_d_plot(materials, log)); }},
      {"phi", [&] { return svg_file(azimuth_plot(materials, a.theta, log)); }},
      {"albedo", [&] { return svg_file(albedo_plot(materials)); }},
      {"albedo-roughness",
       [&] {
         const std::string parameter = varied_parameter(a, specs[0]);
         const auto [lo, hi] = varied_range(a, specs, parameter);
         return svg_file(albedo_over_parameter_plot(materials, parameter, lo, hi, a.theta));
       }},
      {"D", [&] { return svg_file(facet_normal_plot(materials, log)); }},
      {"G1", [&] { return svg_file(masking_plot(materials)); }},
      {"fresnel", [&] { return svg_file(fresnel_plot(a.materials, a.wavelength)); }},
      {"fresnel-wavelength", [&] { return svg_file(fresnel_wavelength_plot(a.materials)); }}};
  return draw.at(a.kind)();
}

/// Rows of one width, one under the other.
Image stacked(const std::vector<Image>& rows) {
  Image all(rows[0].width, 0, rows[0].channels);
  for (const Image& row : rows) {
    all.data.insert(all.data.end(), row.data.begin(), row.data.end());
    all.height += row.height;
  }
  return all;
}

Image make_image(const PlotArguments& a, const std::vector<MaterialSpec>& specs) {
  std::vector<Image> images;
  for (const MaterialSpec& spec : specs) {
    if (a.kind == "sphere") {
      SphereLight light;
      light.cosine = !a.no_cosine;
      images.push_back(lit_sphere(spec, a.size, light));
    } else if (a.kind == "slice") {
      images.push_back(image_slice(spec, a.size));
    } else {
      const std::string parameter = varied_parameter(a, spec);
      const auto [lo, hi] = varied_range(a, {&spec, 1}, parameter);
      std::array<double, 7> values;
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = lo + (hi - lo) * double(i) / double(values.size() - 1);
      images.push_back(white_furnace(spec, parameter, values, a.size));
    }
  }
  return a.kind == "furnace" ? stacked(images) : side_by_side(images, a.size / 32, 0);
}

void write_image(const Image& image, const PlotArguments& a) {
  if (a.output.ends_with(".exr")) return write_exr(image, a.output);
  ToneMapOptions options;
  options.operator_name = "clip";
  options.exposure_stops = a.kind == "furnace" ? a.exposure - 1 : a.exposure; // room for a gain above 1
  write_png(tone_map(image, options), a.output);
}

} // namespace

void add_plot_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("plot", "curves and pictures of one or several materials");
  auto a = std::make_shared<PlotArguments>();
  command
      ->add_option("MATERIAL", a->materials,
                   "NAME:PARAM=VALUE,...[+NAME:...], a measurement, .brdf or .json; names of "
                   "metals and glasses for the Fresnel kinds")
      ->required()
      ->check(
          [](const std::string& m) { return m.empty() ? std::string("the name is empty") : std::string(); });
  command->add_option(
      "-o,--output", a->output,
      "file to write: .svg for curves, .png or .exr (linear) for pictures (default: plot.svg, "
      "plot.png)");
  std::vector<std::string> names;
  std::string shows = "\nKinds:\n";
  for (const PlotKind& kind : kinds) {
    names.emplace_back(kind.name);
    shows += fmt::format("  {:<19} {}\n", kind.name, kind.shows);
  }
  command->add_option("--kind", a->kind, "what to draw, see below")
      ->check(CLI::IsMember(names))
      ->capture_default_str();
  command->add_option("--theta,--theta-i", a->theta, "angles of the curves, degrees, with commas between")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(number_in(0, 89.9))
      ->capture_default_str();
  command->add_option("--theta-d", a->theta_d, "angle of incidence on the facet of theta_h, degrees")
      ->check(number_in(0, 89.9))
      ->capture_default_str();
  command->add_option("--parameter", a->parameter,
                      "what furnace and albedo-roughness vary (default: the roughness); alpha stands for "
                      "alpha_x and alpha_y too");
  command->add_option("--range", a->range, "from,to: values of that parameter")
      ->delimiter(',')
      ->expected(2)
      ->allow_extra_args(false)
      ->check(number_in(-1e6, 1e6));
  command->add_option("--wavelength", a->wavelength, "nm, of the Fresnel curves")
      ->check(number_in(360, 830))
      ->capture_default_str();
  command->add_option("--size", a->size, "pixels of a sphere or slice")
      ->check(whole_number_in(8, 8192))
      ->capture_default_str();
  command->add_option("--exposure", a->exposure, "stops, of a PNG")
      ->check(number_in(-50, 50))
      ->capture_default_str();
  command->add_flag("--no-cosine", a->no_cosine, "spheres show pi f alone, without cos theta_i");
  command->add_flag("--linear,!--log", a->linear, "a linear scale of values instead of a logarithmic one");
  command->footer(shows +
                  "\nExamples:\n"
                  "  nacre plot ggx_schlick:f0=0.9/0.6/0.3,alpha=0.2 -o lobe.svg --theta 0,30,60\n"
                  "  nacre plot measured.binary fit.json --kind theta_h\n"
                  "  nacre plot --kind fresnel Au Cu Al BK7 -o fresnel.svg\n"
                  "  nacre plot --kind furnace ggx_conductor:eta=0.01,k=30 walk_ggx_conductor:eta=0.01,k=30");
  command->callback([a] {
    const PlotKind& kind =
        *std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.name == a->kind; });
    if (a->output.empty()) a->output = kind.image ? "plot.png" : "plot.svg";
    const bool fits =
        kind.image ? a->output.ends_with(".png") || a->output.ends_with(".exr") : a->output.ends_with(".svg");
    if (!fits)
      throw UsageError(
          fmt::format("{}: --kind {} writes {}", a->output, kind.name, kind.image ? ".png or .exr" : ".svg"));
    if (!a->range.empty() && !(a->range[0] < a->range[1]))
      throw UsageError("--range: expected from,to with from < to");
    std::vector<MaterialSpec> materials;
    for (const std::string& text : a->materials)
      if (!kind.substances) materials.push_back(parse_material(text));
    if (kind.image)
      write_image(make_image(*a, materials), *a);
    else
      write_file_atomically(a->output, make_svg(*a, materials));
    std::cout << a->output << "\n";
  });
}

} // namespace nacre
