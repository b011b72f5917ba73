#include "report/study_report.h"

#include "core/error.h"
#include "core/version.h"
#include "report/html_page.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace nacre {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Of the finite numbers; NaN if there are none.
double median(std::vector<double> x) {
  std::erase_if(x, [](double v) { return !std::isfinite(v); });
  if (x.empty()) return nan;
  const std::size_t n = x.size();
  std::sort(x.begin(), x.end());
  return n % 2 ? x[n / 2] : (x[n / 2 - 1] + x[n / 2]) / 2;
}

std::string number(double x) { return std::isfinite(x) ? fmt::format("{:.4g}", x) : "-"; }

/// Best error of a material; infinite if no model has one.
double least(const std::vector<double>& row) {
  double best = std::numeric_limits<double>::infinity();
  for (const double e : row)
    if (e < best) best = e;
  return best;
}

std::vector<Study::Standing> standings_of(const Study& s) {
  std::vector<Study::Standing> standings(s.models.size());
  for (std::size_t m = 0; m < s.models.size(); ++m) {
    Study::Standing& standing = standings[m];
    std::vector<double> errors, over_best, seconds;
    double ranks = 0;
    for (std::size_t i = 0; i < s.materials.size(); ++i) {
      const double e = s.error[i][m], best = least(s.error[i]);
      if (!std::isfinite(e)) continue;
      errors.push_back(e);
      over_best.push_back(best > 0 ? e / best : 1);
      seconds.push_back(s.seconds[i][m]);
      ranks +=
          1 + double(std::count_if(s.error[i].begin(), s.error[i].end(), [&](double x) { return x < e; }));
      standing.wins += e == best;
      ++standing.fits;
    }
    standing.median = median(errors);
    standing.median_over_best = median(over_best);
    standing.median_seconds = median(seconds);
    standing.mean_rank = standing.fits ? ranks / standing.fits : nan;
  }
  return standings;
}

/// Rows and columns in the order of the indices.
void reorder(Study& s, const std::vector<std::size_t>& materials, const std::vector<std::size_t>& models) {
  Study t;
  t.metric = s.metric;
  for (const std::size_t i : materials) {
    t.materials.push_back(s.materials[i]);
    t.error.emplace_back();
    t.seconds.emplace_back();
    for (const std::size_t m : models) {
      t.error.back().push_back(s.error[i][m]);
      t.seconds.back().push_back(s.seconds[i][m]);
    }
  }
  for (const std::size_t m : models)
    t.models.push_back(s.models[m]);
  s = std::move(t);
}

std::vector<std::size_t> sorted_by(const std::vector<double>& key) {
  std::vector<std::size_t> order(key.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return !std::isnan(key[a]) && (std::isnan(key[b]) || key[a] < key[b]);
  });
  return order;
}

/// The models that a figure can tell apart: as many as there are colours.
std::size_t shown(const Study& s) { return std::min<std::size_t>(s.models.size(), 7); }

/// Share of materials whose number is at most x, at every number there is.
Series share_curve(const std::string& label, std::vector<double> x, std::size_t materials, int colour) {
  std::erase_if(x, [](double v) { return !std::isfinite(v); });
  std::sort(x.begin(), x.end());
  Series curve{label, {}, {}, false, colour};
  for (std::size_t i = 0; i < x.size(); ++i) {
    curve.x.insert(curve.x.end(), {x[i], x[i]});
    curve.y.insert(curve.y.end(),
                   {100.0 * double(i) / double(materials), 100.0 * double(i + 1) / double(materials)});
  }
  return curve;
}

} // namespace

