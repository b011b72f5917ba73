#include "report/fit_sections.h"

#include "report/html_page.h"

#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

std::string remarks(const FittedParameter& p) {
  std::vector<std::string> notes;
  if (p.at_bound) notes.push_back("at the end of its domain: the error bar says nothing");
  if (!p.identifiable)
    notes.push_back(p.partner.empty() ? "not determined by the data"
                                      : "not determined by the data; trades off against " + p.partner);
  if (!p.tied.empty()) notes.push_back("the same number as " + p.tied);
  std::string text;
  for (const std::string& n : notes)
    text += (text.empty() ? "" : "; ") + escape_xml(n);
  return text;
}

/// The parameter it moves most with, and how much: strongly where the two can stand in for each other.
std::string correlation(const FittedParameter& p) {
  if (p.partner.empty() || p.at_bound || !p.identifiable) return "–";
  const std::string text = escape_xml(p.partner) + ", " + html_number(p.correlation, 2);
  return std::abs(p.correlation) > 0.9 ? "<b>" + text + "</b>" : text;
}

/// Correlations of the parameters that move, as a table in which strong ones are dark.
std::string correlation_matrix(const FitResult& fit) {
  std::vector<std::size_t> moving;
  for (std::size_t k = 0; k < fit.parameters.size(); ++k)
    if (fit.parameters[k].covariance[k] > 0) moving.push_back(k);
  if (moving.size() < 2) return "";
  std::string html = "<h3>Correlations of the standard errors</h3><div class=scroll><table><tr><th>";
  for (const std::size_t k : moving)
    html += "<th class=n>" + escape_xml(fit.parameters[k].label);
  for (const std::size_t k : moving) {
    const FittedParameter& p = fit.parameters[k];
    html += "\n<tr><td>" + escape_xml(p.label);
    for (const std::size_t j : moving) {
      const double r = p.covariance[j] / std::sqrt(p.covariance[k] * fit.parameters[j].covariance[j]);
      html += fmt::format("<td class=n style='background:rgba({},{:.2f})'>{:.2f}",
                          r > 0 ? "200,60,40" : "40,90,200", j == k ? 0 : 0.6 * std::abs(r), r);
    }
  }
  return html + "</table></div>\n";
}

std::string_view metric_unit(Metric metric) {
  return metric == Metric::cosine ? "1/sr" : metric == Metric::cube_root ? "sr<sup>-1/3</sup>" : "none";
}

std::string_view metric_meaning(Metric metric) {
  switch (metric) {
  case Metric::cosine:
    return "f cos θi: decided by the peak (Ngan et al. 2005)";
  case Metric::log:
    return "log(1 + f cos θi): peak, tail and diffuse part all count (Löw et al. 2012)";
  case Metric::cube_root:
    return "the cube root of f cos θi, as lightness: the dim part counts most (Fores et al. 2012)";
  case Metric::relative:
    return "f cos θi, as a share of the measured value (Nielsen et al. 2015)";
  }
  return "";
}

/// What one material did about one law: three cells.
std::string law_cells(const LawResult* law) {
  if (!law) return "<td class=n>–<td class=n>–<td>–";
  const auto [kind, mark] = verdict_mark(law->verdict);
  return fmt::format("<td class=n>{}{}<td class=n>{}<td class={}>{}", html_number(law->worst, 3),
                     law->error > 0 ? " ± " + html_number(law->error, 1) : "",
                     law->verdict == Verdict::stated ? "–" : html_number(law->tolerance, 2), kind, mark);
}

int violations(const ValidationReport& report) {
  int n = 0;
  for (const LawResult& law : report.laws)
    n += law.verdict == Verdict::violated;
  return n;
}

} // namespace

std::string readable_text(MaterialSpec material) {
  for (LobeSpec& lobe : material.lobes)
    for (auto& value : lobe.values)
      for (double& v : value)
        v = std::stod(fmt::format("{:.4g}", v));
  return to_text(material);
}

std::string model_names(const MaterialSpec& material) {
  std::string names;
  for (const LobeSpec& lobe : material.lobes)
    names += (names.empty() ? "" : " + ") + model_info(lobe).name;
  return names;
}

std::string plots_section(const std::vector<Plot>& plots) {
  std::string html =
      "<section id=plots><h2>Measured against fit</h2>\n<p class=soft>f is the reflectance distribution in "
      "1/sr, without the cosine; θo and θi are angles to the normal of viewer and light, θh that of the half "
      "vector, θd the angle between half vector and light.</p>\n<div class=plots>\n";
  for (const Plot& plot : plots)
    html += "<figure>" + svg_element(plot) + "</figure>\n";
  return html + "</div></section>\n";
}

