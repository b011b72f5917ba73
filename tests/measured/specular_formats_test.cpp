// Integra and Zemax: tables about the specular direction.

#include "analytic.h"
#include "core/error.h"
#include "measured/angle_grid.h"
#include "measured/formats.h"
#include "measured/formats/integra.h"
#include "measured/formats/scatter_csv.h"
#include "measured/formats/zemax.h"
#include "mutated_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

namespace nacre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

struct Axes {
  std::vector<double> psi{0}, sigma{0, 20, 40, 60, 80}, phi{0, 30, 60, 90, 120, 150, 180},
      theta{0, 2, 5, 10, 20, 40, 80, 120, 170};
  std::vector<double> sigma_t{};
};
/// The direction at these angles in degrees about the specular one, from the formats' words: start at the
/// specular direction, turn by theta towards the normal, then by phi counter-clockwise about the specular
/// direction.
Vec3d about_specular(double psi, double specular, double phi, double theta) {
  const Vec3d s = at_degrees(specular, psi + 180);
  const Vec3d towards_normal =
      at_degrees(90 - specular, psi); // perpendicular to s, in the plane of incidence
  const Vec3d side = cross(s, towards_normal);
  const double t = theta * pi / 180, p = phi * pi / 180;
  return s * std::cos(t) + (towards_normal * std::cos(p) + side * std::sin(p)) * std::sin(t);
}
template <class F>
std::string values(const Axes& a, F f) {
  std::string text;
  for (const double psi : a.psi)
    for (std::size_t i = 0; i < a.sigma.size(); ++i)
      for (const double phi : a.phi) {
        for (const double theta : a.theta) {
          Vec3d wo = about_specular(psi, a.sigma_t.empty() ? a.sigma[i] : a.sigma_t[i], phi, theta);
          wo.z = std::max(wo.z, 1e-2);
          text += fmt::format(" {}", f(wo, at_degrees(a.sigma[i], psi)));
        }
        text += '\n';
      }
  return text;
}
std::string angles(const char* name, const std::vector<double>& a) {
  return fmt::format("{} {}\n {}\n", name, a.size(), fmt::join(a, " "));
}
template <class F>
std::string ddr(const Axes& a, F f, const std::string& symmetry = "PlaneSymmetrical",
                const std::string& data = "Luminance Absolute", const std::string& kbdf = "") {
  std::string text = ";; made for a test\nSource Measured\nTypeSym " + symmetry +
                     " ; remark\nTypeColorModel BW\nTypeData " + data + "\n";
  if (a.psi.size() > 1) text += angles("psi", a.psi);
  text += angles("sigma", a.sigma);
  if (!a.sigma_t.empty()) text += fmt::format("sigmat\n {}\n", fmt::join(a.sigma_t, " "));
  return text + angles("phi", a.phi) + angles("theta", a.theta) + "bw\n" + kbdf + "def\n;; Sigma = 0\n" +
         values(a, f) + "enddef\n";
}
std::shared_ptr<const MeasuredBsdf> read(const std::string& text, bool transmits = false) {
  return parse_integra(bytes_of(text), "x.ddr", transmits);
}
std::string integra_error(const std::string& text) {
  return message_of([](const Bytes& b, std::string_view name) { return parse_integra(b, name, false); },
                    bytes_of(text));
}
std::string zemax_error(const std::string& text) { return message_of(parse_zemax, bytes_of(text)); }
double times_pi(const Vec3d& wo, const Vec3d& wi) { return pi * Glossy{}(wo, wi); }

TEST(IntegraFormat, NodesLieAboutTheSpecularDirection) {
  const Axes a;
  const auto m = read(ddr(a, times_pi));
  EXPECT_TRUE(m->is_isotropic());
  for (const double sigma : {20.0, 60.0})
    for (const double phi : {0.0, 60.0, 180.0, 300.0}) // the last by symmetry
      for (const double theta : {0.0, 5.0, 20.0}) {
        const Vec3d wo = about_specular(0, sigma, phi, theta), wi = at_degrees(sigma, 0);
        EXPECT_NEAR(grey(*m, wo, wi), Glossy{}(wo, wi), 1e-4 * Glossy{}(wo, wi))
            << sigma << ' ' << phi << ' ' << theta;
        // Turned with the plane of incidence.
        EXPECT_NEAR(grey(*m, about_specular(77, sigma, phi, theta), at_degrees(sigma, 77)), Glossy{}(wo, wi),
                    1e-4 * Glossy{}(wo, wi));
      }
  EXPECT_EQ(grey(*m, at_degrees(10, 0), at_degrees(85, 0)), -1);
}

