#include "report/validation_page.h"

#include "core/parallel.h"
#include "core/version.h"
#include "core/warp.h"
#include "display/colormap.h"
#include "report/fit_sections.h"
#include "report/html_page.h"

#include "report/material_plots.h"
#include "report/pictures.h"
#include "validate/laws.h"
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

constexpr int cells = 90;           // a side of a map
constexpr double decades = 6;       // of f below its largest value
constexpr double least_log10 = -12; // of a departure from reciprocity
constexpr std::array<float, 3> not_finite{0.0f, 0.85f, 1.0f}, negative{0.1f, 0.9f, 0.3f};

struct Azimuth {
  double phi_deg;
  const char* side;
};
constexpr std::array<Azimuth, 3> azimuths{{{180, "light opposite the viewer, φ = 180°"},
                                           {90, "light across, φ = 90°"},
                                           {0, "light on the viewer's side, φ = 0°"}}};

/// What is mapped: a value a cell, theta_o to the right, theta_i upwards, row 0 on top.
using Cells = std::vector<double>;

struct Maps {
  std::array<Cells, 3> f; ///< luminance, an azimuth each
  Cells departure;        ///< the largest of the azimuths and channels
  double end_deg;         ///< of both axes
  double largest = 0;     ///< finite f
};

/// Angles at the middle of cells, so that the normal and the horizon are missed by half a cell.
Maps maps_of(const Scattering& bsdf, const Sides& sides) {
  Maps maps{{}, Cells(cells * cells), sides.transmits ? 180.0 : 90.0, 0};
  for (Cells& f : maps.f)
    f.resize(cells * cells);
  parallel_for(cells, [&](std::size_t row) {
    for (std::size_t column = 0; column < cells; ++column) {
      const auto angle = [&](std::size_t i) { return (double(i) + 0.5) / cells * maps.end_deg * pi / 180; };
      const Vec3d wo = spherical_direction(angle(column), 0.0);
      const std::size_t cell = row * cells + column;
      for (std::size_t a = 0; a < azimuths.size(); ++a) {
        const Vec3d wi = spherical_direction(angle(cells - 1 - row), azimuths[a].phi_deg * pi / 180);
        const Rgb f = bsdf.eval(wo, wi);
        maps.f[a][cell] = luminance(f.c);
        maps.departure[cell] = std::max(maps.departure[cell], reciprocity_departure(bsdf, sides, wo, wi));
      }
    }
  });
  for (const Cells& f : maps.f)
    for (const double v : f)
      if (std::isfinite(v)) maps.largest = std::max(maps.largest, v);
  return maps;
}

/// A map with its axes; `colour` gives the code of a value.
template <class Colour>
std::string map_element(const Cells& values, double end_deg, const std::string& title, Colour colour) {
  Image picture(cells, cells, {"R", "G", "B"});
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto code = colour(values[i]);
    std::copy(code.begin(), code.end(), picture.data.begin() + long(3 * i));
  }
  constexpr double left = 46, top = 8, side = 300;
  std::string svg = fmt::format(
      "<svg class=plot viewBox='0 0 366 362' font-family='system-ui,sans-serif' font-size='12' role=img "
      "aria-label='{}'><image x='{}' y='{}' width='{}' height='{}' preserveAspectRatio='none' "
      "style='image-rendering:pixelated' href='{}'/>",
      title, left, top, side, side, png_data_url(picture));
  for (int tick = 0; tick <= 6; ++tick) {
    const double at = side * tick / 6, degrees = end_deg * tick / 6;
    svg += fmt::format("<text class=plot-text x='{:g}' y='{:g}' text-anchor='middle'>{:g}</text>"
                       "<text class=plot-text x='{:g}' y='{:g}' text-anchor='end'>{:g}</text>",
                       left + at, top + side + 16, degrees, left - 6, top + side - at + 4, degrees);
  }
  svg += fmt::format(
      "<text class=plot-text x='{0:g}' y='{1:g}' text-anchor='middle'>θo / degrees</text>"
      "<text class=plot-text text-anchor='middle' transform='translate(12 {2:g}) rotate(-90)'>θi / "
      "degrees</text></svg>",
      left + side / 2, top + side + 36, top + side / 2);
  return svg;
}

std::string swatch(const std::array<float, 3>& code) {
  return fmt::format("<span class=ramp style='width:14px;background:{}'></span>", html_colour(code));
}