Study make_study(const std::vector<StoredFit>& fits, const std::string& metric) {
  std::set<std::string> materials, models, metrics;
  const auto fitted_in = [&](const StoredFit& f) {
    const auto options = nlohmann::json::parse(f.key.options, nullptr, false);
    return options.is_object() ? options.value("metric", std::string()) : std::string();
  };
  for (const StoredFit& f : fits) {
    metrics.insert(fitted_in(f));
    if (fitted_in(f) != metric) continue;
    materials.insert(f.material);
    models.insert(f.key.model);
  }
  if (materials.empty())
    throw Error(fmt::format("the store holds no fit in the metric {}{}", metric,
                            suggestion(metric, std::vector<std::string>(metrics.begin(), metrics.end()))));
  Study s;
  s.metric = metric;
  s.materials.assign(materials.begin(), materials.end());
  s.models.assign(models.begin(), models.end());
  s.error.assign(s.materials.size(), std::vector<double>(s.models.size(), nan));
  s.seconds = s.error;
  const auto place = [](const std::vector<std::string>& names, const std::string& name) {
    return std::size_t(std::lower_bound(names.begin(), names.end(), name) - names.begin());
  };
  for (const StoredFit& f : fits) {
    if (fitted_in(f) != metric) continue;
    const std::size_t i = place(s.materials, f.material), m = place(s.models, f.key.model);
    const double e = f.error(metric);
    if (!std::isfinite(e) || e >= s.error[i][m]) continue; // fitted with several options: the best counts
    s.error[i][m] = e;
    s.seconds[i][m] = f.seconds;
  }
  std::vector<double> of_material, of_model;
  for (const auto& row : s.error)
    of_material.push_back(least(row));
  for (const Study::Standing& standing : standings_of(s))
    of_model.push_back(standing.median);
  reorder(s, sorted_by(of_material), sorted_by(of_model));
  s.standings = standings_of(s);
  return s;
}