TEST(IntegraFormat, AnisotropicDataFollowsTheAzimuthOfIncidence) {
  Axes a;
  a.psi = {0, 45, 90, 135, 180, 225, 270, 315, 360};
  a.phi = {0, 45, 90, 135, 180, 225, 270, 315, 360};
  const Glossy brushed{0.2, 0.5};
  const auto m = read(ddr(
      a, [&](auto& o, auto&& i) { return pi * brushed(o, i); }, "ASymmetrical 4D"));
  EXPECT_FALSE(m->is_isotropic());
  Axes one = a; // symmetrical about the direction of incidence: nothing is mirrored
  one.psi = {0};
  EXPECT_TRUE(read(ddr(
                       one, [](auto&&, auto&&) { return 1; }, "DirSymmetrical"))
                  ->is_isotropic());
  for (const double psi : {0.0, 45.0, 270.0})
    for (const double phi : {0.0, 90.0, 315.0}) {
      const Vec3d wo = about_specular(psi, 40, phi, 10), wi = at_degrees(40, psi);
      EXPECT_NEAR(grey(*m, wo, wi), brushed(wo, wi), 1e-4 * brushed(wo, wi));
    }
}

TEST(IntegraFormat, UnitsAndFactorsGiveF) {
  Axes a;
  a.sigma = {0, 30, 60};
  const auto one = [](const Vec3d&, const Vec3d&) { return 1.0; };
  const Vec3d wo = at_degrees(30, 100), wi = at_degrees(30, 0);
  EXPECT_NEAR(grey(*read(ddr(a, one)), wo, wi), inv_pi, 1e-6);
  EXPECT_NEAR(
      grey(*read(ddr(a, one, "PlaneSymmetrical", "Luminance Absolute", "kbdf 0.1 0.5 0.9\n")), wo, wi),
      0.5 * inv_pi, 1e-6);
  const auto intensity = [](const Vec3d& o, const Vec3d&) { return o.z; };
  EXPECT_NEAR(grey(*read(ddr(a, intensity, "PlaneSymmetrical", "Intensity Absolute")),
                   about_specular(0, 30, 60, 20), wi),
              1, 1e-5);
  // Relative data scatters the stated share: that of Lambert gives share / pi.
  const auto relative = read(ddr(
      a, [](auto&&, auto&&) { return 17.0; }, "PlaneSymmetrical", "Luminance Relative",
      "kbdf 0.1 0.5 0.9\n"));
  EXPECT_NEAR(grey(*relative, wo, wi), 0.5 * inv_pi, 0.02 * inv_pi);
}

TEST(IntegraFormat, TransmissionIsCentredOnTheRefractedRay) {
  Axes a;
  for (const double s : a.sigma)
    a.sigma_t.push_back(std::asin(std::sin(s * pi / 180) / 1.5) * 180 / pi);
  // A narrow peak in the refracted direction, as a value that depends on the angle from it alone.
  const auto m = read(ddr(a, [](auto&&, auto&&) { return pi; }), true);
  EXPECT_TRUE(m->sides().transmits_to_back && !m->sides().reflects_front);
  EXPECT_NEAR(grey(*m, at_degrees(180 - a.sigma_t[2], 180), at_degrees(40, 0)), 1, 1e-5);
  std::string peaked = ddr(a, [](auto&&, auto&&) { return 0; });
  for (std::size_t at = peaked.find("\n 0 0", peaked.find("def")); at != std::string::npos;
       at = peaked.find("\n 0 0", at + 1))
    peaked[at + 2] = '9'; // theta = 0
  const auto p = read(peaked, true);
  EXPECT_NEAR(grey(*p, at_degrees(180 - a.sigma_t[2], 180), at_degrees(40, 0)), 9 * inv_pi, 1e-3);
  const double between = std::asin(std::sin(50 * pi / 180) / 1.5) * 180 / pi; // nearly linear in theta_i
  EXPECT_GT(grey(*p, at_degrees(180 - between, 180), at_degrees(50, 0)), 5 * inv_pi);
}