std::string maps_section(const MaterialSpec& material) {
  const Scattering bsdf = Scattering::of(material);
  const Maps maps = maps_of(bsdf, Sides::of(material));
  std::string html = "<section id=maps><h2>Over θi and θo</h2>\n";
  html += "<p class=soft>Angles to the normal; φ is the azimuth from viewer to light.";
  if (maps.end_deg > 90) html += " Beyond 90° a direction lies below the surface.";
  html += " What a smooth surface sends into one direction is no value in 1/sr and does not show.</p>\n";
  html += "<div class=grid>\n";
  const auto f_colour = [&](double v) {
    if (!std::isfinite(v)) return not_finite;
    if (v < 0) return negative;
    const double log10 = v > 0 ? std::log10(v / maps.largest) : -decades;
    return error_colour(float(1 + log10 / decades));
  };
  for (std::size_t a = 0; a < azimuths.size(); ++a)
    html += html_figure(map_element(maps.f[a], maps.end_deg, "f over both angles", f_colour),
                        fmt::format("<b>f</b>, {}", azimuths[a].side));
  const auto departure_colour = [](double v) {
    if (!std::isfinite(v)) return not_finite;
    return error_colour(float(1 - std::log10(std::max(v, 1e-300)) / least_log10));
  };
  html +=
      html_figure(map_element(maps.departure, maps.end_deg, "departure from reciprocity", departure_colour),
                  "<b>|f(o, i) − f(i, o)| / mean</b>, the largest of the three azimuths and channels");
  html += "</div>\n";
  html += fmt::format(
      "<p class=soft>f, luminance in 1/sr: <span class=key>{}{}{}</span>, logarithmic; {} not a number or "
      "infinite, {} negative. Reciprocity: <span class=key>10<sup>{}</sup>{}1</span>, logarithmic{}.</p>\n",
      html_number(maps.largest * std::pow(10, -decades), 2),
      html_ramp([](double v) { return error_colour(float(v)); }, 0, 1), html_number(maps.largest, 3),
      swatch(not_finite), swatch(negative), least_log10,
      html_ramp([](double v) { return error_colour(float(v)); }, 0, 1),
      bsdf.stochastic ? "; this model's value is an estimate, and what shows is its noise" : "");
  return html + "</section>\n";
}

std::string laws_section(const ValidationReport& report) {
  std::string html = "<section id=laws><h2>Laws</h2>\n<div class=scroll><table><tr><th>law<th>departure"
                     "<th class=n>worst<th class=n>tolerance<th>verdict<th>where\n";
  for (const LawResult& law : report.laws)
    html +=
        fmt::format("<tr><td>{}<td>{}<td class=n>{}{}<td class=n>{}<td class={}>{}<td>{}\n",
                    escape_xml(law.law), escape_xml(law.measures), html_number(law.worst, 4),
                    law.error > 0 ? " ± " + html_number(law.error, 1) : "",
                    law.verdict == Verdict::stated ? "–" : html_number(law.tolerance, 3),
                    verdict_mark(law.verdict).first, verdict_mark(law.verdict).second, escape_xml(law.where));
  html += "</table></div>\n";
  std::string findings;
  for (const LawResult& law : report.laws)
    if (law.verdict == Verdict::violated && !law.command.empty())
      findings += "<li>" + escape_xml(law.law) + ": <code>" + escape_xml(law.command) + "</code></li>\n";
  if (!findings.empty()) html += "<h3>To see it again</h3><ul>\n" + findings + "</ul>\n";
  return html + "</section>\n";
}

std::string albedo_section(const MaterialSpec& material, const ValidationReport& report) {
  const PlottedMaterial plotted{&material, material.name, false};
  std::string html = "<section id=albedo><h2>Albedo</h2>\n<div class=plots>\n<figure>" +
                     svg_element(albedo_plot({&plotted, 1})) + "</figure>\n";
  html +=
      "<div class=scroll><table><tr><th class=n>θ / degrees<th class=n>red<th class=n>green<th class=n>blue"
      "<th class=n>error\n";
  for (const AlbedoSample& a : report.albedo)
    html += fmt::format(
        "<tr><td class=n>{:g}<td class=n>{:.4f}<td class=n>{:.4f}<td class=n>{:.4f}<td class=n>{}\n",
        a.theta_deg, a.albedo[0], a.albedo[1], a.albedo[2], html_number(a.error, 1));
  const auto& b = report.bihemispherical;
  html += fmt::format(
      "<tr><td class=n>all<td class=n>{:.4f}<td class=n>{:.4f}<td class=n>{:.4f}<td class=n>{}\n", b[0], b[1],
      b[2],
      html_number(*std::max_element(report.bihemispherical_error.begin(), report.bihemispherical_error.end()),
                  1));
  return html +
         "</table></div></div>\n<p class=soft>The share of the light arriving at an angle that leaves "
         "again: the curves by sampling, the table by quadrature with its error; \"all\" is of uniform "
         "diffuse light (bihemispherical).</p></section>\n";
}

} // namespace

std::string validation_page(const MaterialSpec& material, const ValidationReport& report) {
  std::string html;
  html += "<header><h1>" + escape_xml(report.material) +
          "</h1>\n<p class=soft>Judged by the laws of reflectance.</p></header>\n<div class=facts>\n";
  html += html_fact(html_verdict(report), fmt::format("{} laws measured", report.laws.size()));
  const auto largest = [](const std::array<double, 3>& rgb) {
    return *std::max_element(rgb.begin(), rgb.end());
  };
  double albedo = 0;
  for (const AlbedoSample& a : report.albedo)
    albedo = std::max(albedo, largest(a.albedo));
  html += html_fact(html_number(albedo, 4), "largest directional albedo");
  html += html_fact(html_number(largest(report.bihemispherical), 4), "largest bihemispherical albedo");
  html += "</div>\n" + laws_section(report) + albedo_section(material, report) + maps_section(material);
  html += fmt::format("<section id=origin><p class=soft>Nacre {}; {:.1f} s. What each law says and how it is "
                      "measured: docs/validate.md.</p></section>\n",
                      escape_xml(version()), report.seconds);
  return html_page(report.material + ": the laws of reflectance", html);
}

} // namespace nacre
