#include "report/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>

namespace nacre {
namespace {

constexpr std::array<const char*, 7> colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                             "#e69f00", "#56b4e9", "#222222"};
constexpr double margin_left = 64, margin_right = 16, margin_bottom = 46, title_height = 24, legend_row = 18,
                 glyph_width = 7; // of text 12 pixels high, an estimate on the wide side

int colour_index(int index) {
  constexpr int n = static_cast<int>(colours.size());
  return ((index % n) + n) % n;
}

double forward(Scale scale, double v) {
  switch (scale) {
  case Scale::linear:
    return v;
  case Scale::logarithmic:
    return v > 0 ? std::log10(v) : std::numeric_limits<double>::quiet_NaN();
  case Scale::square_root:
    return std::sqrt(std::max(v, 0.0));
  }
  return v;
}

/// An axis with known ends, both of which are finite and differ.
struct Ruler {
  Scale scale;
  double lo, hi;
  /// Share of the way from lo to hi.
  double at(double v) const {
    const double a = forward(scale, lo), b = forward(scale, hi);
    return (forward(scale, v) - a) / (b - a);
  }
};

Ruler ruler(const Axis& axis, const std::vector<Series>& series, bool is_x, double decades) {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  for (const Series& s : series)
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
      const double v = is_x ? s.x[i] : s.y[i];
      if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i]) || !std::isfinite(forward(axis.scale, v)))
        continue;
      lo = std::min(lo, v), hi = std::max(hi, v);
    }
  const bool logarithmic = axis.scale == Scale::logarithmic;
  if (!(lo <= hi)) lo = logarithmic ? 0.1 : 0, hi = 1; // no data
  if (logarithmic) {
    lo = std::max(lo, hi * std::pow(10.0, -decades));
    if (hi < lo * 1.5) lo /= 3, hi *= 3;
    lo /= 1.15, hi *= 1.15;
  } else if (hi - lo <= 1e-12 * std::max(std::abs(lo), std::abs(hi))) {
    const double half = lo == 0 ? 1 : std::abs(lo) * 0.1;
    lo -= half, hi += half;
  } else if (!is_x) {
    const double room = 0.04 * (hi - lo);
    lo = lo >= 0 && lo < 0.5 * hi ? 0 : lo - room; // zero is worth seeing when it is near
    hi += room;
  }
  if (axis.scale == Scale::square_root) lo = std::max(lo, 0.0);
  Ruler r{axis.scale, axis.lo.value_or(lo), axis.hi.value_or(hi)};
  const double a = forward(r.scale, r.lo), b = forward(r.scale, r.hi);
  if (!std::isfinite(a) || !std::isfinite(b) || !(a < b)) r.lo = lo, r.hi = hi;
  return r;
}

std::string superscript(int n) {
  static constexpr std::array<const char*, 10> digits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = n < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(n)))
    text += digits[static_cast<std::size_t>(c - '0')];
  return text;
}

std::string tick_label(double v, double step) {
  if (std::abs(v) < 1e-9 * step) return "0";
  const double magnitude = std::abs(v);
  if (magnitude < 1e-3 || magnitude >= 1e5) {
    const int e = static_cast<int>(std::floor(std::log10(magnitude) + 1e-9));
    const double mantissa = v / std::pow(10.0, e);
    if (std::abs(std::abs(mantissa) - 1) < 1e-6) return (v < 0 ? "−10" : "10") + superscript(e);
    return fmt::format("{:.4g}·10{}", mantissa, superscript(e));
  }
  std::string text = fmt::format("{:.6g}", v);
  if (text[0] == '-') text.replace(0, 1, "−");
  return text;
}

/// A marker of its own for each colour, so that no reader depends on hue.
std::string marker(int colour, double x, double y, const std::string& fill) {
  switch (colour_index(colour)) {
  case 0:
    return fmt::format("<circle cx='{:.2f}' cy='{:.2f}' r='2.4'{}/>", x, y, fill);
  case 1:
    return fmt::format("<rect x='{:.2f}' y='{:.2f}' width='4.4' height='4.4'{}/>", x - 2.2, y - 2.2, fill);
  case 2:
    return fmt::format("<path d='M{:.2f} {:.2f}l3 5h-6z'{}/>", x, y - 3, fill);
  case 3:
    return fmt::format("<path d='M{:.2f} {:.2f}l3 3l-3 3l-3-3z'{}/>", x, y - 3, fill);
  case 4:
    return fmt::format("<path d='M{:.2f} {:.2f}l3-5h-6z'{}/>", x, y + 3, fill);
  case 5:
    return fmt::format("<rect x='{:.2f}' y='{:.2f}' width='2.6' height='6'{}/>", x - 1.3, y - 3, fill);
  default:
    return fmt::format("<rect x='{:.2f}' y='{:.2f}' width='6' height='2.6'{}/>", x - 3, y - 1.3, fill);
  }
}

