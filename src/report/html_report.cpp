#include "report/html_report.h"

#include "display/colormap.h"
#include "report/html_page.h"

#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

std::string pictures_section(const DemoFindings& f) {
  const ComparedPictures& p = *f.pictures;
  std::string html = "<section id=pictures><h2>Renders</h2>\n<div class=grid>\n";
  html += figure(image(p.reference, "Render with the measured material"), "<b>Measured</b>");
  html += figure(image(p.picture, "Render with the fitted model"), "<b>Fit</b>");
  html += figure("<div class=wipe>" + image(p.reference, "Measured") +
                     fmt::format("<img class=over alt='Fit' src='{}'>", png_data_url(p.picture)) +
                     "<input type=range min=0 max=100 step=0.2 value=50 aria-label='Where the fit begins' "
                     "oninput=\"this.parentNode.style.setProperty('--x',this.value+'%')\"></div>",
                 "<b>Measured | fit</b>, drag across the picture");
  html += figure(image(p.flip, "FLIP difference of the two renders"),
                 "<b>Difference a viewer sees</b>, FLIP <span class=key>0" +
                     ramp([](double v) { return error_colour(static_cast<float>(v)); }, 0, 1) + "1</span>");
  html += figure(
      image(p.signed_luminance, "Signed luminance difference of the two renders"),
      fmt::format("<b>Fit − measured</b>, luminance on the display: <span class=key>darker −{0:g}{1}+{0:g} "
                  "brighter</span>",
                  p.signed_range, ramp(signed_colour, -1, 1)));
  html += "<div class='scroll errors'><table><tr><th>image error<th class=n>value<th>\n";
  html += "<tr><td>RMSE<td class=n>" + number(p.rmse) +
          "<td>root mean square over pixels and channels, linear sRGB after exposure\n";
  html += "<tr><td>FLIP<td class=n>" + number(p.flip_mean) +
          "<td>mean, of the pictures as displayed; 0 is equal, 1 the largest\n";
  html += "<tr><td>HDR-FLIP<td class=n>" + number(p.hdr_flip_mean) +
          "<td>mean of the largest FLIP at any useful exposure\n</table></div>\n</div>\n";
  html += fmt::format(
      "<p class=soft>{} × {} pixels, {} paths a pixel, the same random numbers in both; lit by "
      "{}. Both are shown at {} stops through one film curve (Narkowicz 2015). FLIP: "
      "Andersson et al. 2020, 2021.</p></section>\n",
      f.width, f.height, f.samples_per_pixel, escape_xml(f.environment), number(p.exposure_stops, 3));
  return html;
}

std::string plots_section(const DemoFindings& f) {
  std::string html =
      "<section id=plots><h2>Measured against fit</h2>\n<p class=soft>f is the reflectance distribution in "
      "1/sr, without the cosine; θo and θi are angles to the normal of viewer and light, θh that of the half "
      "vector, θd the angle between half vector and light.</p>\n<div class=plots>\n";
  for (const Plot& plot : f.plots)
    html += "<figure>" + svg_element(plot) + "</figure>\n";
  return html + "</div></section>\n";
}

std::string remarks(const FittedParameter& p) {
  std::vector<std::string> notes;
  if (p.at_bound) notes.push_back("at the end of its domain: the error bar says nothing");
  if (!p.identifiable)
    notes.push_back(p.partner.empty() ? "not determined by the data"
                                      : "not determined by the data; trades off against " + p.partner);
  else if (!p.partner.empty() && std::abs(p.correlation) > 0.9)
    notes.push_back(fmt::format("correlated with {} ({:.2f})", p.partner, p.correlation));
  if (!p.tied.empty()) notes.push_back("the same number as " + p.tied);
  std::string text;
  for (const std::string& n : notes)
    text += (text.empty() ? "" : "; ") + escape_xml(n);
  return text;
}

std::string fit_section(const DemoFindings& f) {
  const FitResult& fit = *f.fit;
  std::string html = "<section id=fit><h2>Fit</h2>\n";
  html += "<p><code>" + escape_xml(readable_text(fit.material)) + "</code></p>\n";
  html += "<div class=scroll><table><tr><th>parameter<th class=n>value<th class=n>standard error<th>domain"
          "<th>unit<th>remarks\n";
  for (const FittedParameter& p : fit.parameters)
    html += fmt::format("<tr><td>{}<td class=n>{}<td class=n>{}<td>[{:g}, {:g}]<td>{}<td>{}\n",
                        escape_xml(p.label), number(p.value, 5),
                        std::isfinite(p.standard_error) ? "± " + number(p.standard_error, 2) : "–", p.lo,
                        p.hi, p.unit == "1" ? "none" : escape_xml(p.unit), remarks(p));
  html += "</table></div>\n";
  html += "<h3>Error of the fit</h3><div class=scroll><table><tr><th>metric<th class=n>measured against fit"
          "<th>unit<th>meaning\n";
  html +=
      fmt::format("<tr><td>log{}<td class=n>{}<td>none<td>root mean square of the difference in log(1 + f "
                  "cos θi): peak, tail and diffuse part all count\n",
                  fit.metric == Metric::log ? ", minimised" : "", number(fit.errors.log));
  html += fmt::format("<tr><td>cosine{}<td class=n>{}<td>1/sr<td>root mean square of the difference in f cos "
                      "θi: decided by the peak (Ngan et al. 2005)\n</table></div>\n",
                      fit.metric == Metric::cosine ? ", minimised" : "", number(fit.errors.cosine));
  html += fmt::format("<p class=soft>Over {} entries of the table with both angles below {:g}°. Levenberg-"
                      "Marquardt from {} starts, the best after {} iterations: {}. Standard errors allow for "
                      "noise that differs from entry to entry (White 1980); they measure scatter about this "
                      "model, not whether the model is the right one.</p></section>\n",
                      fit.errors.nodes, fit.max_theta_deg, fit.starts.size(), fit.iterations,
                      fit.converged ? "converged" : "not converged (" + escape_xml(fit.message) + ")");
  return html;
}

