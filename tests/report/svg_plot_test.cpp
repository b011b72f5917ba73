#include "report/svg_plot.h"

#include <cmath>
#include <gmock/gmock.h>
#include <limits>
#include <pugixml.hpp>

namespace nacre {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

pugi::xml_document parse(const Plot& plot) {
  pugi::xml_document document;
  const std::string text = svg_file(plot);
  const auto result = document.load_string(text.c_str(), pugi::parse_full);
  EXPECT_TRUE(result) << result.description() << " at " << result.offset << " of\n" << text;
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_EQ(text.find("inf"), std::string::npos);
  return document;
}

Plot one_series(std::vector<double> x, std::vector<double> y, bool dots = false) {
  Plot plot;
  plot.series.push_back({"s", std::move(x), std::move(y), dots, 0});
  return plot;
}

/// The outline of the only line drawn in the panel.
std::string outline(const Plot& plot) {
  const pugi::xml_document document = parse(plot);
  return document.select_node("/svg/svg/path").node().attribute("d").value();
}
std::size_t count(const std::string& text, char c) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), c));
}

TEST(SvgPlot, TextsComeBackFromXml) {
  Plot plot = one_series({0, 1}, {0, 1});
  plot.title = "a < b & \"c\" > 'd' \x01";
  plot.x.label = "<script>";
  plot.series[0].label = "R&D";
  const auto document = parse(plot);
  std::vector<std::string> texts;
  for (const auto& node : document.select_nodes("//text"))
    texts.emplace_back(node.node().text().get());
  EXPECT_THAT(texts, testing::IsSupersetOf({"a < b & \"c\" > 'd' ", "<script>", "R&D"}));
}

TEST(SvgPlot, EveryScaleIsWellFormedForAwkwardData) {
  const std::vector<std::vector<double>> data{{},
                                              {3},
                                              {0, 0, 0},
                                              {nan, nan},
                                              {infinity, 1, -infinity},
                                              {-1, -2},
                                              {1e-300, 1e300},
                                              {-1e308, 1e308},
                                              {5e-324, 1}};
  for (const Scale scale : {Scale::linear, Scale::logarithmic, Scale::square_root})
    for (const auto& values : data)
      for (const bool dots : {false, true}) {
        std::vector<double> x;
        for (std::size_t i = 0; i < values.size(); ++i)
          x.push_back(static_cast<double>(i));
        Plot plot = one_series(x, values, dots);
        plot.y.scale = scale;
        parse(plot);
        plot = one_series(values, x, dots);
        plot.x.scale = scale;
        parse(plot);
      }
}

TEST(SvgPlot, NothingToShowIsSaid) {
  EXPECT_NE(svg_file(Plot()).find("no data"), std::string::npos);
  EXPECT_NE(svg_file(one_series({1, 2}, {nan, nan})).find("no data"), std::string::npos);
  EXPECT_EQ(svg_file(one_series({1, 2}, {1, 2})).find("no data"), std::string::npos);
}

TEST(SvgPlot, ValuesThatAreNotFiniteBreakTheLine) {
  const std::string d = outline(one_series({0, 1, 2, 3, 4}, {1, 2, nan, 4, 5}));
  EXPECT_EQ(count(d, 'M'), 2u) << d;
  EXPECT_EQ(count(d, 'L'), 2u) << d;
}

TEST(SvgPlot, WhatALogarithmicAxisCannotShowBreaksTheLine) {
  Plot plot = one_series({0, 1, 2, 3, 4}, {1, 2, 0, -4, 5});
  plot.y.scale = Scale::logarithmic;
  const std::string d = outline(plot);
  EXPECT_EQ(count(d, 'M'), 2u) << d;
  EXPECT_EQ(count(d, 'h'), 1u) << "a point without neighbours is drawn as a dot: " << d;
}

