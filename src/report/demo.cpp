#include "report/demo.h"

#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"
#include "core/version.h"
#include "measured/published_fits.h"
#include "render/render.h"
#include "report/fit_sections.h"
#include "report/html_report.h"
#include "report/material_plots.h"
#include "report/output_folder.h"
#include "report/preview_scene.h"

#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

constexpr std::array<double, 5> plotted_theta_i_deg{0, 20, 40, 60, 75};
constexpr double plotted_theta_d_deg = 2; // nearer to 0 a real measurement stands in its own light

double seconds_since(std::chrono::steady_clock::time_point began) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

/// Does a step, times it, and tells.
class Steps {
public:
  Steps(DemoResult& result, const DemoOptions& options) : result_(result), options_(options) {}
  /// @param work  returns what came out, in a line
  template <class F>
  void operator()(const std::string& name, F work) {
    if (stop_requested()) throw Error(fmt::format("stopped before '{}': no report was written", name));
    const auto began = std::chrono::steady_clock::now();
    std::string what = work();
    result_.steps.push_back({name, std::move(what), seconds_since(began)});
    if (options_.on_step) options_.on_step(result_.steps.back());
  }

private:
  DemoResult& result_;
  const DemoOptions& options_;
};

std::string verdict(const ValidationReport& report) {
  std::string violated;
  for (const LawResult& law : report.laws)
    if (law.verdict == Verdict::violated) violated += (violated.empty() ? "" : ", ") + law.law;
  return violated.empty() ? fmt::format("{} laws hold", report.laws.size()) : "violated: " + violated;
}

std::shared_ptr<const Image> read_environment(const std::string& path) {
  Image image = read_image_linear(path);
  if (image.channel("R") < 0 || image.channel("G") < 0 || image.channel("B") < 0)
    throw Error::in_file(path, "an environment needs the channels R, G and B");
  return std::make_shared<const Image>(std::move(image));
}

std::vector<Plot> plots(const MaterialSpec& measured, const MaterialSpec& fit) {
  const std::array<PlottedMaterial, 2> both{{{&measured, "measured", true}, {&fit, "fit", false}}};
  std::vector<Plot> all{incidence_plane_plot(both, plotted_theta_i_deg, true),
                        theta_h_plot(both, plotted_theta_d_deg, true), theta_d_plot(both, true),
                        albedo_plot(both)};
  return all;
}

/// What can be known to be wrong before any work is done.
void check(const DemoOptions& o) {
  if (o.samples_per_pixel < 1 || o.samples_per_pixel > 1 << 20)
    throw Error(fmt::format("samples per pixel must lie in [1, {}], found {}", 1 << 20, o.samples_per_pixel));
  if (o.width < 16 || o.height < 16 || o.width > 8192 || o.height > 8192)
    throw Error(fmt::format("a preview has 16 to 8192 pixels a side, found {} x {}", o.width, o.height));
  for (const LobeSpec& lobe : parse_material(o.fit.model).lobes)
    if (lobe.is_table()) throw Error(o.fit.model + ": a measured table is not a model to fit");
  if (o.file.empty()) published_fit(o.published);
}

} // namespace

