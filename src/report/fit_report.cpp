#include "report/fit_report.h"

#include "core/file.h"
#include "display/colormap.h"
#include "display/tonemap.h"
#include "report/fit_sections.h"
#include "report/html_page.h"
#include "report/material_images.h"
#include "report/output_folder.h"
#include "report/pictures.h"
#include "report/surface_plots.h"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

constexpr std::array<double, 5> theta_i_deg{0, 20, 40, 60, 75};
constexpr std::array<double, 3> lobes_deg{15, 45, 70};
constexpr double near_backscattering_deg = 2; // nearer to 0 a real measurement stands in its own light
constexpr int picture_size = 320;
constexpr double most_stops = 2; ///< between fit and measurement, at the ends of the colours of a slice

float pixel_luminance(const float* rgb) { return float(luminance({rgb[0], rgb[1], rgb[2]})); }

/// log2 of fit over measured, as colours; grey where one of them is 0.
Image slice_difference(const Image& measured, const Image& fit) {
  Image image(measured.width, measured.height, {"R", "G", "B"});
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const float a = pixel_luminance(measured.at(x, y)), b = pixel_luminance(fit.at(x, y));
      std::array<float, 3> code{0.45f, 0.45f, 0.45f};
      if (a > 0 && b > 0) code = signed_colour(std::log2(b / a) / most_stops);
      std::copy(code.begin(), code.end(), image.at(x, y));
    }
  return image;
}

/// Stops that bring the log-average luminance of what is not black to a middle grey.
double slice_exposure(const Image& slice) {
  double sum = 0;
  int n = 0;
  for (int y = 0; y < slice.height; ++y)
    for (int x = 0; x < slice.width; ++x)
      if (const float v = pixel_luminance(slice.at(x, y)); v > 1e-6f) sum += std::log2(v), ++n;
  return n == 0 ? 0 : std::log2(0.18) - sum / n;
}

std::string slices_section(const MaterialSpec& measured, const MaterialSpec& fit) {
  const Image a = image_slice(measured, picture_size), b = image_slice(fit, picture_size);
  ToneMapOptions tone;
  tone.operator_name = "clip";
  tone.exposure_stops = slice_exposure(a);
  std::string html =
      "<section id=slices><h2>Image slices</h2>\n<p class=soft>f at φd = 90°: the peak at the left edge, "
      "grazing reflection at the top, light sent back along the bottom. Left to right √θh from 0 to 90°, "
      "bottom to top θd from 0 to 90° (Burley 2012). Black: below the horizon, or a hole of the "
      "measurement.</p>\n<div class=grid>\n";
  html += html_figure(html_image(tone_map(a, tone), "Slice of the measurement"), "<b>Measured</b>");
  html += html_figure(html_image(tone_map(b, tone), "Slice of the fit"), "<b>Fit</b>");
  html +=
      html_figure(html_image(slice_difference(a, b), "Difference of the slices in stops"),
                  fmt::format("<b>Fit over measured</b>, luminance: <span class=key>−{0:g} stops{1}+{0:g} "
                              "stops</span>",
                              most_stops, html_ramp(signed_colour, -1, 1)));
  return html + fmt::format("</div>\n<p class=soft>Measured and fit are shown at {} stops.</p></section>\n",
                            html_number(tone.exposure_stops, 2));
}