// The panel's frame is what stays; the picture grows.
TEST(SvgPlot, ALongLegendTakesNoRoomFromTheCurves) {
  const auto panel_height = [](int curves) {
    Plot plot;
    for (int i = 0; i < curves; ++i)
      plot.series.push_back(
          {"a material with quite a long text, seen at an angle", {0, 1}, {0, 1}, false, i});
    const std::string svg = svg_file(plot);
    const std::size_t at = svg.find(" height='", svg.find("<rect class='plot-axis'"));
    return std::stod(svg.substr(at + 9));
  };
  EXPECT_EQ(panel_height(20), panel_height(3));
}

TEST(SvgPlot, LinesOfTheSameColourDifferInDashes) {
  Plot plot;
  for (int i = 0; i < 8; ++i)
    plot.series.push_back({"", {0, 1}, {0, double(i)}, false, i});
  const std::string svg = svg_file(plot);
  EXPECT_NE(svg.find("stroke-dasharray"), std::string::npos);
  plot.series.pop_back();
  EXPECT_EQ(svg_file(plot).find("stroke-dasharray"), std::string::npos);
}

TEST(SvgPlot, DotsAreAsManyAsFiniteValues) {
  const auto document = parse(one_series({0, 1, 2, 3}, {1, nan, 3, 4}, true));
  EXPECT_EQ(document.select_nodes("/svg/svg/g/circle").size(), 3u);
}

TEST(SvgPlot, ElementOfAPageNamesNothingOutsideIt) {
  const std::string text = svg_element(one_series({0, 1}, {0, 1}));
  EXPECT_EQ(text.find("http"), std::string::npos);
  EXPECT_EQ(text.find(" id="), std::string::npos) << "two plots of a page would share it";
}

TEST(SvgPlot, LowValuesOfALogarithmicAxisAreCutAtTheDecadesAskedFor) {
  Plot plot = one_series({0, 1, 2}, {1e-30, 1, 10});
  plot.y.scale = Scale::logarithmic;
  plot.decades = 3;
  EXPECT_EQ(svg_file(plot).find("10⁻"), std::string::npos);
}

TEST(PlotTicks, AreRoundAndEvenlySpacedOnALinearAxis) {
  for (const auto& [lo, hi] :
       {std::pair{0.0, 1.0}, {-3.7, 12.1}, {1e-9, 4e-9}, {1e6, 1.00001e6}, {-5.0, -1.0}}) {
    const auto ticks = nice_ticks(lo, hi, Axis());
    ASSERT_GE(ticks.size(), 3u);
    EXPECT_LE(ticks.size(), 14u);
    const double step = ticks[1] - ticks[0];
    const double mantissa = step / std::pow(10, std::floor(std::log10(step) + 1e-6));
    EXPECT_THAT(std::round(mantissa * 1000) / 1000, testing::AnyOf(1, 2, 5)) << lo << " " << hi;
    for (const double t : ticks) {
      EXPECT_GE(t, lo - 1e-9 * step);
      EXPECT_LE(t, hi + 1e-9 * step);
    }
  }
}

TEST(PlotTicks, OfAnglesArePartsOfACircle) {
  Axis axis;
  axis.degrees = true;
  EXPECT_EQ(nice_ticks(-90, 90, axis), (std::vector<double>{-90, -60, -30, 0, 30, 60, 90}));
}

TEST(PlotTicks, OfALongLogarithmicAxisAreDecades) {
  Axis axis;
  axis.scale = Scale::logarithmic;
  EXPECT_THAT(nice_ticks(0.002, 300, axis),
              testing::Pointwise(testing::DoubleNear(1e-9), {0.01, 0.1, 1.0, 10.0, 100.0}));
}

TEST(PlotTicks, ThereAreNoneInARangeThatIsNone) {
  EXPECT_TRUE(nice_ticks(1, 1, Axis()).empty());
  EXPECT_TRUE(nice_ticks(nan, 1, Axis()).empty());
  EXPECT_TRUE(nice_ticks(2, 1, Axis()).empty());
}

} // namespace
} // namespace nacre
