#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "core/warp.h"
#include "measured/formats.h"
#include "measured/formats/window_xml.h"
#include "measured/synthetic_tables.h"
#include "spectra/color_space.h"

#include <algorithm>
#include <cmath>

namespace nacre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A document around some blocks. @param data  pairs of wavelength and blocks
std::string document(const std::string& structure,
                     const std::vector<std::pair<std::string, std::string>>& data,
                     const std::string& bases = {}) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<WindowElement><Optical><Layer>\n<Material><Name>Blind</Name></Material>\n"
      "<DataDefinition><IncidentDataStructure>" +
      structure + "</IncidentDataStructure>" + bases + "</DataDefinition>\n";
  for (const auto& [wavelength, blocks] : data)
    text += "<WavelengthData><Wavelength unit=\"Integral\">" + wavelength + "</Wavelength>\n" + blocks +
            "</WavelengthData>\n";
  return text + "</Layer></Optical></WindowElement>\n";
}
std::string tree_block(const std::string& direction, const std::string& tree) {
  return "<WavelengthDataBlock><WavelengthDataDirection>" + direction +
         "</WavelengthDataDirection><AngleBasis>LBNL/Shirley-Chiu</AngleBasis><ScatteringData>" + tree +
         "</ScatteringData></WavelengthDataBlock>\n";
}
std::string matrix_block(const std::string& direction, const std::string& basis, const std::string& numbers) {
  return "<WavelengthDataBlock><WavelengthDataDirection>" + direction +
         "</WavelengthDataDirection><ColumnAngleBasis>" + basis + "</ColumnAngleBasis><RowAngleBasis>" +
         basis + "</RowAngleBasis><ScatteringData>" + numbers + "</ScatteringData></WavelengthDataBlock>\n";
}
WindowBsdf parsed(const std::string& text) {
  return parse_window_xml({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, "x.xml");
}
std::string message_of(const std::string& text) {
  try {
    parsed(text);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}
float value(const MeasuredBsdf& m, const Vec3d& wo, const Vec3d& wi) {
  std::array<float, 3> f;
  return m.evaluate(wo, wi, f) ? f[0] : -1;
}
Vec3d at(double theta_deg, double phi_deg) {
  return spherical_direction(theta_deg * pi / 180, phi_deg * pi / 180);
}

/// Every pair of patches of the quarter basis has a value of its own, 100 outgoing + incident.
std::string numbered(int size = 41) {
  std::string s;
  for (int o = 0; o < size; ++o)
    for (int i = 0; i < size; ++i)
      s += std::to_string(100 * o + i) + (i + 1 < size ? "," : ",\n");
  return s;
}

TEST(KlemsBasis, StandardOnesHaveTheirPatchesAndCoverTheHemisphere) {
  const std::array<int, 4> sizes{145, 77, 41, 73};
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    const KlemsBasis& basis = KlemsBasis::standard()[b];
    EXPECT_EQ(basis.size(), sizes[b]) << basis.name();
    double projected = 0, solid = 0;
    for (int p = 0; p < basis.size(); ++p) {
      projected += basis.projected_solid_angle(p);
      solid += basis.solid_angle(p);
      for (std::uint64_t i = 0; i < 20; ++i) {
        const Vec2d u{0.001 + 0.998 * double(uniform(1, std::uint64_t(p), i, 0)),
                      0.001 + 0.998 * double(uniform(1, std::uint64_t(p), i, 1))};
        EXPECT_EQ(basis.patch(basis.direction(p, u)), p);
      }
    }
    EXPECT_NEAR(projected, pi, 1e-12);
    EXPECT_NEAR(solid, 2 * pi, 1e-12);
  }
}

TEST(KlemsBasis, PatchesAreCountedFromThePoleAndFromXToY) {
  const KlemsBasis& full = KlemsBasis::standard()[0];
  EXPECT_EQ(full.patch(at(0, 0)), 0);
  EXPECT_EQ(full.patch(at(4.9, 200)), 0);
  EXPECT_EQ(full.patch(at(10, 0)), 1);
  EXPECT_EQ(full.patch(at(10, 22)), 1); // a sector is centred on azimuth 0, 45 degrees wide
  EXPECT_EQ(full.patch(at(10, -22)), 1);
  EXPECT_EQ(full.patch(at(10, 23)), 2);
  EXPECT_EQ(full.patch(at(10, -23)), 8);
  EXPECT_EQ(full.patch(at(20, 0)), 9);
  EXPECT_EQ(full.patch(at(89.9, 0)), 145 - 12);
  EXPECT_EQ(full.patch({1, 0, 0}), 145 - 12);
}

TEST(KlemsBasis, RingsThatDoNotFillTheHemisphereAreRefused) {
  EXPECT_THROW(KlemsBasis("x", {}), Error);
  EXPECT_THROW(KlemsBasis("x", {{0, 80, 4}}), Error);
  EXPECT_THROW(KlemsBasis("x", {{0, 30, 4}, {40, 90, 4}}), Error);
  EXPECT_THROW(KlemsBasis("x", {{0, 90, 0}}), Error);
  EXPECT_THROW(KlemsBasis("x", {{0, 90, 1 << 30}}), Error);
}

TEST(WindowMatrices, RowsAreOutgoingAndColumnsIncident) {
  const WindowBsdf m = parsed(
      document("Columns", {{"Visible", matrix_block("Reflection Back", "LBNL/Klems Quarter", numbered())}}));
  const KlemsBasis& b = KlemsBasis::standard()[2];
  for (int o = 0; o < 41; o += 3)
    for (int i = 0; i < 41; i += 3) {
      const Vec3d wo = b.direction(o, {0.5, 0.5});
      const Vec3d travels = b.direction(i, {0.5, 0.5}); // as light travels, x and y
      EXPECT_EQ(value(m, wo, {-travels.x, -travels.y, travels.z}), float(100 * o + i));
    }
  EXPECT_EQ(value(m, {0, 0, -1}, {0, 0, -1}), -1); // the back was not measured
  const WindowBsdf rows = parsed(
      document("Rows", {{"Visible", matrix_block("Reflection Back", "LBNL/Klems Quarter", numbered())}}));
  EXPECT_EQ(value(rows, at(0, 0),
                  {-b.direction(7, {.5, .5}).x, -b.direction(7, {.5, .5}).y, b.direction(7, {.5, .5}).z}),
            700);
}

std::string constant_matrix(int size) {
  std::string s;
  for (int i = 0; i < size * size; ++i)
    s += "1 ";
  return s;
}

// WINDOW's Half has 77 patches, Radiance's had 73 until 2022: the count of numbers tells which is meant.
TEST(WindowMatrices, HalfIsKnownByItsNumbers) {
  for (const int size : {77, 73}) {
    const WindowBsdf m = parsed(document(
        "Columns", {{"Visible", matrix_block("Reflection Back", "LBNL/Klems Half", constant_matrix(size))}}));
    EXPECT_EQ(value(m, at(30, 0), at(80, 100)), 1);
  }
  EXPECT_THAT(message_of(document("Columns", {{"Visible", matrix_block("Reflection Back", "LBNL/Klems Half",
                                                                       constant_matrix(75))}})),
              HasSubstr("77 x 77"));
}

// The rings that a file gives are what it means, also by a standard name.
TEST(WindowMatrices, RingsOfTheFileCountBeforeThoseOfTheName) {
  const std::string bases =
      "<AngleBasis><AngleBasisName>LBNL/Klems Quarter</AngleBasisName>"
      "<AngleBasisBlock><Theta>0</Theta><nPhis>1</nPhis><ThetaBounds><LowerTheta>0</LowerTheta>"
      "<UpperTheta>40</UpperTheta></ThetaBounds></AngleBasisBlock>"
      "<AngleBasisBlock><Theta>65</Theta><nPhis>40</nPhis><ThetaBounds><LowerTheta>40</LowerTheta>"
      "<UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>";
  const WindowBsdf m = parsed(document(
      "Columns", {{"Visible", matrix_block("Reflection Back", "LBNL/Klems Quarter", numbered())}}, bases));
  EXPECT_EQ(value(m, at(39, 100), at(38, 0)), 0);
  EXPECT_EQ(value(m, at(41, 0), at(38, 0)), 100);
}

TEST(WindowMatrices, FourDirectionsLieOnTheirSides) {
  std::string blocks;
  std::array<const char*, 4> names{"Transmission Front", "Transmission Back", "Reflection Front",
                                   "reflection back"};
  for (int k = 0; k < 4; ++k) {
    std::string n;
    for (int i = 0; i < 41 * 41; ++i)
      n += std::to_string(k + 1) + " ";
    blocks += matrix_block(names[std::size_t(k)], "LBNL/Klems Quarter", n);
  }
  const WindowBsdf m = parsed(document("Columns", {{"Visible", blocks}}));
  const Vec3d up = at(20, 30), down = -at(40, 10);
  // The front of WINDOW is z < 0, the back of Radiance z > 0.
  EXPECT_EQ(value(m, up, down), 1);   // light from z < 0 comes through: Transmission Front
  EXPECT_EQ(value(m, down, up), 2);   // light from z > 0: Transmission Back
  EXPECT_EQ(value(m, down, down), 3); // Reflection Front
  EXPECT_EQ(value(m, up, up), 4);
  EXPECT_TRUE(m.sides().reflects_front && m.sides().reflects_back && m.sides().transmits());
}

TEST(WindowMatrices, LightTheOtherWayComesByReciprocity) {
  const WindowBsdf m = parsed(document(
      "Columns", {{"Visible", matrix_block("Transmission Front", "LBNL/Klems Quarter", numbered())}}));
  for (std::uint64_t k = 0; k < 100; ++k) {
    const Vec3d up =
        square_to_cosine_hemisphere(Vec2d{double(uniform(1, k, 0, 0)), double(uniform(1, k, 1, 0))});
    const Vec3d down =
        -square_to_cosine_hemisphere(Vec2d{double(uniform(1, k, 2, 0)), double(uniform(1, k, 3, 0))});
    EXPECT_EQ(value(m, up, down), value(m, down, up));
    EXPECT_GE(value(m, up, down), 0);
  }
  EXPECT_EQ(value(m, at(1, 0), at(1, 0)), -1);
}

TEST(WindowMatrices, SamplingHasTheDensityItStatesAndFollowsTheValues) {
  std::string blocks;
  for (const char* direction : {"Transmission Front", "Reflection Back", "Reflection Front"}) {
    std::string n;
    for (std::uint64_t i = 0; i < 41 * 41; ++i) {
      const float x = uniform(std::uint64_t(direction[0]), i, 0, 0);
      n += std::to_string(x < 0.3f ? 0 : x * x * x) + " ";
    }
    blocks += matrix_block(direction, "LBNL/Klems Quarter", n);
  }
  const WindowBsdf m = parsed(document("Columns", {{"Visible", blocks}}));
  for (const Vec3d& wo : {at(30, 20), at(70, 200), -at(50, 100)}) {
    // f cos / pdf is the same number for every sample, the albedo.
    double albedo = 0, low = 1e9, high = 0;
    const int count = 4000;
    for (std::uint64_t i = 0; i < count; ++i) {
      const Vec3d wi = m.sample(wo, double(uniform(5, i, 0, 0)),
                                {double(uniform(5, i, 1, 0)), double(uniform(5, i, 2, 0))});
      const double p = m.pdf(wo, wi), f = double(value(m, wo, wi));
      ASSERT_GT(p, 0);
      const double ratio = f * std::abs(wi.z) / p;
      albedo += ratio / count;
      low = std::min(low, ratio);
      high = std::max(high, ratio);
    }
    EXPECT_NEAR(low, high, 1e-6 * high);
    // The same by the definition, over both hemispheres.
    double expected = 0, density = 0;
    const int n = 200;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        for (const double side : {1.0, -1.0}) {
          const Vec3d w = square_to_cosine_hemisphere(Vec2d{(i + 0.5) / n, (j + 0.5) / n});
          const Vec3d wi{w.x, w.y, side * w.z};
          expected += std::max(double(value(m, wo, wi)), 0.0) * pi / (n * n);
          density += m.pdf(wo, wi) / w.z * pi / (n * n);
        }
    EXPECT_NEAR(albedo, expected, 0.02 * expected);
    EXPECT_NEAR(density, 1, 0.02);
  }
}

TEST(WindowMatrices, BasesOfTheFileAreUnderstood) {
  const std::string basis =
      "<AngleBasis><AngleBasisName>mine</AngleBasisName>"
      "<AngleBasisBlock><Theta>0</Theta><nPhis>1</nPhis><ThetaBounds><LowerTheta>-10</LowerTheta>"
      "<UpperTheta>30</UpperTheta></ThetaBounds></AngleBasisBlock>"
      "<AngleBasisBlock><Theta>60</Theta><nPhis>2</nPhis><ThetaBounds><LowerTheta>30</LowerTheta>"
      "<UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>";
  const WindowBsdf m = parsed(document(
      "Columns", {{"Visible", matrix_block("Reflection Back", "mine", "0 1 2  10 11 12  20 21 22")}}, basis));
  EXPECT_EQ(value(m, at(0, 0), at(0, 0)), 0);
  EXPECT_EQ(value(m, at(60, 0), at(60, 0)), 12); // the light travels towards azimuth 180
  EXPECT_EQ(value(m, at(60, 180), at(0, 0)), 20);
}

TEST(WindowMatrices, EqualTristimulusValuesAreNeutral) {
  std::string ones;
  for (int i = 0; i < 41 * 41; ++i)
    ones += "0.2 ";
  const std::string block = matrix_block("Reflection Back", "LBNL/Klems Quarter", ones);
  const WindowBsdf m = parsed(document("Columns", {{"CIE-X", block}, {"Visible", block}, {"CIE-Z", block}}));
  std::array<float, 3> f;
  ASSERT_TRUE(m.evaluate(at(3, 3), at(3, 3), f));
  for (const float x : f)
    EXPECT_NEAR(x, 0.2f, 1e-6f);
}

/// Position k of dimension d in 8 cells of a side, as digits: a grid whose value names its place.
TEST(TensorTree, FirstDimensionIsTheSlowestOfAGridAndTheLowestBitOfABranch) {
  const auto no = [](std::size_t, const std::string& what) { throw Error(what); };
  const TensorTree grid = TensorTree::parse(3, "{ 0 1 2 3 4 5 6 7 }", no);
  EXPECT_EQ(grid.at({0.7, 0.1, 0.1, 0}), 4);
  EXPECT_EQ(grid.at({0.1, 0.7, 0.1, 0}), 2);
  EXPECT_EQ(grid.at({0.1, 0.1, 0.7, 0}), 1);
  const TensorTree tree = TensorTree::parse(3, "{{0}{1}{2}{3}{4}{5}{6}{7 8 9 10 11 12 13 14}}", no);
  EXPECT_EQ(tree.at({0.7, 0.1, 0.1, 0}), 1);
  EXPECT_EQ(tree.at({0.1, 0.7, 0.1, 0}), 2);
  EXPECT_EQ(tree.at({0.1, 0.1, 0.7, 0}), 4);
  EXPECT_EQ(tree.at({0.8, 0.6, 0.6, 0}), 11);
  EXPECT_EQ(tree.at({0.6, 0.6, 0.8, 0}), 8);
  EXPECT_EQ(tree.at({2, 2, std::nan(""), 0}), 3);
  EXPECT_EQ(tree.depth(), 2);
  EXPECT_EQ(tree.to_text(), TensorTree::parse(3, tree.to_text(), no).to_text());
}

TEST(TensorTree, VisitedCellsFillTheCubeAndHaveTheTreesValues) {
  const auto no = [](std::size_t, const std::string& what) { throw Error(what); };
  std::string grid = "{";
  for (int i = 0; i < 512; ++i)
    grid += " " + std::to_string(i);
  const TensorTree tree = TensorTree::parse(3, "{{0}{1}{2}" + grid + "}{4}{5}{6}{7 8 9 10 11 12 13 14}}", no);
  const double mean = [&] {
    double sum = 0;
    for (int v : {0, 1, 2, 4, 5, 6})
      sum += v;
    return (sum + 255.5 + 10.5) / 8;
  }();
  for (const auto& [low, high] : {std::pair{0, 10}, {3, 5}, {2, 2}, {0, 1}, {0, 0}, {1, 3}}) {
    double volume = 0, sum = 0;
    tree.visit(low, high, [&](const TensorTree::Position& lower, double side, float v) {
      volume += side * side * side;
      sum += side * side * side * double(v);
      if (high >= 10) {
        EXPECT_EQ(v, tree.at({lower[0] + side / 2, lower[1] + side / 2, lower[2] + side / 2, 0}));
      }
      EXPECT_LE(side, std::ldexp(1.0, -low));
      EXPECT_GE(side, std::ldexp(1.0, -high));
    });
    EXPECT_NEAR(volume, 1, 1e-12);
    EXPECT_NEAR(sum, mean, 1e-4);
  }
}

TEST(TensorTree, PositionsAreThoseOfRadiance) {
  // SDqueryTre: of rank 3, 1/2 - r/2 for the incident, and the outgoing turned so that the light travels to
  // azimuth 0.
  for (std::uint64_t k = 0; k < 200; ++k) {
    const Vec3d in = square_to_cosine_hemisphere(
                    Vec2d{double(uniform(1, k, 0, 0)), double(uniform(1, k, 1, 0))}),
                out = square_to_cosine_hemisphere(
                    Vec2d{double(uniform(1, k, 2, 0)), double(uniform(1, k, 3, 0))});
    const auto p3 = tensor_position(3, in, out);
    EXPECT_NEAR(p3[0], 0.5 - 0.5 * std::hypot(in.x, in.y), 1e-8);
    const double turn = std::atan2(in.y, in.x);
    const auto [i3, o3] = tensor_directions(3, p3);
    EXPECT_NEAR(o3.x, out.x * std::cos(turn) + out.y * std::sin(turn), 1e-9);
    EXPECT_NEAR(o3.y, out.y * std::cos(turn) - out.x * std::sin(turn), 1e-9);
    EXPECT_NEAR(i3.x, std::hypot(in.x, in.y), 1e-8);
    const auto [i4, o4] = tensor_directions(4, tensor_position(4, in, out));
    EXPECT_NEAR(length(i4 - in), 0, 1e-9);
    EXPECT_NEAR(length(o4 - out), 0, 1e-9);
  }
  // A mirror of rank 3: light from azimuth 180 leaves to azimuth 0, the outgoing square's side x > 1/2.
  const auto p = tensor_position(3, at(60, 0), at(60, 0));
  EXPECT_GT(p[1], 0.9);
  EXPECT_NEAR(p[2], 0.5, 1e-12);
}

TEST(WindowTrees, IsotropicOnesDependOnTheAzimuthBetween) {
  // f = 1 where the outgoing leaves forward of the incident (x > 1/2), else 2; nothing for the dead half.
  const WindowBsdf m = parsed(
      document("TensorTree3", {{"Visible", tree_block("Reflection Back", "{ {2}{9}{1}{9}{2}{9}{1}{9} }")}}));
  EXPECT_TRUE(m.is_isotropic());
  for (double phi = 0; phi < 360; phi += 17) {
    EXPECT_EQ(value(m, at(50, phi), at(40, phi + 180)), 1); // the mirror's side
    EXPECT_EQ(value(m, at(50, phi), at(40, phi)), 2);       // back to the light
    EXPECT_EQ(value(m, at(50, phi), at(40, phi + 60)), 2);
    EXPECT_EQ(value(m, at(50, phi), at(40, phi + 120)), 1);
  }
  EXPECT_EQ(value(m, at(50, 0), -at(40, 0)), -1);
}

TEST(WindowTrees, ChromaticitiesGiveTheColour) {
  // u', v' of the sRGB primaries' sum in equal parts: red alone is (0.4507, 0.5229), relative to D65.
  const auto uv = [](const XYZ& xyz) {
    const double sum = xyz[0] + 15 * xyz[1] + 3 * xyz[2];
    return std::pair{4 * xyz[0] / sum, 9 * xyz[1] / sum};
  };
  const XYZ white = srgb_to_xyz * RGB{1, 1, 1};
  XYZ xyz = srgb_to_xyz * RGB{0.3, 0.1, 0.2};
  for (std::size_t c = 0; c < 3; ++c)
    xyz[c] /= white[c];
  const auto [u, v] = uv(xyz);
  const WindowBsdf m = parsed(
      document("TensorTree4", {{"Visible", tree_block("Reflection Back", "{" + std::to_string(xyz[1]) + "}")},
                               {"CIE-u", tree_block("Reflection Back", "{" + std::to_string(u) + "}")},
                               {"CIE-v", tree_block("Reflection Back", "{" + std::to_string(v) + "}")}}));
  std::array<float, 3> f;
  ASSERT_TRUE(m.evaluate(at(10, 0), at(10, 0), f));
  EXPECT_NEAR(f[0], 0.3f, 1e-4f);
  EXPECT_NEAR(f[1], 0.1f, 1e-4f);
  EXPECT_NEAR(f[2], 0.2f, 1e-4f);
}

TEST(WindowXml, ADocumentOfItIsRecognised) {
  const std::string window = document("Columns", {}),
                    scene = "<?xml version=\"1.0\"?><scene version=\"3.0.0\"/>";
  const auto bytes = [](const std::string& s) {
    return std::span(reinterpret_cast<const std::uint8_t*>(s.data()), s.size());
  };
  EXPECT_TRUE(recognises_window_xml(bytes(window)));
  EXPECT_FALSE(recognises_window_xml(bytes(scene)));
  EXPECT_THAT(message_of(scene),
              AllOf(HasSubstr("x.xml:1:"), HasSubstr("WindowElement"), HasSubstr("scene")));
}

TEST(WindowXml, WhatIsWrongIsNamedWithLineAndColumn) {
  const auto grey = [](const std::string& tree) {
    return document("TensorTree3", {{"Visible", tree_block("Reflection Back", tree)}});
  };
  EXPECT_THAT(message_of("<WindowElement>"), HasSubstr("x.xml:1:"));
  EXPECT_THAT(message_of("<WindowElement></WindowElement>"), HasSubstr("no <Optical>"));
  EXPECT_THAT(message_of(document("Collumns", {})), HasSubstr("did you mean 'Columns'"));
  EXPECT_THAT(message_of(document("Columns", {})), HasSubstr("no <WavelengthData>"));
  EXPECT_THAT(message_of(document("Columns", {{"Solar", ""}})),
              AllOf(HasSubstr("Visible"), HasSubstr("Solar")));
  EXPECT_THAT(message_of(grey("{ 1 2 3 }")), AllOf(HasSubstr("x.xml:6:"), HasSubstr("3 values")));
  EXPECT_THAT(message_of(grey("{ 1")), HasSubstr("x.xml:6:"));
  EXPECT_THAT(message_of(grey("{ 1 } 2")), HasSubstr("end of the tree"));
  EXPECT_THAT(message_of(grey("{ nan }")), HasSubstr("finite"));
  EXPECT_THAT(message_of(grey("{ 1e99 }")), HasSubstr("finite"));
  EXPECT_THAT(message_of(grey(std::string(100, '{'))), HasSubstr("deeper"));
  EXPECT_THAT(message_of(document("TensorTree3", {{"Visible", tree_block("Reflektion Back", "{1}")}})),
              HasSubstr("did you mean 'Reflection Back'"));
  EXPECT_THAT(
      message_of(document("Columns", {{"Visible", matrix_block("Reflection Back", "LBNL/Klems Fool", "1")}})),
      HasSubstr("did you mean 'LBNL/Klems Full'"));
  EXPECT_THAT(
      message_of(document("Columns", {{"Visible", matrix_block("Reflection Back", "LBNL/Klems Full", "1")}})),
      HasSubstr("145 x 145"));
  EXPECT_THAT(message_of(document(
                  "Columns",
                  {{"Visible", matrix_block("Reflection Back", "LBNL/Klems Quarter", numbered() + " 7")}})),
              HasSubstr("more than 41 x 41"));
  const std::string block = tree_block("Reflection Back", "{1}");
  EXPECT_THAT(message_of(document("TensorTree4", {{"Visible", block + block}})), HasSubstr("second block"));
  EXPECT_THAT(message_of(document("TensorTree4", {{"Visible", block + tree_block("Reflection Front", "{1}")},
                                                  {"CIE-u", block},
                                                  {"CIE-v", block}})),
              HasSubstr("not CIE-u"));
}

TEST(WindowXml, MatricesAndTreesSurviveTheRoundTrip) {
  const MerlTable table = glossy_table(0.3, 24, 30);
  for (const bool as_matrix : {true, false}) {
    const WindowBsdf m = as_matrix
                             ? make_klems(table, KlemsBasis::standard()[1])
                             : make_tensor_tree(table, {.relative = 0.2, .first_level = 3, .last_level = 5});
    const auto bytes = encode_window_xml(m);
    ASSERT_TRUE(recognises_window_xml(bytes));
    const WindowBsdf back = parse_window_xml(bytes, "back.xml");
    EXPECT_EQ(back.facts(), m.facts());
    EXPECT_EQ(encode_window_xml(back), bytes);
    for (std::uint64_t k = 0; k < 300; ++k) {
      const Vec3d wo = square_to_cosine_hemisphere(
                      Vec2d{double(uniform(1, k, 0, 0)), double(uniform(1, k, 1, 0))}),
                  wi = square_to_cosine_hemisphere(
                      Vec2d{double(uniform(1, k, 2, 0)), double(uniform(1, k, 3, 0))});
      std::array<float, 3> f, g;
      EXPECT_TRUE(m.evaluate(wo, wi, f) && back.evaluate(wo, wi, g));
      EXPECT_EQ(f, g);
    }
  }
}

/// Anisotropic, coloured, on both sides, in closed form.
class Brushed final : public MeasuredBsdf {
public:
  std::string kind() const override { return "brushed"; }
  std::vector<std::pair<std::string, std::string>> facts() const override { return {}; }
  const Channels& channels() const override {
    static const Channels rgb = Channels::rgb();
    return rgb;
  }
  bool is_isotropic() const override { return false; }
  MeasuredSides sides() const override { return {true, false, false, true}; }
  bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const override {
    std::fill_n(f.begin(), 3, 0.0f);
    if (!sides().contain(wo, wi)) return false;
    const Vec3d in{wi.x, wi.y, std::abs(wi.z)}, out{wo.x, wo.y, std::abs(wo.z)};
    const Vec3d h = normalize(in + out);
    const double lobe = std::exp(-sqr(h.x / 0.5) - sqr(h.y / 0.25));
    const double side = wo.z > 0 ? 1 : 0.5;
    f[0] = float(side * (0.1 + 0.5 * lobe));
    f[1] = float(side * (0.1 + 0.4 * lobe));
    f[2] = float(side * (0.2 + 0.2 * lobe));
    return true;
  }
  MeasuredSamples samples() const override { return {}; }
};

TEST(WindowXml, ATensorTreeIsWithinItsTolerance) {
  const MerlTable table = glossy_table(0.4, 24, 30);
  const Brushed brushed;
  for (const MeasuredBsdf* m :
       {static_cast<const MeasuredBsdf*>(&table), static_cast<const MeasuredBsdf*>(&brushed)}) {
    const double relative = m == &table ? 0.1 : 0.25;
    const TensorTreeTolerance t{.relative = relative, .first_level = 3, .last_level = m == &table ? 7 : 5};
    const WindowBsdf tree = make_tensor_tree(*m, t);
    EXPECT_EQ(tree.is_isotropic(), m->is_isotropic());
    EXPECT_EQ(tree.sides().reflects_front, m->sides().reflects_front);
    EXPECT_EQ(tree.sides().transmits_to_back, m->sides().transmits_to_back);
    int far = 0, count = 0;
    for (std::uint64_t k = 0; k < 4000; ++k) {
      const Vec3d wo =
          square_to_cosine_hemisphere(Vec2d{double(uniform(1, k, 0, 0)), double(uniform(1, k, 1, 0))});
      Vec3d wi = square_to_cosine_hemisphere(Vec2d{double(uniform(1, k, 2, 0)), double(uniform(1, k, 3, 0))});
      if (wo.z < 0.1 || wi.z < 0.1) continue; // the table holds its last value near the horizon
      const bool through = m->sides().transmits() && k % 2 == 0;
      const Vec3d out = through ? Vec3d{wo.x, wo.y, -wo.z} : wo;
      std::array<float, 3> f, g;
      ASSERT_TRUE(m->evaluate(out, wi, f) && tree.evaluate(out, wi, g));
      ++count;
      // Between the points looked at, f may differ by a little more.
      const double largest = double(std::max({f[0], f[1], f[2]}));
      for (std::size_t c = 0; c < 3; ++c)
        far += std::abs(double(f[c] - g[c])) > 1.5 * relative * largest + 1e-3;
    }
    EXPECT_LT(far, count / 100) << m->kind(); // of 3 count
  }
}

TEST(WindowXml, MeansOverPatchesKeepTheAlbedo) {
  const Brushed brushed;
  const WindowBsdf m = make_klems(brushed, KlemsBasis::standard()[0]);
  for (const Vec3d& wo : {KlemsBasis::standard()[0].direction(20, {.5, .5}), Vec3d{0, 0, 1}}) {
    double expected = 0, found = 0;
    const int n = 128;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const Vec3d wi = square_to_cosine_hemisphere(Vec2d{(i + 0.5) / n, (j + 0.5) / n});
        expected += brushed.rgb(wo, wi)[1];
        found += m.rgb(wo, wi)[1];
      }
    EXPECT_NEAR(found / expected, 1, 0.02);
  }
}

