#pragma once
// Line and scatter plots as SVG text.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

/// One set of points of a plot, in the order of its line. Points that are not finite, and on a logarithmic
/// axis those at or below 0, are left out and break the line.
struct Series {
  std::string label; ///< in the legend; empty: not in the legend
  std::vector<double> x, y;
  bool dots = false; ///< markers instead of a line; their shape follows the colour
  int colour = 0;    ///< of plot_colour, any whole number
};

enum class Scale {
  linear,
  logarithmic, ///< base 10
  square_root, ///< spreads what is near 0; negative values count as 0
};

struct Axis {
  std::string label; ///< with its unit: "theta_o / degrees"
  Scale scale = Scale::linear;
  /// Ends; those not given follow the data.
  std::optional<double> lo = std::nullopt, hi = std::nullopt;
  bool degrees = false; ///< ticks at the parts of a circle people know
};

struct Plot {
  std::string title, subtitle;
  Axis x, y;
  std::vector<Series> series;
  double width = 560, height = 400; ///< in CSS pixels; a legend of more than three rows adds to the height
  /// A logarithmic y axis shows at most this many decades below the largest value.
  double decades = 6;
};

/// Colour of a series as "#rrggbb"; they repeat after seven, as dashes then. Distinguishable with any form of
/// colour blindness. Source: Okabe and Ito 2008, Color Universal Design.
std::string plot_colour(int index);

/// Places of ticks inside [lo, hi], ascending, at 1, 2 or 5 times a power of 10 apart (whole decades and, in
/// a short range, 2 and 5 between them where the scale is logarithmic), some `about` of them.
std::vector<double> nice_ticks(double lo, double hi, const Axis& axis, int about = 6);

/// A whole SVG file.
std::string svg_file(const Plot& plot);
/// The same as an element inside an HTML page. Texts, lines and grid carry classes (plot-text, plot-axis,
/// plot-grid, plot-background, series-N) by which the page's style can recolour them.
std::string svg_element(const Plot& plot);

/// `text` with the five characters that XML gives a meaning replaced, and control characters, which XML has
/// no way to write, left out.
std::string escape_xml(std::string_view text);

} // namespace nacre
