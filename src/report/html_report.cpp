#include "report/html_report.h"

#include "display/colormap.h"
#include "report/fit_sections.h"
#include "report/html_page.h"

#include <fmt/format.h>

namespace nacre {
namespace {

std::string pictures_section(const DemoFindings& f) {
  const ComparedPictures& p = *f.pictures;
  std::string html = "<section id=pictures><h2>Renders</h2>\n<div class=grid>\n";
  html += html_figure(html_image(p.reference, "Render with the measured material"), "<b>Measured</b>");
  html += html_figure(html_image(p.picture, "Render with the fitted model"), "<b>Fit</b>");
  html += html_figure(html_wipe(p.reference, p.picture, "Measured", "Fit"),
                      "<b>Measured | fit</b>, drag across the picture");
  html += html_figure(html_image(p.flip, "FLIP difference of the two renders"),
                      "<b>Difference a viewer sees</b>, FLIP <span class=key>0" +
                          html_ramp([](double v) { return error_colour(static_cast<float>(v)); }, 0, 1) +
                          "1</span>");
  html += html_figure(
      html_image(p.signed_luminance, "Signed luminance difference of the two renders"),
      fmt::format("<b>Fit − measured</b>, luminance on the display: <span class=key>darker −{0:g}{1}+{0:g} "
                  "brighter</span>",
                  p.signed_range, html_ramp(signed_colour, -1, 1)));
  html += "<div class='scroll errors'><table><tr><th>image error<th class=n>value<th>\n";
  html += "<tr><td>RMSE<td class=n>" + html_number(p.rmse) +
          "<td>root mean square over pixels and channels, linear sRGB after exposure\n";
  html += "<tr><td>FLIP<td class=n>" + html_number(p.flip_mean) +
          "<td>mean, of the pictures as displayed; 0 is equal, 1 the largest\n";
  html += "<tr><td>HDR-FLIP<td class=n>" + html_number(p.hdr_flip_mean) +
          "<td>mean of the largest FLIP at any useful exposure\n</table></div>\n</div>\n";
  html += fmt::format(
      "<p class=soft>{} × {} pixels, {} paths a pixel, the same random numbers in both; lit by "
      "{}. Both are shown at {} stops through one film curve (Narkowicz 2015). FLIP: "
      "Andersson et al. 2020, 2021.</p></section>\n",
      f.width, f.height, f.samples_per_pixel, escape_xml(f.environment), html_number(p.exposure_stops, 3));
  return html;
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

std::string html_report(const DemoFindings& f) {
  std::string html = "<header><h1>" + escape_xml(f.material) + "</h1>\n<p class=soft>" +
                     escape_xml(f.source) + " Fitted with <code>" + escape_xml(model_names(f.fit->material)) +
                     "</code>.</p></header>\n<div class=facts>\n";
  html += html_fact(html_number(f.pictures->flip_mean, 3), "FLIP between the renders, mean; 0 is equal");
  html += html_fact(html_number(f.fit->errors.log, 3), "error of the fit, log metric");
  html += html_fact(html_verdict(*f.measured_validation), "laws of reflectance, measured");
  html += html_fact(html_verdict(*f.fit_validation), "laws of reflectance, fit");
  html += "</div>\n";
  const std::array<ValidatedMaterial, 2> validated{
      {{"measured", f.measured_validation}, {"fit", f.fit_validation}}};
  html += pictures_section(f) + plots_section(f.plots) + fit_section(*f.fit) + validation_section(validated) +
          time_section(f);
  html += "<section id=origin><h2>Origin</h2>\n<p><code>" + escape_xml(f.command) +
          "</code></p>\n<p class=soft>Nacre " + escape_xml(f.version) +
          ". The folder of this page also holds the renders as linear EXR, the "
          "pictures side by side, and the fit as JSON, which Nacre reads as a "
          "material.</p></section>\n";
  return html_page(f.material + ": measured and fitted", html);
}

} // namespace nacre