TEST(WindowXml, SamplesAreTheValuesOfPatchesAndWeighTheHemispheres) {
  const MerlTable table = glossy_table(0.5, 24, 30);
  const Brushed brushed;
  const std::vector<WindowBsdf> all = [&] {
    std::vector<WindowBsdf> v;
    v.push_back(make_klems(table, KlemsBasis::standard()[2]));
    v.push_back(make_tensor_tree(table, {.relative = 0.3, .first_level = 3, .last_level = 5}));
    v.push_back(make_tensor_tree(brushed, {.relative = 0.3, .first_level = 3, .last_level = 4}));
    return v;
  }();
  for (const WindowBsdf& m : all) {
    const MeasuredSamples s = m.samples();
    ASSERT_EQ(s.f.size(), 3 * s.size());
    double weight = 0;
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
      weight += s.weight[i];
      const auto wide = [](const Vec3f& w) { return Vec3d{double(w.x), double(w.y), double(w.z)}; };
      std::array<float, 3> f;
      ASSERT_TRUE(m.evaluate(wide(s.wo[i]), wide(s.wi[i]), f));
      wrong += std::abs(f[1] - s.f[3 * i + 1]) > 1e-5f;
    }
    EXPECT_LE(wrong, s.size() / 200) << m.kind(); // float directions that fall beyond an edge
    const double blocks = m.sides().transmits() ? 2 : 1;
    EXPECT_NEAR(weight, blocks * sqr(2 * pi), 1e-9 * sqr(2 * pi)) << m.kind();
  }
}