std::string text_at(double x, double y, const char* anchor, double size, std::string_view text,
                    const char* more = "") {
  return fmt::format("<text class='plot-text' x='{:.1f}' y='{:.1f}' text-anchor='{}' font-size='{:g}' "
                     "fill='#222222'{}>{}</text>\n",
                     x, y, anchor, size, more, escape_xml(text));
}

std::size_t characters(std::string_view utf8) {
  return static_cast<std::size_t>(
      std::count_if(utf8.begin(), utf8.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

struct LegendEntry {
  const Series* series;
  double x;
  int row;
};
std::vector<LegendEntry> lay_out_legend(const Plot& plot) {
  std::vector<LegendEntry> entries;
  double x = margin_left;
  int row = 0;
  for (const Series& s : plot.series) {
    if (s.label.empty()) continue;
    const double width = 30 + glyph_width * static_cast<double>(characters(s.label)) + 12;
    if (x > margin_left && x + width > plot.width) x = margin_left, ++row;
    entries.push_back({&s, x, row});
    x += width;
  }
  return entries;
}

/// The area of the data, and how values fall onto it; y runs down.
struct Panel {
  double left, top, width, height;
  Ruler x, y;
  double px(double v) const { return width * x.at(v); }
  double py(double v) const { return height * (1 - y.at(v)); }
};

using Points = std::vector<std::array<double, 2>>;

/// Leaves out points that lie within a twentieth of a pixel of the line without them (Douglas and Peucker
/// 1973): curves are sampled more finely than anyone sees, and files stay small.
void simplify(const Points& points, std::size_t first, std::size_t last, std::string& path) {
  const auto [x0, y0] = points[first];
  const auto [x1, y1] = points[last];
  const double length = std::hypot(x1 - x0, y1 - y0);
  std::size_t farthest = first;
  double distance = 0.05;
  for (std::size_t i = first + 1; i < last; ++i) {
    const auto [x, y] = points[i];
    const double d = length > 0 ? std::abs((x - x0) * (y1 - y0) - (y - y0) * (x1 - x0)) / length
                                : std::hypot(x - x0, y - y0);
    if (d > distance) distance = d, farthest = i;
  }
  if (farthest > first) {
    simplify(points, first, farthest, path);
    simplify(points, farthest, last, path);
  } else {
    path += fmt::format("L{:.2f} {:.2f}", x1, y1);
  }
}

void draw_run(const Points& run, std::string& path) {
  if (run.empty()) return;
  path += fmt::format("M{:.2f} {:.2f}", run[0][0], run[0][1]);
  if (run.size() == 1)
    path += "h0"; // with round ends, a line of no length is a dot
  else
    simplify(run, 0, run.size() - 1, path);
}

/// Lines whose colour repeats are told apart by dashes.
std::string dashes(int colour) {
  constexpr std::array<const char*, 3> patterns{"", " stroke-dasharray='7 4'", " stroke-dasharray='1 4'"};
  return colour < 0 ? "" : patterns[std::size_t(colour) / colours.size() % patterns.size()];
}

void draw_series(std::string& out, const Series& s, const Panel& panel) {
  const std::string colour = plot_colour(s.colour);
  const int index = colour_index(s.colour);
  // Far outside the panel is as good as just outside, and keeps every coordinate printable.
  const auto near = [](double v, double size) { return std::clamp(v, -4 * size, 5 * size); };
  std::string path;
  Points run; // without a gap
  if (s.dots) out += fmt::format("<g class='series-{}' fill='{}'>\n", index, colour);
  for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
    const double x = panel.px(s.x[i]), y = panel.py(s.y[i]);
    if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i]) || !std::isfinite(x) || !std::isfinite(y)) {
      draw_run(run, path);
      run.clear();
      continue;
    }
    if (s.dots) {
      if (x >= -1 && x <= panel.width + 1 && y >= -1 && y <= panel.height + 1)
        out += marker(s.colour, x, y, "") + "\n";
      continue;
    }
    run.push_back({near(x, panel.width), near(y, panel.height)});
  }
  draw_run(run, path);
  if (s.dots)
    out += "</g>\n";
  else if (!path.empty())
    out += fmt::format("<path class='series-{} plot-line' d='{}' fill='none' stroke='{}' stroke-width='1.8' "
                       "stroke-linejoin='round' stroke-linecap='round'{}/>\n",
                       index, path, colour, dashes(s.colour));
}