std::string fit_section(const FitResult& fit) {
  std::string html = "<section id=fit><h2>Fit</h2>\n";
  html += "<p><code>" + escape_xml(readable_text(fit.material)) + "</code></p>\n";
  html += fmt::format("<div class=scroll><table><tr><th>parameter<th class=n>value<th class=n>standard error"
                      "<th>holds the truth with {:g} %<th>domain<th>unit<th>moves most with, correlation"
                      "<th>remarks\n",
                      100 * fit.confidence);
  for (const FittedParameter& p : fit.parameters)
    html +=
        fmt::format("<tr><td>{}<td class=n>{}<td class=n>{}<td>[{}, {}]<td>[{:g}, {:g}]<td>{}<td>{}<td>{}\n",
                    escape_xml(p.label), html_number(p.value, 5),
                    std::isfinite(p.standard_error) ? "± " + html_number(p.standard_error, 2) : "–",
                    html_number(p.interval_lo, 4), html_number(p.interval_hi, 4), p.lo, p.hi,
                    p.unit == "1" ? "–" : escape_xml(p.unit), correlation(p), remarks(p));
  html += "</table></div>\n" + correlation_matrix(fit);
  html += "<h3>Error of the fit</h3><div class=scroll><table><tr><th>metric<th class=n>measured against fit"
          "<th>unit<th>meaning\n";
  for (const Metric metric : all_metrics)
    html += fmt::format("<tr><td>{}{}<td class=n>{}<td>{}<td>root mean square of the difference in {}\n",
                        metric_name(metric), fit.metric == metric ? ", minimised" : "",
                        html_number(fit.errors.of(metric)), metric_unit(metric), metric_meaning(metric));
  html += "</table></div>\n";
  html += fmt::format("<p class=soft>Over {} entries of the table with both angles below {:g}°. Levenberg-"
                      "Marquardt from {} starts, the best after {} iterations: {}. Standard errors allow for "
                      "noise that differs from entry to entry (White 1980); they measure scatter about this "
                      "model, not whether the model is the right one.</p></section>\n",
                      fit.errors.nodes, fit.max_theta_deg, fit.starts.size(), fit.iterations,
                      fit.converged ? "converged" : "not converged (" + escape_xml(fit.message) + ")");
  return html;
}

std::string ranking_section(std::span<const FitResult> fits) {
  double worst = 1e-30;
  for (const FitResult& f : fits)
    worst = std::max(worst, f.errors.of(f.metric));
  std::string html = "<section id=ranking><h2>Ranking</h2>\n<div class=scroll><table><tr><th class=n>rank"
                     "<th>model<th class=n>parameters";
  for (const Metric metric : all_metrics)
    html += fmt::format("<th class=n>{}", metric_name(metric));
  html += "<th>error in the metric that was made small<th class=n>seconds<th>optimum\n";
  int rank = 0;
  for (const FitResult& f : fits) {
    int reached = 0;
    for (const FitStart& start : f.starts)
      reached += start.coarse_error <= 1.001 * f.starts[static_cast<std::size_t>(f.best_start)].coarse_error;
    html += fmt::format("<tr><td class=n>{}<td>{}<td class=n>{}", ++rank, escape_xml(model_names(f.material)),
                        f.parameters.size());
    for (const Metric metric : all_metrics)
      html += "<td class=n>" + html_number(f.errors.of(metric));
    html += fmt::format("<td><span class=bar style='width:{:.0f}px'></span><td class=n>{:.2f}<td>{}\n",
                        1 + 220 * f.errors.of(f.metric) / worst, f.seconds,
                        f.converged ? fmt::format("reached from {} of {} starts", reached, f.starts.size())
                                    : "not converged");
  }
  return html + "</table></div>\n<p class=soft>Sections below describe the first of them.</p></section>\n";
}

std::string validation_section(std::span<const ValidatedMaterial> materials) {
  std::string html =
      "<section id=validation><h2>Validation</h2>\n<p class=soft>The laws that every reflectance obeys, and "
      "those of the chances with which Nacre picks directions from it: the largest departure found, and up "
      "to "
      "where it is taken to hold. A measurement may break one; that is a finding about the measurement.</p>\n"
      "<div class=scroll><table><tr><th rowspan=2>law<th rowspan=2>departure";
  for (const ValidatedMaterial& m : materials)
    html += "<th colspan=3>" + escape_xml(m.name);
  html += "\n<tr>";
  for (std::size_t i = 0; i < materials.size(); ++i)
    html += "<th class=n>worst<th class=n>tolerance<th>verdict";
  html += "\n";
  const auto find = [](const ValidationReport& report, const std::string& law) -> const LawResult* {
    for (const LawResult& l : report.laws)
      if (l.law == law) return &l;
    return nullptr;
  };
  for (std::size_t i = 0; i < materials.size(); ++i)
    for (const LawResult& law : materials[i].report->laws) {
      bool written = false;
      for (std::size_t j = 0; j < i; ++j)
        written |= find(*materials[j].report, law.law) != nullptr;
      if (written) continue;
      html += fmt::format("<tr><td>{}<td>{}", escape_xml(law.law), escape_xml(law.measures));
      for (const ValidatedMaterial& m : materials)
        html += law_cells(find(*m.report, law.law));
      html += "\n";
    }
  html += "</table></div>\n";
  std::string findings;
  for (const ValidatedMaterial& m : materials)
    for (const LawResult& law : m.report->laws)
      if (law.verdict == Verdict::violated)
        findings += fmt::format(
            "<li>{}: {} is violated{}{}.{}</li>\n", escape_xml(m.name), escape_xml(law.law),
            law.where.empty() ? "" : " at ", escape_xml(law.where),
            law.command.empty() ? "" : " Seen again with <code>" + escape_xml(law.command) + "</code>");
  html += findings.empty() ? "<p class=holds>✓ Every law that was tested is obeyed.</p>\n"
                           : "<h3>Findings</h3><ul>\n" + findings + "</ul>\n";
  return html + "</section>\n";
}

std::pair<const char*, const char*> verdict_mark(Verdict verdict) {
  return verdict == Verdict::holds      ? std::pair{"holds", "✓ holds"}
         : verdict == Verdict::violated ? std::pair{"violated", "✗ violated"}
                                        : std::pair{"soft", "stated"};
}

std::string html_verdict(const ValidationReport& report) {
  const int n = violations(report);
  return n == 0 ? "<span class=holds>✓ holds</span>"
                : fmt::format("<span class=violated>✗ {} violated</span>", n);
}

} // namespace nacre