TEST(WindowXml, MutatedFilesGiveScatteringOrAnError) {
  std::vector<std::vector<std::uint8_t>> seeds;
  for (const std::string& s :
       {document("TensorTree3",
                 {{"Visible", tree_block("Reflection Back", "{{0}{1}{2}{3}{4}{5}{6}{7 8 9 10 11 12 13 "
                                                            "14}}") +
                                  tree_block("Transmission Front", "{ .5 }")}}),
        document(
            "Columns", {{"Visible", matrix_block("Reflection Back", "b", "0 1 2  10 11 12  20 21 22")}},
            "<AngleBasis><AngleBasisName>b</AngleBasisName><AngleBasisBlock><nPhis>1</nPhis><ThetaBounds>"
            "<UpperTheta>30</UpperTheta></ThetaBounds></AngleBasisBlock><AngleBasisBlock><nPhis>2</nPhis>"
            "<ThetaBounds><LowerTheta>30</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></"
            "AngleBasisBlock>"
            "</AngleBasis>")})
    seeds.emplace_back(s.begin(), s.end());
  int read = 0, errors = 0;
  for (int n = 0; n < 20000; ++n) {
    auto bytes = seeds[std::size_t(n) % seeds.size()];
    auto random = [&, d = 0](std::size_t below) mutable { return hash(42, n, d++) % below; };
    for (std::size_t edits = 1 + random(3); edits > 0; --edits) {
      const auto place = [&] { return bytes.begin() + std::ptrdiff_t(random(bytes.size())); };
      switch (random(6)) {
      case 0:
        bytes.resize(1 + random(bytes.size()));
        break;
      case 1:
        *place() = std::uint8_t(random(256));
        break;
      case 2: {
        static constexpr std::string_view interesting = "{}<>/-e9.0 ,&";
        *place() = std::uint8_t(interesting[random(interesting.size())]);
        break;
      }
      case 3:
        bytes.erase(place());
        break;
      case 4: { // a piece twice
        const std::size_t from = random(bytes.size()),
                          size = std::min<std::size_t>(random(60), bytes.size() - from);
        const std::vector<std::uint8_t> piece(bytes.begin() + std::ptrdiff_t(from),
                                              bytes.begin() + std::ptrdiff_t(from + size));
        bytes.insert(place(), piece.begin(), piece.end());
        break;
      }
      default:
        *place() ^= std::uint8_t(1u << random(8));
      }
    }
    try {
      const WindowBsdf m = parse_window_xml(bytes, "mutant");
      const float f = value(m, at(20, 30), at(50, 80));
      ASSERT_TRUE(f == -1 || (f >= 0 && std::isfinite(f))) << "mutant " << n;
      m.samples();
      ++read;
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(read, 200);
  EXPECT_GT(errors, 500);
}

TEST(WindowXml, IsAmongTheFormats) {
  const auto& formats = measured_formats();
  const auto window =
      std::find_if(formats.begin(), formats.end(), [](const auto& f) { return f.name == "window"; });
  ASSERT_NE(window, formats.end());
  EXPECT_EQ(window->endings.front(), ".xml");
  EXPECT_TRUE(is_measured_file("blind.XML"));
}

} // namespace
} // namespace nacre