void draw_axes(std::string& out, const Plot& plot, const Panel& panel) {
  const auto x_ticks = nice_ticks(panel.x.lo, panel.x.hi, plot.x, 7);
  const auto y_ticks = nice_ticks(panel.y.lo, panel.y.hi, plot.y, 6);
  const auto step = [](const std::vector<double>& t) { return t.size() > 1 ? t[1] - t[0] : 1; };
  for (const double v : x_ticks) {
    const double x = panel.left + panel.px(v);
    out += fmt::format("<line class='plot-grid' x1='{0:.1f}' y1='{1:.1f}' x2='{0:.1f}' y2='{2:.1f}' "
                       "stroke='#dddddd'/>\n",
                       x, panel.top, panel.top + panel.height);
    out += text_at(x, panel.top + panel.height + 16, "middle", 12, tick_label(v, step(x_ticks)));
  }
  for (const double v : y_ticks) {
    const double y = panel.top + panel.py(v);
    out += fmt::format("<line class='plot-grid' x1='{0:.1f}' y1='{1:.1f}' x2='{2:.1f}' y2='{1:.1f}' "
                       "stroke='#dddddd'/>\n",
                       panel.left, y, panel.left + panel.width);
    out += text_at(panel.left - 6, y + 4, "end", 12, tick_label(v, step(y_ticks)));
  }
  out += fmt::format("<rect class='plot-axis' x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}' "
                     "fill='none' stroke='#666666'/>\n",
                     panel.left, panel.top, panel.width, panel.height);
  out += text_at(panel.left + panel.width / 2, plot.height - 8, "middle", 12.5, plot.x.label);
  const double x = 14, y = panel.top + panel.height / 2;
  out += text_at(x, y, "middle", 12.5, plot.y.label,
                 fmt::format(" transform='rotate(-90 {:.1f} {:.1f})'", x, y).c_str());
}

std::string draw(Plot plot, std::string_view name_space) {
  const std::vector<LegendEntry> legend = lay_out_legend(plot);
  // A long legend makes the picture taller, not the panel lower.
  if (!legend.empty()) plot.height += legend_row * std::max(0, legend.back().row - 2);
  const double legend_height = legend.empty() ? 0 : legend_row * (legend.back().row + 1) + 4;
  double top = 8;
  if (!plot.title.empty()) top += title_height;
  if (!plot.subtitle.empty()) top += legend_row;
  const double legend_top = top;
  top += legend_height;
  const Panel panel{margin_left,
                    top,
                    std::max(plot.width - margin_left - margin_right, 10.0),
                    std::max(plot.height - top - margin_bottom, 10.0),
                    ruler(plot.x, plot.series, true, 12),
                    ruler(plot.y, plot.series, false, plot.decades)};

  std::string out =
      fmt::format("<svg {}class='plot' role='img' aria-label='{}' width='{:g}' height='{:g}' "
                  "viewBox='0 0 {:g} {:g}' font-family='system-ui, sans-serif'>\n",
                  name_space, escape_xml(plot.title), plot.width, plot.height, plot.width, plot.height);
  out += fmt::format("<rect class='plot-background' width='{:g}' height='{:g}' fill='#ffffff'/>\n",
                     plot.width, plot.height);
  if (!plot.title.empty()) out += text_at(margin_left, 22, "start", 15, plot.title, " font-weight='600'");
  if (!plot.subtitle.empty())
    out += text_at(margin_left, plot.title.empty() ? 20 : 42, "start", 12, plot.subtitle);
  for (const LegendEntry& e : legend) {
    const double y = legend_top + legend_row * e.row + 10;
    const int index = colour_index(e.series->colour);
    const std::string colour = plot_colour(e.series->colour);
    if (e.series->dots)
      out += fmt::format("<g class='series-{}' fill='{}'>{}</g>\n", index, colour,
                         marker(e.series->colour, e.x + 12, y, ""));
    else
      out += fmt::format("<path class='series-{} plot-line' d='M{:.1f} {:.1f}h22' fill='none' stroke='{}' "
                         "stroke-width='2.4'/>\n",
                         index, e.x, y, colour);
    out += text_at(e.x + 28, y + 4, "start", 12, e.series->label);
  }
  draw_axes(out, plot, panel);
  // An inner svg element clips to its box without needing a name that might be taken in the page around.
  out += fmt::format("<svg x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}'>\n", panel.left, panel.top,
                     panel.width, panel.height);
  const std::size_t empty = out.size();
  for (const Series& s : plot.series)
    draw_series(out, s, panel);
  const bool nothing = out.size() == empty;
  out += "</svg>\n";
  if (nothing)
    out += text_at(panel.left + panel.width / 2, panel.top + panel.height / 2, "middle", 14, "no data");
  return out + "</svg>\n";
}

} // namespace