TEST(IntegraFormat, WavelengthsMayComeInAnyOrder) {
  const std::string head =
      "TypeSym AxiSymmetrical\nTypeColorModel spectral 2\nsigma 2 0 90 phi 1 0 theta 2 0 180\n";
  const auto m = read(head + "wl 600 def 3 3 3 3 enddef wl 500 def 1 1 1 1 enddef");
  EXPECT_EQ(m->channels().wavelengths_nm(), (std::vector<double>{500, 600}));
  std::array<float, 2> f;
  ASSERT_TRUE(m->evaluate(at_degrees(30, 50), at_degrees(20, 0), f));
  EXPECT_NEAR(f[0], inv_pi, 1e-6);
  EXPECT_NEAR(f[1], 3 * inv_pi, 1e-6);
}

TEST(IntegraFormat, FaultsAreNamedWithTheirLineAndColumn) {
  EXPECT_THAT(integra_error(""), AllOf(HasSubstr("x:1:1"), HasSubstr("keyword")));
  EXPECT_THAT(integra_error("TypeSim x"), AllOf(HasSubstr("x:1:1"), HasSubstr("did you mean 'TypeSym'")));
  EXPECT_THAT(integra_error("TypeSym\n PointSymmetrical"), AllOf(HasSubstr("x:2:2"), HasSubstr("symmetry")));
  EXPECT_THAT(integra_error("sigma 2 0\n 91 "), AllOf(HasSubstr("x:2:2"), HasSubstr("'91'")));
  EXPECT_THAT(integra_error("sigma 3 0 20 10"), AllOf(HasSubstr("x:1:14"), HasSubstr("increasing")));
  EXPECT_THAT(integra_error("sigma 4000000000 0 1"), AllOf(HasSubstr("x:1:7"), HasSubstr("'4000000000'")));
  EXPECT_THAT(integra_error("sigma -1"), HasSubstr("'-1'"));
  EXPECT_THAT(integra_error("sigma 1 0 phi 1 0\nbw"), HasSubstr("no angles theta"));
  EXPECT_THAT(integra_error("TypeColorModel BW sigma 1 0 phi 1 0 theta 1 0\nbw def"), HasSubstr("x:2:7"));
  EXPECT_THAT(integra_error("TypeColorModel BW sigma 1 0 phi 1 0 theta 1 0\nbw def x enddef"),
              AllOf(HasSubstr("x:2:8"), HasSubstr("'x'")));
  EXPECT_THAT(integra_error("TypeColorModel BW sigma 1 0 phi 1 0 theta 1 0\nbw def inf enddef"),
              HasSubstr("x:2:8"));
  EXPECT_THAT(integra_error("TypeColorModel BW sigma 1 0 phi 1 0 theta 1 0\nbw def 1 2"),
              AllOf(HasSubstr("x:2:10"), HasSubstr("enddef")));
  EXPECT_THAT(integra_error("TypeColorModel BW sigma 1 0 phi 1 0 theta 1 0\nbw def 1 enddef 2"),
              AllOf(HasSubstr("x:2:17"), HasSubstr("end of the file")));
}

template <class F>
std::string zemax(const Axes& a, F f, const std::string& symmetry = "PlaneSymmetrical",
                  const std::string& type = "BRDF") {
  std::string text = "# made for a test\nSource\tMeasured\nSymmetry\t" + symmetry +
                     "\nSpectralContent\tMonochrome\nScatterType\t" + type + "\n" +
                     angles("SampleRotation", a.psi) + angles("AngleOfIncidence", a.sigma) +
                     angles("ScatterAzimuth", a.phi) + angles("ScatterRadial", a.theta) +
                     "\nMonochrome\nDataBegin\n";
  for (const double psi : a.psi)
    for (const double sigma : a.sigma) {
      Axes one = a;
      one.psi = {psi};
      one.sigma = {sigma};
      text += "TIS 0.5\n" + values(one, f);
    }
  return text + "DataEnd\n";
}

