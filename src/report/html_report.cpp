#include "report/html_report.h"

#include "display/colormap.h"

#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

// Colours of the page and of the plots in it; the plots' own attributes are those of the light theme.
constexpr const char* style = R"(
:root{color-scheme:light dark;--page:#fbfbfa;--card:#ffffff;--ink:#1d1f21;--soft:#5d6166;--line:#dcdee0;
--good:#00704f;--bad:#b54a00;--accent:#0062a3}
@media(prefers-color-scheme:dark){:root{--page:#15171a;--card:#1d2024;--ink:#e6e7e8;--soft:#a0a5ab;
--line:#363b41;--good:#3ccf9f;--bad:#ff9a52;--accent:#6cb8f0}
.plot-background{fill:#1d2024}.plot-text{fill:#dfe1e3}.plot-grid{stroke:#343940}.plot-axis{stroke:#7a8087}
.series-0{--c:#4aa8e0}.series-1{--c:#ff8a3d}.series-2{--c:#2cc295}.series-3{--c:#e39ac4}.series-4{--c:#f0b429}
.series-5{--c:#8ccdf5}.series-6{--c:#e6e7e8}
g[class^=series]{fill:var(--c)}path[class^=series]{stroke:var(--c)}}
*{box-sizing:border-box}
body{margin:0;background:var(--page);color:var(--ink);font:16px/1.5 system-ui,sans-serif}
main{max-width:1240px;margin:0 auto;padding:32px 24px 64px}
h1{font-size:30px;line-height:1.2;margin:0 0 4px}h2{font-size:21px;margin:44px 0 8px}
h3{font-size:16px;margin:20px 0 6px}
p{max-width:80ch;margin:8px 0}.soft{color:var(--soft)}
code{font:13.5px ui-monospace,monospace;overflow-wrap:anywhere}
.grid{display:grid;gap:16px;grid-template-columns:repeat(auto-fit,minmax(min(100%,370px),1fr))}
.plots{display:grid;gap:16px;grid-template-columns:repeat(auto-fit,minmax(min(100%,480px),1fr))}
figure{margin:0;background:var(--card);border:1px solid var(--line);border-radius:8px;overflow:hidden}
figure img{display:block;width:100%;height:auto}figure svg.plot{display:block;width:100%;height:auto}
figcaption{padding:8px 12px;font-size:14px;color:var(--soft)}figcaption b{color:var(--ink)}
.facts{display:grid;gap:12px;grid-template-columns:repeat(auto-fit,minmax(170px,1fr));margin:20px 0}
.fact{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:10px 14px}
.fact b{display:block;font-size:22px;font-variant-numeric:tabular-nums}.fact>span{font-size:13.5px;color:var(--soft)}
.scroll{overflow-x:auto;background:var(--card);border:1px solid var(--line);border-radius:8px}
table{border-collapse:collapse;width:100%;font-size:14.5px;font-variant-numeric:tabular-nums}
th,td{text-align:left;padding:6px 12px;border-bottom:1px solid var(--line);vertical-align:top}
tr:last-child td{border-bottom:0}th{font-weight:600;color:var(--soft);font-size:13px}
.key,.errors td:first-child{white-space:nowrap}
td{overflow-wrap:anywhere}td.n,.step,td:first-child{overflow-wrap:normal}.step{white-space:nowrap}
td.n,th.n{text-align:right;white-space:nowrap}
.holds{color:var(--good);white-space:nowrap}.violated{color:var(--bad);font-weight:600;white-space:nowrap}
.bar{display:inline-block;height:9px;border-radius:3px;background:var(--accent);vertical-align:middle}
.ramp{display:inline-block;width:120px;height:10px;border-radius:3px;vertical-align:middle;margin:0 6px}
.wipe{position:relative;--x:50%}.wipe .over{position:absolute;inset:0;clip-path:inset(0 0 0 var(--x))}
.wipe::after{content:'';position:absolute;top:0;bottom:0;left:var(--x);width:2px;margin-left:-1px;
background:#fff;box-shadow:0 0 3px #000}
.wipe input{position:absolute;inset:0;width:100%;height:100%;opacity:0;cursor:ew-resize;margin:0;z-index:1}
@media print{body{background:#fff}figure,.scroll,.fact{break-inside:avoid}}
)";

std::string number(double v, int digits = 4) {
  if (std::isnan(v)) return "–";
  if (std::isinf(v)) return v > 0 ? "∞" : "−∞";
  std::string text = fmt::format("{:.{}g}", v, digits);
  // 1.2e-05 as 1.2·10⁻⁵ would be nicer to read and worse to copy; only the sign is made typographic.
  if (text[0] == '-') text.replace(0, 1, "−");
  return text;
}

std::string hex(const std::array<float, 3>& code) {
  const auto byte = [](float v) { return static_cast<int>(std::lround(255 * v)); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(code[0]), byte(code[1]), byte(code[2]));
}

template <class Colour>
std::string ramp(Colour colour, double lo, double hi) {
  std::string stops;
  for (int i = 0; i <= 8; ++i)
    stops.append(1, ',').append(hex(colour(lo + (hi - lo) * i / 8)));
  return fmt::format("<span class=ramp style='background:linear-gradient(90deg{})'></span>", stops);
}

std::string image(const Image& picture, const std::string& description) {
  return fmt::format("<img width='{}' height='{}' alt='{}' src='{}'>", picture.width, picture.height,
                     escape_xml(description), png_data_url(picture));
}

std::string figure(const std::string& content, const std::string& caption) {
  return "<figure>" + content + "<figcaption>" + caption + "</figcaption></figure>\n";
}

std::string fact(const std::string& value, const std::string& meaning) {
  return "<div class=fact><b>" + value + "</b><span>" + meaning + "</span></div>\n";
}

int violations(const ValidationReport& report) {
  int n = 0;
  for (const LawResult& law : report.laws)
    n += law.verdict == Verdict::violated;
  return n;
}

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
  const bool holds = law->verdict == Verdict::holds;
  return fmt::format("<td class=n>{}{}<td class=n>{}<td class={}>{}", number(law->worst, 3),
                     law->error > 0 ? " ± " + number(law->error, 1) : "", number(law->tolerance, 2),
                     holds ? "holds" : "violated", holds ? "✓ holds" : "✗ violated");
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
  std::string html = "<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8>\n<meta name=viewport "
                     "content='width=device-width,initial-scale=1'>\n<title>" +
                     title + ": measured and fitted</title>\n<style>" + style +
                     "</style></head><body><main>\n";
  html += "<header><h1>" + title + "</h1>\n<p class=soft>" + escape_xml(f.source) + " Fitted with <code>" +
          escape_xml([&] {
            std::string models;
            for (const LobeSpec& lobe : f.fit->material.lobes)
              models +=
                  (models.empty() ? "" : " + ") + model_infos()[static_cast<std::size_t>(lobe.model)].name;
            return models;
          }()) +
          "</code>.</p></header>\n<div class=facts>\n";
  const auto verdict = [](const ValidationReport& report) {
    const int n = violations(report);
    return n == 0 ? std::string("<span class=holds>✓ holds</span>")
                  : fmt::format("<span class=violated>✗ {} violated</span>", n);
  };
  html += fact(number(f.pictures->flip_mean, 3), "FLIP between the renders, mean; 0 is equal");
  html += fact(number(f.fit->errors.log, 3), "error of the fit, log metric");
  html += fact(verdict(*f.measured_validation), "laws of reflectance, measured");
  html += fact(verdict(*f.fit_validation), "laws of reflectance, fit");
  html += "</div>\n";
  html += pictures_section(f) + plots_section(f) + fit_section(f) + validation_section(f) + time_section(f);
  html += "<section id=origin><h2>Origin</h2>\n<p><code>" + escape_xml(f.command) +
          "</code></p>\n<p class=soft>Nacre " + escape_xml(f.version) +
          ". The folder of this page also holds the renders as linear EXR, the "
          "pictures side by side, and the fit as JSON, which Nacre reads as a "
          "material.</p></section>\n";
  return html + "</main></body></html>\n";
}

} // namespace nacre