std::string spheres_section(const MaterialSpec& measured, const MaterialSpec& fit) {
  std::string html =
      "<section id=spheres><h2>Lit spheres</h2>\n<p class=soft>Under one distant light, without "
      "shadows or surroundings: π f cos θi.</p>\n<div class=grid>\n";
  for (const auto& [light, where] :
       {std::pair{SphereLight{}, "light over the viewer's shoulder"},
        std::pair{SphereLight{.theta_deg = 105, .phi_deg = 60}, "light from behind"}}) {
    const ComparedPictures p =
        compare_for_display(lit_sphere(fit, picture_size, light), lit_sphere(measured, picture_size, light));
    html += html_figure(html_image(p.reference, "Sphere of the measurement"),
                        fmt::format("<b>Measured</b>, {}", where));
    html += html_figure(html_image(p.picture, "Sphere of the fit"),
                        fmt::format("<b>Fit</b>, FLIP to measured {}", html_number(p.flip_mean, 3)));
    html +=
        html_figure(html_image(p.signed_luminance, "Signed luminance difference of the spheres"),
                    fmt::format("<b>Fit − measured</b>, luminance on the display: <span class=key>−{0:g}{1}"
                                "+{0:g}</span>",
                                p.signed_range, html_ramp(signed_colour, -1, 1)));
  }
  return html + "</div></section>\n";
}

std::string curves_section(const MaterialSpec& measured, const MaterialSpec& fit) {
  const std::array<PlottedMaterial, 2> both{{{&measured, "measured", true}, {&fit, "fit", false}}};
  std::string html = plots_section(
      {half_vector_plot(both, theta_i_deg, true), incidence_plane_plot(both, theta_i_deg, true),
       theta_h_plot(both, near_backscattering_deg, true), theta_d_plot(both, true), albedo_plot(both)});
  html += "<section id=lobes><h2>Lobes</h2>\n<div class=plots>\n";
  for (const PlottedMaterial& m : both)
    html += html_figure(polar_element({&m, 1}, lobes_deg), "<b>" + m.label + "</b>");
  return html + "</div></section>\n";
}

} // namespace

std::string fit_report_html(const FitReport& report) {
  const FitResult& fit = report.fits.front();
  LobeSpec lobe;
  lobe.measured = report.measured;
  const MaterialSpec measured{report.title, {lobe}};
  const ValidationReport validation = validate(fit.material);
  const auto undetermined = std::count_if(fit.parameters.begin(), fit.parameters.end(),
                                          [](const FittedParameter& p) { return !p.identifiable; });

  std::string html = "<header><h1>" + escape_xml(report.title) + "</h1>\n<p class=soft>" +
                     escape_xml(report.measured->kind()) + " from " + escape_xml(report.source) +
                     ", fitted with <code>" + escape_xml(model_names(fit.material)) +
                     "</code>.</p></header>\n<div class=facts>\n";
  html += html_fact(html_number(fit.errors.of(Metric::log), 3), "error, log metric");
  html += html_fact(html_number(fit.errors.of(Metric::cosine), 3), "error, cosine metric, 1/sr");
  html += html_fact(fmt::format("{}", fit.parameters.size()),
                    undetermined == 0
                        ? "parameters, all determined by the data"
                        : fmt::format("parameters, {} of them not determined by the data", undetermined));
  html += html_fact(html_verdict(validation), "laws of reflectance, fit");
  html += "</div>\n";
  if (report.fits.size() > 1) html += ranking_section(report.fits);
  const std::array<ValidatedMaterial, 1> validated{{{"fit", &validation}}};
  html += fit_section(fit) + curves_section(measured, fit.material) + slices_section(measured, fit.material) +
          spheres_section(measured, fit.material) + validation_section(validated);
  html += "<section id=origin><h2>Origin</h2>\n<p><code>" + escape_xml(report.command) +
          "</code></p>\n<p class=soft>Nacre " + escape_xml(report.version) + ".</p></section>\n";
  return html_page(report.title + ": fit", html);
}

std::string write_fit_report(const FitReport& report, const std::string& path) {
  if (path.ends_with(".html")) {
    write_file_atomically(path, fit_report_html(report));
    return path;
  }
  OutputFolder folder(path);
  folder.add("fit.json", [&](const std::string& file) {
    write_file_atomically(file, to_json(report.fits.front()).dump(2) + "\n");
  });
  const std::string page = folder.add(
      "report.html", [&](const std::string& file) { write_file_atomically(file, fit_report_html(report)); });
  folder.keep();
  return page;
}

} // namespace nacre