Plot sorted_materials_plot(const Study& s, int by) {
  std::vector<double> key;
  for (const auto& row : s.error)
    key.push_back(row[std::size_t(by)]);
  Plot plot;
  plot.title = "Error of each material";
  plot.subtitle = fmt::format("materials in the order of {}", s.models[std::size_t(by)]);
  plot.x.label = "material";
  plot.y = {.label = s.metric + " error", .scale = Scale::logarithmic};
  const auto order = sorted_by(key);
  for (std::size_t m = 0; m < shown(s); ++m) {
    Series series{s.models[m], {}, {}, int(m) != by, int(m)};
    for (std::size_t i = 0; i < order.size(); ++i) {
      series.x.push_back(double(i + 1));
      series.y.push_back(s.error[order[i]][m]);
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

Plot cumulative_plot(const Study& s) {
  Plot plot;
  plot.title = "Materials described to within an error";
  plot.x = {.label = s.metric + " error", .scale = Scale::logarithmic};
  plot.y = {.label = "share of materials / %", .lo = 0, .hi = 100};
  for (std::size_t m = 0; m < shown(s); ++m) {
    std::vector<double> errors;
    for (const auto& row : s.error)
      errors.push_back(row[m]);
    plot.series.push_back(share_curve(s.models[m], std::move(errors), s.materials.size(), int(m)));
  }
  return plot;
}

Plot performance_plot(const Study& s) {
  Plot plot;
  plot.title = "How far behind the best model";
  plot.x = {.label = "error / error of the material's best model", .scale = Scale::logarithmic, .lo = 1};
  plot.y = {.label = "share of materials / %", .lo = 0, .hi = 100};
  for (std::size_t m = 0; m < shown(s); ++m) {
    std::vector<double> ratios;
    for (const auto& row : s.error)
      ratios.push_back(least(row) > 0 ? row[m] / least(row) : nan);
    plot.series.push_back(share_curve(s.models[m], std::move(ratios), s.materials.size(), int(m)));
  }
  return plot;
}

std::string csv(const Study& s) {
  const auto quoted = [](const std::string& text) {
    return text.find_first_of(",\"\n") == std::string::npos ? text : [&] {
      std::string q = "\"";
      for (const char c : text)
        q += c == '"' ? "\"\"" : std::string(1, c);
      return q + "\"";
    }();
  };
  std::string text = "material";
  for (const std::string& model : s.models)
    text += "," + quoted(model);
  for (std::size_t i = 0; i < s.materials.size(); ++i) {
    text += "\n" + quoted(s.materials[i]);
    for (const double e : s.error[i])
      text += std::isfinite(e) ? fmt::format(",{:.9g}", e) : ",";
  }
  return text + "\n";
}

std::string standings_text(const Study& s) {
  std::string text = fmt::format("{:<36} {:>11} {:>10} {:>6} {:>10} {:>6} {:>8}\n", "model, by median error",
                                 "median", "x best", "wins", "mean rank", "fits", "s a fit");
  for (std::size_t m = 0; m < s.models.size(); ++m) {
    const Study::Standing& t = s.standings[m];
    text +=
        fmt::format("{:<36} {:>11} {:>10} {:>6} {:>10.2f} {:>6} {:>8.2f}\n", s.models[m], number(t.median),
                    number(t.median_over_best), t.wins, t.mean_rank, t.fits, t.median_seconds);
  }
  return text + fmt::format("{} materials, {} metric\n", s.materials.size(), s.metric);
}

std::string markdown(const Study& s) {
  std::string text = fmt::format("{} materials, {} models, errors in the `{}` metric.\n\n",
                                 s.materials.size(), s.models.size(), s.metric);
  text += "| model | median error | median of error / best | wins | mean rank | fits | s a fit "
          "|\n|---|---|---|---|---|---|---|\n";
  for (std::size_t m = 0; m < s.models.size(); ++m) {
    const Study::Standing& t = s.standings[m];
    text += fmt::format("| `{}` | {} | {} | {} | {:.2f} | {} | {:.2f} |\n", s.models[m], number(t.median),
                        number(t.median_over_best), t.wins, t.mean_rank, t.fits, t.median_seconds);
  }
  text += "\n| material | best model |";
  for (const std::string& model : s.models)
    text += " " + model + " |";
  text += "\n|---|---|";
  for (std::size_t m = 0; m < s.models.size(); ++m)
    text += "---|";
  for (std::size_t i = 0; i < s.materials.size(); ++i) {
    const double best = least(s.error[i]);
    const auto winner = std::find(s.error[i].begin(), s.error[i].end(), best);
    text +=
        fmt::format("\n| {} | {} |", s.materials[i],
                    winner == s.error[i].end() ? "-" : s.models[std::size_t(winner - s.error[i].begin())]);
    for (const double e : s.error[i])
      text += e == best ? " **" + number(e) + "** |" : " " + number(e) + " |";
  }
  return text + "\n";
}

std::string study_page(const Study& s, const std::string& command) {
  std::string html =
      "<header><h1>Which model describes which material</h1>\n<p class=soft>Every model was fitted to every "
      "measurement in the " +
      escape_xml(s.metric) +
      " metric, after Ngan, Durand and Matusik 2005.</p>"
      "</header>\n<div class=facts>\n";
  html += html_fact(fmt::format("{}", s.materials.size()), "materials");
  html += html_fact(fmt::format("{}", s.models.size()), "models");
  const auto most = std::max_element(s.standings.begin(), s.standings.end(),
                                     [](const auto& a, const auto& b) { return a.wins < b.wins; });
  if (most != s.standings.end())
    html += html_fact("<code>" + escape_xml(s.models[std::size_t(most - s.standings.begin())]) + "</code>",
                      fmt::format("best on most materials, {} of {}", most->wins, s.materials.size()));
  html +=
      "</div>\n<section><h2>Standings</h2><div class=scroll><table><tr><th>model<th class=n>median error<th "
      "class=n>median of error / best<th class=n>wins<th class=n>mean rank<th class=n>fits<th "
      "class=n>seconds a fit\n";
  for (std::size_t m = 0; m < s.models.size(); ++m) {
    const Study::Standing& t = s.standings[m];
    html +=
        fmt::format("<tr><td><code>{}</code><td class=n>{}<td class=n>{}<td class=n>{}<td class=n>{:.2f}<td "
                    "class=n>{}<td class=n>{:.2f}\n",
                    escape_xml(s.models[m]), html_number(t.median), html_number(t.median_over_best), t.wins,
                    t.mean_rank, t.fits, t.median_seconds);
  }
  html += "</table></div></section>\n<section><h2>Figures</h2><div class=plots>\n";
  for (const Plot& plot : {sorted_materials_plot(s, 0), cumulative_plot(s), performance_plot(s)})
    html += "<figure>" + svg_element(plot) + "</figure>\n";
  html += "</div></section>\n<section><h2>Errors</h2><p class=soft>The best model of each material is bold; "
          "materials "
          "from the best to the worst described.</p><div class=scroll><table><tr><th>material";
  for (const std::string& model : s.models)
    html += "<th class=n>" + escape_xml(model);
  for (std::size_t i = 0; i < s.materials.size(); ++i) {
    html += "\n<tr><td>" + escape_xml(s.materials[i]);
    for (const double e : s.error[i])
      html += e == least(s.error[i]) ? "<td class=n><b>" + html_number(e) + "</b>"
                                     : "<td class=n>" + html_number(e);
  }
  html += "</table></div></section>\n<section><h2>Origin</h2><p><code>" + escape_xml(command) +
          "</code></p><p class=soft>Nacre " + escape_xml(version()) + "</p></section>\n";
  return html_page("Which model describes which material", html);
}

} // namespace nacre