TEST(ZemaxFormat, NodesLieAboutTheSpecularDirection) {
  const auto m = parse_zemax(bytes_of(zemax(Axes{}, Glossy{})), "x.bsdf");
  for (const double sigma : {20.0, 60.0})
    for (const double phi : {0.0, 60.0, 180.0, 300.0})
      for (const double theta : {0.0, 5.0, 20.0}) {
        const Vec3d wo = about_specular(0, sigma, phi, theta), wi = at_degrees(sigma, 0);
        EXPECT_NEAR(grey(*m, wo, wi), Glossy{}(wo, wi), 1e-4 * Glossy{}(wo, wi));
      }
  Axes turned;
  turned.psi = {0, 45, 90, 135, 180, 225, 270, 315};
  turned.phi = {0, 45, 90, 135, 180, 225, 270, 315};
  const Glossy brushed{0.2, 0.5};
  const auto aniso = parse_zemax(bytes_of(zemax(turned, brushed, "Asymmetrical4D")), "x.bsdf");
  const Vec3d wo = about_specular(135, 40, 225, 10), wi = at_degrees(40, 135);
  EXPECT_NEAR(grey(*aniso, wo, wi), brushed(wo, wi), 1e-4 * brushed(wo, wi));
  const auto through = parse_zemax(bytes_of(zemax(
                                       Axes{}, [](auto&&, auto&&) { return 2; }, "PlaneSymmetrical", "BTDF")),
                                   "x");
  EXPECT_NEAR(grey(*through, at_degrees(150, 180), at_degrees(30, 0)), 2, 1e-6);
  EXPECT_EQ(grey(*through, at_degrees(30, 180), at_degrees(30, 0)), -1);
}

TEST(ZemaxFormat, TristimulusValuesBecomeLinearRgb) {
  const std::string head =
      "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent XYZ\nScatterType BRDF\n"
      "SampleRotation 1 0 AngleOfIncidence 2 0 80 ScatterAzimuth 1 0 ScatterRadial 2 0 170\n";
  const auto m = parse_zemax(
      bytes_of(head + "TristimulusX DataBegin TIS 0 .95047 .95047 TIS 0 .95047 .95047 DataEnd\n"
                      "TristimulusY DataBegin TIS 0 1 1 TIS 0 1 1 DataEnd\n"
                      "TristimulusZ DataBegin TIS 0 1.08883 1.08883 TIS 0 1.08883 1.08883 DataEnd\n"),
      "x");
  std::array<float, 3> f;
  ASSERT_TRUE(m->evaluate(at_degrees(30, 50), at_degrees(20, 0), f));
  for (const float x : f)
    EXPECT_NEAR(x, 1, 2e-3);
}

TEST(ZemaxFormat, WhatIsWrittenReadsBack) {
  const auto m = parse_zemax(bytes_of(zemax(Axes{}, Glossy{})), "x");
  const auto back = parse_zemax(encode_zemax(*m), "x");
  EXPECT_EQ(m->samples().f, back->samples().f);
  EXPECT_EQ(m->samples().size(), back->samples().size());
  // The share of Lambert's light in the file is its reflectance, but for the rim that no node reaches.
  const Bytes lambert =
      encode_zemax(*parse_zemax(bytes_of(zemax(Axes{}, [](auto&&, auto&&) { return 0.8 * inv_pi; })), "x"));
  double tis = 0;
  const std::string text(lambert.begin(), lambert.end());
  ASSERT_EQ(std::sscanf(text.c_str() + text.find("TIS\t"), "TIS\t%lf", &tis), 1);
  EXPECT_NEAR(tis, 0.8, 0.01);
  // Others are resampled about the specular direction.
  AngleGrid::Nodes nodes;
  for (int i = 0; i <= 88; i += 4)
    nodes.theta_i.push_back(i * pi / 180);
  nodes.phi_i = {0};
  nodes.theta_o = nodes.theta_i;
  for (int l = 0; l < 36; ++l)
    nodes.phi_o.push_back(l * pi / 18);
  nodes.holds_beyond_ends = true;
  std::vector<float> rgb;
  for (const double i : nodes.theta_i)
    for (const double o : nodes.theta_o)
      for (const double p : nodes.phi_o)
        for (int c = 1; c <= 3; ++c)
          rgb.push_back(
              float(c * Glossy{}(at_degrees(o * 180 / pi, p * 180 / pi), at_degrees(i * 180 / pi, 0))));
  const AngleGrid grid(nodes, Channels::rgb(), rgb, "test");
  const auto resampled = parse_zemax(encode_zemax(grid), "x");
  for (std::uint64_t n = 0; n < 200; ++n) {
    const Vec3d wo = random_direction(2 * n, 60), wi = random_direction(2 * n + 1, 60);
    const auto a = grid.rgb(wo, wi), b = resampled->rgb(wo, wi);
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(a[c], b[c], 0.1 * a[c] + 0.01);
  }
}

