#include "report/surface_plots.h"

#include "core/error.h"

#include <gtest/gtest.h>
#include <pugixml.hpp>
#include <sstream>

namespace nacre {
namespace {

double at(const Series& s, double x) {
  for (std::size_t i = 0; i < s.x.size(); ++i)
    if (std::abs(s.x[i] - x) < 1e-9) return s.y[i];
  ADD_FAILURE() << s.label << " has no point at " << x;
  return 0;
}

TEST(FresnelPlot, KnownReflectances) {
  const std::vector<std::string> both{"BK7", "Au"};
  const Plot plot = fresnel_plot(both, 550);
  ASSERT_EQ(plot.series.size(), 2u);
  const double n = 1.51852; // of BK7 at 550 nm: Schott's data sheet
  EXPECT_NEAR(at(plot.series[0], 0), std::pow((n - 1) / (n + 1), 2), 1e-5);
  EXPECT_NEAR(at(plot.series[0], 90), 1, 1e-6);
  EXPECT_NEAR(at(plot.series[1], 0), 0.82, 0.04); // published tables of gold lie between 0.79 and 0.85
}

TEST(FresnelPlot, OfOneSubstanceWithBothPolarisationsAndBrewstersAngle) {
  const std::vector<std::string> glass{"BK7"};
  const Plot plot = fresnel_plot(glass, 550);
  ASSERT_EQ(plot.series.size(), 3u);
  const Series &mean = plot.series[0], &s = plot.series[1], &p = plot.series[2];
  for (std::size_t i = 0; i < mean.x.size(); ++i)
    EXPECT_NEAR(mean.y[i], 0.5 * (s.y[i] + p.y[i]), 1e-6);
  const std::size_t least = std::size_t(std::min_element(p.y.begin(), p.y.end()) - p.y.begin());
  EXPECT_NEAR(p.x[least], std::atan(1.51852) * 180 / pi, 0.2);
  EXPECT_LT(p.y[least], 1e-5);
  EXPECT_GT(s.y[least], 0.1);
}

TEST(FresnelPlot, GoldIsYellowAndTheUnknownIsNamed) {
  const std::vector<std::string> gold{"Au"}, nothing{"Unobtainium"};
  const Series& s = fresnel_wavelength_plot(gold).series[0];
  EXPECT_LT(at(s, 450), 0.45);
  EXPECT_GT(at(s, 650), 0.93);
  EXPECT_THROW(fresnel_plot(nothing, 550), Error);
}

TEST(FacetPlots, DistributionsAreNormalised) {
  for (const char* text :
       {"ggx_conductor:alpha_x=0.3,alpha_y=0.3", "beckmann_conductor:alpha_x=0.5,alpha_y=0.5",
        "gtr_conductor:alpha_x=0.2,alpha_y=0.2,gamma=3", "student_t_conductor:gamma=4",
        "blinn_phong_facets"}) {
    const MaterialSpec material = parse_material(text);
    const PlottedMaterial one{&material, text, false};
    const Series s = facet_normal_plot({&one, 1}, true).series.at(0);
    double sum = 0; // of D cos over the hemisphere, by the plotted points
    for (std::size_t i = 1; i < s.x.size(); ++i) {
      const auto ring = [&](std::size_t k) {
        const double theta = s.x[k] * pi / 180;
        return 2 * pi * s.y[k] * std::cos(theta) * std::sin(theta);
      };
      sum += 0.5 * (ring(i - 1) + ring(i)) * (s.x[i] - s.x[i - 1]) * pi / 180;
    }
    EXPECT_NEAR(sum, 1, 1e-3) << text;
  }
}

TEST(FacetPlots, MaskingOfGgxIsTheClosedForm) {
  const MaterialSpec material = parse_material("ggx_conductor:alpha_x=0.4,alpha_y=0.4");
  const PlottedMaterial one{&material, "m", false};
  const Series s = masking_plot({&one, 1}).series.at(0);
  EXPECT_NEAR(s.y[0], 1, 1e-12);
  const double t = std::tan(60 * pi / 180); // Walter et al. 2007, eq. 34
  EXPECT_NEAR(at(s, 60), 2 / (1 + std::sqrt(1 + 0.16 * t * t)), 1e-9);
}

TEST(FacetPlots, WhatHasNoFacetsIsNamedAndSeveralLobesAreToldApart) {
  const MaterialSpec plain = parse_material("lambert");
  const PlottedMaterial none{&plain, "lambert", false};
  EXPECT_THROW(facet_normal_plot({&none, 1}, true), Error);
  const MaterialSpec two = parse_material("ggx_schlick+ggx_conductor+lambert");
  const PlottedMaterial sum{&two, "sum", false};
  const Plot plot = facet_normal_plot({&sum, 1}, true);
  ASSERT_EQ(plot.series.size(), 2u);
  EXPECT_NE(plot.series[0].label, plot.series[1].label);
}

/// The lobes drawn: for each the points of its outline about the middle, as angle from the normal (degrees)
/// and length (pixels).
std::vector<std::vector<std::array<double, 2>>> rays(const std::string& svg) {
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(svg.c_str()));
  std::vector<std::vector<std::array<double, 2>>> lobes;
  for (const auto& node : document.select_nodes("//path[@class='lobe']")) {
    std::istringstream d(node.node().attribute("d").value());
    std::string word, point;
    double cx = 0, cy = 0;
    lobes.emplace_back();
    while (d >> word && word != "Z") {
      double x = 0, y = 0;
      char comma = 0;
      d >> x >> comma >> y;
      if (word == "M")
        cx = x, cy = y;
      else
        lobes.back().push_back({std::atan2(x - cx, cy - y) * 180 / pi, std::hypot(x - cx, y - cy)});
    }
  }
  return lobes;
}
std::array<double, 2> longest(const std::vector<std::array<double, 2>>& lobe) {
  return *std::max_element(lobe.begin(), lobe.end(),
                           [](const auto& a, const auto& b) { return a[1] < b[1]; });
}

TEST(PolarPlot, LongestRayLiesInTheMirrorDirection) {
  const MaterialSpec material = parse_material("ggx_conductor:alpha_x=0.02,alpha_y=0.02");
  const PlottedMaterial one{&material, "m", false};
  const std::array<double, 2> theta{20, 45};
  const auto lobes = rays(polar_svg({&one, 1}, theta));
  ASSERT_EQ(lobes.size(), 2u);
  EXPECT_NEAR(longest(lobes[0])[0], 20, 0.5);
  EXPECT_NEAR(longest(lobes[1])[0], 45, 0.5);
}

TEST(PolarPlot, GlassSendsTheLongestRayWhereSnellSays) {
  const MaterialSpec material = parse_material("ggx_dielectric:eta=1.5,alpha_x=0.02,alpha_y=0.02");
  const PlottedMaterial one{&material, "m", false};
  const std::array<double, 1> theta{45};
  const auto lobes = rays(polar_svg({&one, 1}, theta));
  ASSERT_EQ(lobes.size(), 1u);
  EXPECT_NEAR(longest(lobes[0])[0], 180 - std::asin(std::sin(pi / 4) / 1.5) * 180 / pi, 0.5);
}

TEST(PolarPlot, LengthsAreTheValuesTimesTheCosine) {
  const MaterialSpec material = parse_material("lambert");
  const PlottedMaterial one{&material, "m", false};
  const std::array<double, 1> theta{0};
  for (const double compression : {1.0, 0.5}) {
    const auto lobe = rays(polar_svg({&one, 1}, theta, compression)).at(0);
    const double radius = longest(lobe)[1];
    for (const auto& [angle, length] : lobe) {
      if (length < 20) continue; // in hundredths of a pixel too coarse to tell the angle
      EXPECT_NEAR(length / radius, std::pow(std::cos(angle * pi / 180), compression), 2e-3) << angle;
    }
  }
}

TEST(LuminanceCurves, AroundTheNormalLambertIsFlat) {
  const MaterialSpec flat = parse_material("lambert:reflectance=0.5");
  const PlottedMaterial one{&flat, "m", false};
  const std::array<double, 2> theta{20, 70};
  const Plot plot = azimuth_plot({&one, 1}, theta, true);
  ASSERT_EQ(plot.series.size(), 2u);
  for (const double f : plot.series[1].y)
    EXPECT_NEAR(f, 0.5 / pi, 1e-6);
}

TEST(LuminanceCurves, PeakOfFixedViewersIsInTheMirrorDirection) {
  const MaterialSpec metal = parse_material("ggx_conductor:alpha_x=0.02,alpha_y=0.02");
  const PlottedMaterial one{&metal, "m", false};
  const std::array<double, 1> theta{30};
  const Series s = theta_i_plot({&one, 1}, theta, true).series.at(0);
  const std::size_t peak = std::size_t(std::max_element(s.y.begin(), s.y.end()) - s.y.begin());
  EXPECT_NEAR(s.x[peak], 30, 0.2);
}

TEST(LuminanceCurves, OfDotsAndLinesOneAngleHasOneColour) {
  const MaterialSpec a = parse_material("lambert"), b = parse_material("oren_nayar");
  const std::array<PlottedMaterial, 2> pair{{{&a, "measured", true}, {&b, "fit", false}}};
  const std::array<double, 2> theta{0, 45};
  const Plot plot = azimuth_plot(pair, theta, true);
  ASSERT_EQ(plot.series.size(), 4u);
  EXPECT_EQ(plot.series[1].colour, plot.series[3].colour);
  EXPECT_TRUE(plot.series[1].label.empty());
  EXPECT_LT(plot.series[0].x.size(), plot.series[2].x.size());
}

TEST(AlbedoOverRoughness, SingleScatteringLosesAndTheWalkDoesNot) {
  const MaterialSpec single = parse_material("ggx_conductor:eta=0.01,k=30"),
                     walk = parse_material("walk_ggx_conductor:eta=0.01,k=30");
  const std::array<PlottedMaterial, 2> both{{{&single, "single", false}, {&walk, "walk", false}}};
  const std::array<double, 1> theta{0};
  const Plot plot = albedo_over_parameter_plot(both, "alpha", 0.1, 1, theta);
  ASSERT_EQ(plot.series.size(), 2u);
  EXPECT_NEAR(plot.series[0].y.front(), 1, 0.02);
  EXPECT_LT(plot.series[0].y.back(), 0.35);
  EXPECT_NEAR(plot.series[1].y.back(), 1, 5e-3);
  EXPECT_GE(*plot.y.hi, 1.05);
}

} // namespace
} // namespace nacre