/// What one material did about one law: three cells.
std::string law_cells(const LawResult* law) {
  if (!law) return "<td class=n>–<td class=n>–<td>–";
  return fmt::format("<td class=n>{}{}<td class=n>{}<td class={}>{}", number(law->worst, 3),
                     law->error > 0 ? " ± " + number(law->error, 1) : "",
                     law->verdict == Verdict::stated ? "–" : number(law->tolerance, 2),
                     verdict_class(law->verdict), verdict_text(law->verdict));
}

std::string validation_section(const DemoFindings& f) {
  const ValidationReport &measured = *f.measured_validation, &fit = *f.fit_validation;
  std::string html =
      "<section id=validation><h2>Validation</h2>\n<p class=soft>The laws that every reflectance obeys, and "
      "those of the chances with which Nacre picks directions from it: the largest departure found, and up "
      "to "
      "where it is taken to hold. A measurement may break one; that is a finding about the measurement.</p>\n"
      "<div class=scroll><table>"
      "<tr><th rowspan=2>law<th rowspan=2>departure<th colspan=3>measured<th colspan=3>fit\n"
      "<tr><th class=n>worst<th class=n>tolerance<th>verdict<th class=n>worst<th class=n>"
      "tolerance<th>verdict\n";
  const auto find = [](const ValidationReport& report, const std::string& law) -> const LawResult* {
    for (const LawResult& l : report.laws)
      if (l.law == law) return &l;
    return nullptr;
  };
  for (const LawResult& law : measured.laws)
    html += fmt::format("<tr><td>{}<td>{}{}{}\n", escape_xml(law.law), escape_xml(law.measures),
                        law_cells(&law), law_cells(find(fit, law.law)));
  for (const LawResult& law : fit.laws)
    if (!find(measured, law.law))
      html += fmt::format("<tr><td>{}<td>{}{}{}\n", escape_xml(law.law), escape_xml(law.measures),
                          law_cells(nullptr), law_cells(&law));
  html += "</table></div>\n";
  std::string findings;
  for (const auto& [name, report] : {std::pair{"The measured material", &measured}, {"The fit", &fit}})
    for (const LawResult& law : report->laws)
      if (law.verdict == Verdict::violated)
        findings += fmt::format(
            "<li>{}: {} is violated{}{}.{}</li>\n", name, escape_xml(law.law),
            law.where.empty() ? "" : " at ", escape_xml(law.where),
            law.command.empty() ? "" : " Seen again with <code>" + escape_xml(law.command) + "</code>");
  html += findings.empty() ? "<p class=holds>✓ Both obey every law that was tested.</p>\n"
                           : "<h3>Findings</h3><ul>\n" + findings + "</ul>\n";
  return html + "</section>\n";
}

std::string time_section(const DemoFindings& f) {
  double total = 0, longest = 1e-9;
  for (const DemoStep& s : f.steps)
    total += s.seconds, longest = std::max(longest, s.seconds);
  std::string html = "<section id=time><h2>Time</h2>\n<div class=scroll><table><tr><th>step<th>result<th "
                     "class=n>seconds<th>\n";
  for (const DemoStep& s : f.steps)
    html += fmt::format(
        "<tr><td class=step>{}<td>{}<td class=n>{:.2f}<td><span class=bar style='width:{:.0f}px'></span>\n",
        escape_xml(s.name), escape_xml(s.what), s.seconds, 1 + 160 * s.seconds / longest);
  return html + fmt::format("<tr><td><b>all</b><td><td class=n><b>{:.2f}</b><td>\n</table></div></section>\n",
                            total);
}

} // namespace

std::string readable_text(MaterialSpec material) {
  for (LobeSpec& lobe : material.lobes)
    for (auto& value : lobe.values)
      for (double& v : value)
        v = std::stod(fmt::format("{:.4g}", v));
  return to_text(material);
}

std::string html_report(const DemoFindings& f) {
  const std::string title = escape_xml(f.material);
  std::string html = page_head(f.material + ": measured and fitted");
  html += "<header><h1>" + title + "</h1>\n<p class=soft>" + escape_xml(f.source) + " Fitted with <code>" +
          escape_xml([&] {
            std::string models;
            for (const LobeSpec& lobe : f.fit->material.lobes)
              models +=
                  (models.empty() ? "" : " + ") + model_infos()[static_cast<std::size_t>(lobe.model)].name;
            return models;
          }()) +
          "</code>.</p></header>\n<div class=facts>\n";
  html += fact(number(f.pictures->flip_mean, 3), "FLIP between the renders, mean; 0 is equal");
  html += fact(number(f.fit->errors.log, 3), "error of the fit, log metric");
  html += fact(verdict_fact(*f.measured_validation), "laws of reflectance, measured");
  html += fact(verdict_fact(*f.fit_validation), "laws of reflectance, fit");
  html += "</div>\n";
  html += pictures_section(f) + plots_section(f) + fit_section(f) + validation_section(f) + time_section(f);
  html += "<section id=origin><h2>Origin</h2>\n<p><code>" + escape_xml(f.command) +
          "</code></p>\n<p class=soft>Nacre " + escape_xml(f.version) +
          ". The folder of this page also holds the renders as linear EXR, the "
          "pictures side by side, and the fit as JSON, which Nacre reads as a "
          "material.</p></section>\n";
  return html + page_foot();
}

} // namespace nacre