TEST(ZemaxFormat, IsToldFromOtherFilesWithItsEnding) {
  EXPECT_TRUE(is_zemax(bytes_of(zemax(Axes{}, Glossy{}))));
  EXPECT_TRUE(is_zemax(bytes_of("\n# remark\n  symmetry PlaneSymmetrical")));
  EXPECT_FALSE(is_zemax(bytes_of("tensor_file\n")));
  EXPECT_FALSE(is_zemax({}));
}

TEST(ZemaxFormat, FaultsAreNamedWithTheirLineAndColumn) {
  const std::string good = zemax(Axes{}, Glossy{});
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return zemax_error(text);
  };
  EXPECT_EQ(zemax_error(good), "no error");
  EXPECT_THAT(with("PlaneSymmetrical", "PlainSymmetrical"),
              AllOf(HasSubstr("x:3:10"), HasSubstr("did you mean 'PlaneSymmetrical'")));
  EXPECT_THAT(with("BRDF", "BXDF"), HasSubstr("x:5:13"));
  EXPECT_THAT(with("AngleOfIncidence 5", "AngleOfIncidence 4"), HasSubstr("x:9:13: expected a keyword"));
  EXPECT_THAT(with("AngleOfIncidence 5", "AngleOfIncidence 99999999"), HasSubstr("'99999999'"));
  EXPECT_THAT(with("0 20 40 60 80", "0 20 40 60 95"), HasSubstr("'95'"));
  EXPECT_THAT(with("DataBegin", "Begin"), HasSubstr("DataBegin"));
  EXPECT_THAT(with("TIS 0.5", "TIS x"), AllOf(HasSubstr(":5:"), HasSubstr("'x'")));
  EXPECT_THAT(with("DataEnd", "1"), HasSubstr("DataEnd"));
  EXPECT_THAT(with("DataEnd\n", "DataEnd\n7"), HasSubstr("end of the file"));
  EXPECT_THAT(with("Monochrome\nDataBegin", "TristimulusX\nDataBegin"), HasSubstr("Monochrome"));
}

TEST(IntegraFormat, MutatedFilesGiveATableOrAnError) {
  Axes a;
  a.sigma = {0, 45, 80};
  a.theta = {0, 10, 90};
  const std::string text = ddr(a, times_pi, "PlaneSymmetrical", "Intensity Relative", "kbdf 0.1 0.2 0.3\n");
  for (const bool transmits : {false, true})
    expect_measurement_or_error(
        bytes_of(text), [&](const Bytes& b) { return parse_integra(b, "mutant", transmits); }, 5000, 250);
}

TEST(ZemaxFormat, MutatedFilesGiveATableOrAnError) {
  Axes a;
  a.sigma = {0, 45, 80};
  a.theta = {0, 10, 90};
  expect_measurement_or_error(
      bytes_of(zemax(a, Glossy{})), [](const Bytes& b) { return parse_zemax(b, "mutant"); }, 5000, 300);
}

} // namespace
} // namespace nacre