std::string plot_colour(int index) { return colours[static_cast<std::size_t>(colour_index(index))]; }

std::vector<double> nice_ticks(double lo, double hi, const Axis& axis, int about) {
  std::vector<double> ticks;
  if (!std::isfinite(lo) || !std::isfinite(hi) || !(lo < hi) || about < 1) return ticks;
  if (axis.scale == Scale::logarithmic) {
    if (!(lo > 0)) return ticks;
    const int first = static_cast<int>(std::floor(std::log10(lo))),
              last = static_cast<int>(std::ceil(std::log10(hi)));
    const int every = std::max(1, (last - first + about - 1) / std::max(about, 1));
    const bool between = std::log10(hi / lo) < 2.5;
    for (int e = first; e <= last; ++e)
      for (const double digit : {1.0, 2.0, 5.0}) {
        if (digit > 1 ? !between : e % every != 0) continue;
        const double v = digit * std::pow(10.0, e);
        if (v >= lo * (1 - 1e-9) && v <= hi * (1 + 1e-9)) ticks.push_back(v);
      }
    return ticks;
  }
  if (axis.scale == Scale::square_root) {
    // Even steps in the root fall on values nobody reads: take round ones that lie far enough apart.
    const double span = std::sqrt(hi) - std::sqrt(std::max(lo, 0.0));
    double last = -std::numeric_limits<double>::infinity();
    std::vector<double> candidates{0};
    const std::vector<double> digits =
        axis.degrees ? std::vector<double>{1, 2, 5, 10, 20, 30, 45, 60, 90} : std::vector<double>{1, 2, 5};
    if (axis.degrees)
      candidates.insert(candidates.end(), digits.begin(), digits.end());
    else
      for (int e = static_cast<int>(std::floor(std::log10(hi))) - 3; e <= std::log10(hi); ++e)
        for (const double digit : digits)
          candidates.push_back(digit * std::pow(10.0, e));
    for (const double v : candidates)
      if (v >= lo && v <= hi * (1 + 1e-9) && std::sqrt(v) - last >= 0.55 * span / about) {
        ticks.push_back(v);
        last = std::sqrt(v);
      }
    return ticks;
  }
  const double rough = (hi - lo) / about;
  double step = 0;
  if (axis.degrees && rough > 0.5 && rough <= 90) {
    for (const double s : {1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0})
      if (step == 0 && s >= rough * 0.7) step = s;
  } else {
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double digit : {1.0, 2.0, 5.0, 10.0})
      if (step == 0 && digit * power >= rough * 0.999) step = digit * power;
  }
  if (!(step > 0)) return ticks;
  const double first = std::ceil(lo / step - 1e-9), last = std::floor(hi / step + 1e-9);
  if (!(last - first < 1000)) return ticks;
  for (double k = first; k <= last; ++k)
    ticks.push_back(k == 0 ? 0 : k * step);
  return ticks;
}

std::string svg_file(const Plot& plot) {
  return "<?xml version='1.0' encoding='UTF-8'?>\n" + draw(plot, "xmlns='http://www.w3.org/2000/svg' ");
}
std::string svg_element(const Plot& plot) { return draw(plot, ""); }

std::string escape_xml(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
    case '&':
      out += "&amp;";
      break;
    case '<':
      out += "&lt;";
      break;
    case '>':
      out += "&gt;";
      break;
    case '"':
      out += "&quot;";
      break;
    case '\'':
      out += "&#39;";
      break;
    default:
      if (static_cast<unsigned char>(c) >= 0x20 || c == '\t' || c == '\n') out += c;
    }
  }
  return out;
}

} // namespace nacre