DemoResult run_demo(const DemoOptions& options) {
  const auto began = std::chrono::steady_clock::now();
  check(options);
  DemoResult result;
  Steps step(result, options);
  DemoFindings findings;

  // A given file is read before anything is written: a mistyped name leaves no folder behind.
  std::shared_ptr<const MerlTable> table;
  std::string file = options.file;
  const auto read = [&] {
    step("read", [&] {
      table = read_merl(file);
      return fmt::format("{}: {} x {} x {} entries, {:.1f} % of them holes", file, table->n_theta_h(),
                         table->n_theta_d(), table->n_phi_d(),
                         100.0 * static_cast<double>(table->hole_count()) /
                             static_cast<double>(table->size()));
    });
  };
  std::shared_ptr<const Image> environment;
  if (!options.environment.empty()) environment = read_environment(options.environment);
  if (!file.empty()) read();
  OutputFolder folder(options.folder);
  if (file.empty()) {
    step("write", [&] {
      file = folder.add(options.published + ".binary",
                        [&](const std::string& path) { write_merl(demo_table(options.published), path); });
      return file + ": published parameters of a measured material as a full table";
    });
    read();
    findings.source = "The table was made from parameters published for this material of the MERL database "
                      "(Löw et al. 2012), for lack of the measurement itself.";
  } else {
    findings.source =
        fmt::format("Measured reflectance from {}.", std::filesystem::path(file).filename().string());
  }

  LobeSpec lobe;
  lobe.measured = table;
  result.measured = {std::filesystem::path(file).stem().string(), {lobe}};

  step("fit", [&] {
    FitOptions fit_options = options.fit;
    fit_options.seed = options.seed;
    result.fit = fit(*table, fit_options);
    result.fit.material.name = result.measured.name + ", fitted";
    return fmt::format("{}, error {:.4g} ({} metric)", readable_text(result.fit.material),
                       result.fit.errors.of(result.fit.metric), metric_name(result.fit.metric));
  });
  ValidateOptions validation = options.validate;
  validation.seed = options.seed + 1;
  step("validate measured", [&] {
    result.measured_validation = validate(result.measured, validation);
    return verdict(result.measured_validation);
  });
  step("validate fit", [&] {
    result.fit_validation = validate(result.fit.material, validation);
    return verdict(result.fit_validation);
  });

  if (!environment)
    step("sky", [&] {
      environment = preview_sky();
      return "analytic sun and sky (Preetham et al. 1999)";
    });
  const auto make_picture = [&](const MaterialSpec& material) {
    RenderOptions render_options;
    render_options.samples_per_pixel = options.samples_per_pixel;
    render_options.seed = options.seed;
    render_options.quiet = options.quiet;
    RenderResult rendered =
        render(preview_scene(material, environment, options.width, options.height), render_options);
    if (!rendered.complete) throw Error("stopped while rendering: no report was written");
    return rendered;
  };
  Image measured_picture, fit_picture;
  for (const auto& [name, material, picture] : {std::tuple{"measured", &result.measured, &measured_picture},
                                                {"fit", &result.fit.material, &fit_picture}})
    step(fmt::format("render {}", name), [&, material = material, picture = picture] {
      RenderResult rendered = make_picture(*material);
      *picture = std::move(rendered.image);
      return fmt::format("{} x {}, {} paths a pixel, {:.1f} million rays", options.width, options.height,
                         options.samples_per_pixel, 1e-6 * static_cast<double>(rendered.rays));
    });

  ComparedPictures pictures;
  step("tone-map and compare", [&] {
    pictures = compare_for_display(fit_picture, measured_picture);
    result.rmse = pictures.rmse;
    result.flip = pictures.flip_mean;
    result.hdr_flip = pictures.hdr_flip_mean;
    return fmt::format("FLIP {:.4f}, RMSE {:.4g}", result.flip, result.rmse);
  });
  step("plot", [&] {
    findings.plots = plots(result.measured, result.fit.material);
    return fmt::format("{} plots", findings.plots.size());
  });

  step("write pictures", [&] {
    folder.add("measured.exr", [&](const std::string& path) { write_exr(measured_picture, path); });
    folder.add("fit.exr", [&](const std::string& path) { write_exr(fit_picture, path); });
    folder.add("fit.json", [&](const std::string& path) {
      write_file_atomically(path, to_json(result.fit).dump(2) + "\n");
    });
    result.picture = folder.add("picture.png", [&](const std::string& path) {
      const std::array<Image, 3> row{pictures.reference, pictures.picture, pictures.flip};
      write_png(side_by_side(row, 6, 0.5f), path);
    });
    return result.picture + ": measured, fit, difference";
  });

  findings.material = result.measured.name;
  findings.environment = options.environment.empty()
                             ? "an analytic sun and sky"
                             : std::filesystem::path(options.environment).filename().string();
  findings.command = options.command;
  findings.version = version();
  findings.fit = &result.fit;
  findings.measured_validation = &result.measured_validation;
  findings.fit_validation = &result.fit_validation;
  findings.pictures = &pictures;
  findings.width = options.width, findings.height = options.height;
  findings.samples_per_pixel = options.samples_per_pixel;
  findings.steps = result.steps;
  result.report = folder.add(
      "report.html", [&](const std::string& path) { write_file_atomically(path, html_report(findings)); });
  folder.keep();
  result.seconds = seconds_since(began);
  return result;
}

} // namespace nacre
