// ASTM and CSV: lists of samples.

#include "analytic.h"
#include "core/error.h"
#include "measured/angle_grid.h"
#include "measured/formats.h"
#include "measured/formats/astm.h"
#include "measured/formats/sample_rows.h"
#include "measured/formats/scatter_csv.h"
#include "measured/scattered_bsdf.h"
#include "mutated_files.h"
#include "synthetic_tables.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace nacre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Rows of a scan with light from azimuth 0, in degrees times `unit`.
template <class F>
std::string rows(F f, double unit = 1, const char* separator = ",") {
  std::string text;
  for (int theta_i = 0; theta_i <= 60; theta_i += 20)
    for (int phi = 0; phi <= 180; phi += 30)
      for (int theta_s = 0; theta_s <= 80; theta_s += 10)
        text += fmt::format("{1}{0}{2}{0}{3}{0}{4}{0}{5}\n", separator, theta_i * unit, 0, theta_s * unit,
                            phi * unit, f(at_degrees(theta_s, phi), at_degrees(theta_i, 0)));
  return text;
}
std::string astm(const std::string& vars, const std::string& body) {
  return "LAB_NAME Someone\nMEAS_NAME BRDF\nNUM_POINTS 2\nVARS " + vars + "\n" + body;
}
std::shared_ptr<const MeasuredBsdf> read_astm(const std::string& text) {
  return parse_astm(bytes_of(text), "x.astm");
}
std::string astm_error(const std::string& text) { return message_of(parse_astm, bytes_of(text)); }
std::string csv_error(const std::string& text) { return message_of(parse_scatter_csv, bytes_of(text)); }

TEST(AstmFormat, SamplesAreReadInAnyOrderOfColumnsSeparatorsAndLineEnds) {
  const Glossy f;
  const auto check = [&](const MeasuredBsdf& m) {
    EXPECT_TRUE(m.is_isotropic());
    for (const int phi : {0, 60, 180, 300})
      EXPECT_NEAR(grey(m, at_degrees(50, phi), at_degrees(40, 0)), f(at_degrees(50, phi), at_degrees(40, 0)),
                  1e-4);
  };
  check(*read_astm(astm("theta_i,phi_i,theta_s,phi_s,BSDF", rows(f))));
  check(*read_astm(astm("Theta_I, Phi_i, theta_r, phi_r, anything", rows(f, 1, " \t"))));
  std::string dos;
  for (const char c : astm("theta_i,phi_i,theta_s,phi_s,BRDF", rows(f)))
    dos += c == '\n' ? "\r\n" : std::string(1, c);
  check(*read_astm(dos));
  std::string turned;
  for (int theta_i = 0; theta_i <= 60; theta_i += 20)
    for (int phi = 0; phi <= 180; phi += 30)
      for (int theta_s = 0; theta_s <= 80; theta_s += 10)
        turned += fmt::format("{},{},{},0,{}\n", f(at_degrees(theta_s, phi), at_degrees(theta_i, 0)), phi,
                              theta_s, theta_i);
  check(*read_astm(astm("BSDF,phi_s,theta_s,phi_i,theta_i", turned)));
}

TEST(AstmFormat, KeywordsMayBeSetApartByColonOrEqualsSign) {
  std::string text = astm("theta_i,phi_i,theta_s,phi_s,BSDF", rows(Glossy{}));
  text.replace(text.find("NUM_POINTS 2"), 12, "NUM_POINTS = 2");
  text.replace(text.find("VARS "), 5, "VARS : ");
  EXPECT_TRUE(read_astm(text)->is_isotropic());
}

TEST(AstmFormat, RadiansAreToldByTheirSize) {
  const auto m = read_astm(astm("theta_i,phi_i,theta_s,phi_s,BSDF", rows(Glossy{}, pi / 180)));
  const Vec3d wo = at_degrees(50, 150), wi = at_degrees(40, 0);
  EXPECT_NEAR(grey(*m, wo, wi), Glossy{}(wo, wi), 1e-4);
}

TEST(AstmFormat, CosineCorrectedValuesAreDividedByTheCosine) {
  const auto times_cosine = [](const Vec3d& wo, const Vec3d&) { return 0.25 * wo.z; };
  const auto m = read_astm(astm("theta_i,phi_i,theta_s,phi_s,Cos_BSDF", rows(times_cosine)));
  EXPECT_NEAR(grey(*m, at_degrees(75, 100), at_degrees(30, 0)), 0.25, 1e-5);
  // Where both are given, f is read.
  const auto both =
      read_astm(astm("theta_i,phi_i,theta_s,phi_s,Cos_BSDF,BSDF",
                     "10,0,60,0,0.1,0.5\n10,0,60,90,0.1,0.5\n10,0,60,180,0.1,0.5\n10,0,10,0,0.1,0.5\n"));
  EXPECT_NEAR(grey(*both, at_degrees(60, 180), at_degrees(10, 0)), 0.5, 1e-6);
}

TEST(AstmFormat, ColumnsOfColourAndWavelengthAreChannels) {
  const std::string angles = "theta_i,phi_i,theta_s,phi_s,",
                    row = "10,0,20,180,0.1,0.2,0.3\n10,0,30,180,1,2,3\n";
  const auto rgb = read_astm(astm(angles + "R,G,B", row));
  EXPECT_TRUE(rgb->channels().is_rgb());
  EXPECT_FLOAT_EQ(rgb->samples().f[1], 0.2f);
  const auto xyz = read_astm(astm(angles + "X,Y,Z", "10,0,20,180,0.95047,1,1.08883\n10,0,30,180,0,0,0\n"));
  EXPECT_NEAR(xyz->samples().f[0], 1, 2e-3);
  EXPECT_NEAR(xyz->samples().f[2], 1, 2e-3);
  const auto nm = read_astm(astm(angles + "650nm,BRDF_450nm,550 nm", row));
  EXPECT_EQ(nm->channels().wavelengths_nm(), (std::vector<double>{450, 550, 650}));
  EXPECT_FLOAT_EQ(nm->samples().f[0], 0.2f);
  EXPECT_FLOAT_EQ(nm->samples().f[2], 0.1f);
}

TEST(AstmFormat, ScansInThePlaneOfIncidenceNeedNoAzimuths) {
  const auto m =
      read_astm(astm("theta_i,theta_s,BSDF", "30,29,1\n30,30,2\n30,31,1\n30,-29,0.5\n30,-30,0.4\n"));
  EXPECT_NEAR(grey(*m, at_degrees(30, 0), at_degrees(30, 180)), 2, 1e-5);
  EXPECT_NEAR(grey(*m, at_degrees(30, 180), at_degrees(30, 180)), 0.4, 1e-5);
}

TEST(AstmFormat, BeyondTheSurfaceIsTransmission) {
  const auto m =
      read_astm(astm("theta_i,phi_i,theta_s,phi_s,BSDF", "30,0,150,180,1\n30,0,160,180,2\n30,0,90,0,5\n"));
  EXPECT_TRUE(m->sides().transmits_to_back && !m->sides().reflects_front);
  EXPECT_NEAR(grey(*m, at_degrees(150, 180), at_degrees(30, 0)), 1, 1e-5);
  EXPECT_EQ(m->samples().size(), 2u); // nothing in the surface
  const auto named = read_astm(astm("theta_i,phi_i,theta_s,phi_s,BTDF", "30,0,30,180,1\n30,0,20,180,2\n"));
  EXPECT_NEAR(grey(*named, at_degrees(150, 180), at_degrees(30, 0)), 1, 1e-5);
}

TEST(AstmFormat, FaultsAreNamedWithTheirLineAndColumn) {
  const std::string vars = "theta_i,phi_i,theta_s,phi_s,BSDF";
  EXPECT_THAT(astm_error(""), AllOf(HasSubstr("x:1:1:"), HasSubstr("VARS")));
  EXPECT_THAT(astm_error("LAB_NAME x\n"), HasSubstr("x:1:1: no line 'VARS"));
  EXPECT_THAT(astm_error(astm("phi_i,theta_s,phi_s,BSDF", "")),
              AllOf(HasSubstr("x:4:1"), HasSubstr("theta_i")));
  EXPECT_THAT(astm_error(astm(vars + ",theta_i", "")),
              AllOf(HasSubstr("x:4:39"), HasSubstr("second column")));
  EXPECT_THAT(astm_error(astm("theta_i,theta_s,power,gain", "")), HasSubstr("no column of values"));
  EXPECT_THAT(astm_error(astm(vars, "")), HasSubstr("no samples"));
  EXPECT_THAT(astm_error(astm(vars, "1,2,3,4\n")),
              AllOf(HasSubstr("x:5:1"), HasSubstr("5 numbers"), HasSubstr("found 4")));
  EXPECT_THAT(astm_error(astm(vars, "1,2,3,4,5\n1,2,x,4,5\n")), AllOf(HasSubstr("x:6:5"), HasSubstr("'x'")));
  EXPECT_THAT(astm_error(astm(vars, "1,2,3,4,nan\n")), HasSubstr("x:5:9"));
  EXPECT_THAT(astm_error(astm(vars, "1,2,3,4,1e999\n")), HasSubstr("x:5:9"));
  EXPECT_THAT(astm_error(astm(vars, "1,2,181,4,1\n2,2,2,2,2\n")),
              AllOf(HasSubstr("x:5:1"), HasSubstr("181")));
  EXPECT_THAT(astm_error(astm(vars, "1,2,3,4,1\n")), AllOf(HasSubstr("x:3:1"), HasSubstr("promises 2")));
  EXPECT_THAT(astm_error("SYMMETRY isotopic\n" + astm(vars, "1,2,3,4,5\n")),
              AllOf(HasSubstr("x:1:10"), HasSubstr("isotropic")));
}

std::string csv(const std::string& settings, const std::string& names, const std::string& body) {
  return "# nacre-bsdf 1; " + settings + "\n" + names + "\n" + body;
}

TEST(CsvFormat, TheSchemaSaysWhatColumnsMean) {
  const auto read = [](const std::string& text) { return parse_scatter_csv(bytes_of(text), "x.csv"); };
  const auto grey_file = read(csv("channels=grey", "theta_i,phi_i,theta_o,phi_o,f", rows(Glossy{})));
  const Vec3d wo = at_degrees(50, 150), wi = at_degrees(40, 0);
  EXPECT_NEAR(grey(*grey_file, wo, wi), Glossy{}(wo, wi), 1e-5);
  const auto radians =
      read(csv("angles=radians; channels=grey; value=cosine_bsdf", "theta_i,phi_i,theta_o,phi_o,f",
               rows([](const Vec3d& o, const Vec3d& i) { return o.z * Glossy{}(o, i); }, pi / 180)));
  EXPECT_NEAR(grey(*radians, wo, wi), Glossy{}(wo, wi), 1e-4);
  const auto rgb = read(
      csv("channels=rgb", "b,g,r,phi_o,theta_o,theta_i", "3,2,1,180,20,10\n# a remark\n\n3,2,1,180,30,10\n"));
  EXPECT_EQ(rgb->samples().f, (std::vector<float>{1, 2, 3, 1, 2, 3}));
  EXPECT_NEAR(wi.z, at_degrees(40, 0).z, 0);
  const auto spectral =
      read(csv("channels=nm:400,550.5", "theta_i,phi_i,theta_o,phi_o,550.5nm,400nm", "10,0,20,180,2,1\n"));
  EXPECT_EQ(spectral->channels().wavelengths_nm(), (std::vector<double>{400, 550.5}));
  EXPECT_EQ(spectral->samples().f, (std::vector<float>{1, 2}));
  EXPECT_FALSE(read(csv("channels=grey; symmetry=none", "theta_i,phi_i,theta_o,phi_o,f", rows(Glossy{})))
                   ->is_isotropic());
}

TEST(CsvFormat, FaultsAreNamedWithTheirLineAndColumn) {
  const std::string names = "theta_i,phi_i,theta_o,phi_o,f";
  EXPECT_THAT(csv_error(""), AllOf(HasSubstr("x:1:1"), HasSubstr("nacre-bsdf")));
  EXPECT_THAT(csv_error("theta,phi\n"), HasSubstr("nacre-bsdf"));
  EXPECT_THAT(csv_error("# nacre-bsdf 2; channels=grey\n"),
              AllOf(HasSubstr("x:1:3"), HasSubstr("version 1")));
  EXPECT_THAT(csv_error("# nacre-bsdf 1\n" + names), HasSubstr("channels="));
  EXPECT_THAT(csv_error(csv("chanels=grey", names, "")),
              AllOf(HasSubstr("x:1:17"), HasSubstr("did you mean 'channels'")));
  EXPECT_THAT(csv_error(csv("channels=cmyk", names, "")), AllOf(HasSubstr("x:1:26"), HasSubstr("'cmyk'")));
  EXPECT_THAT(csv_error(csv("channels=nm:500,400", names, "")),
              AllOf(HasSubstr("x:1:33"), HasSubstr("'400'")));
  EXPECT_THAT(csv_error(csv("channels=grey; channels=rgb", names, "")), HasSubstr("second setting"));
  EXPECT_THAT(csv_error(csv("channels=grey; angles=grads", names, "")), HasSubstr("radians"));
  EXPECT_THAT(csv_error(csv("channels=grey", "theta_i,phi_i,theta_ou,phi_o,f", "")),
              AllOf(HasSubstr("x:2:15"), HasSubstr("did you mean 'theta_o'")));
  EXPECT_THAT(csv_error(csv("channels=rgb", "theta_i,theta_o,phi_o,r,g", "")),
              HasSubstr("column b is missing"));
  EXPECT_THAT(csv_error(csv("channels=grey", names, "1,2,3,4,5\n1,2,3\n")), HasSubstr("x:4:1"));
  EXPECT_THAT(csv_error(csv("channels=grey", names, "90,0,0,0,1\n")), HasSubstr("in the surface"));
  EXPECT_THAT(csv_error(csv("channels=grey", names, "")), HasSubstr("no samples"));
}

std::vector<std::shared_ptr<const MeasuredBsdf>> some_measurements() {
  std::vector<std::shared_ptr<const MeasuredBsdf>> all;
  all.push_back(parse_scatter_csv(
      bytes_of(csv("channels=grey", "theta_i,phi_i,theta_o,phi_o,f", rows(Glossy{}))), "x"));
  all.push_back(
      parse_astm(bytes_of(astm("theta_i,phi_i,theta_s,phi_s,450.5nm,550nm,633nm",
                               "10,0,20,180,0.1,0.2,-0.3\n10,0,150,180,1,2,3\n170,20,150,30,1e-7,2,3e5\n")),
                 "x"));
  AngleGrid::Nodes nodes{{0.2, 0.7}, {0, 2, 4}, {0.1, 0.5, 1.2}, {0, 2, 4}};
  std::vector<float> values;
  for (int n = 0; n < 3 * 54; ++n)
    values.push_back(uniform(11, n, 0, 0));
  all.push_back(std::make_shared<const AngleGrid>(nodes, Channels::rgb(), values, "grid"));
  all.push_back(std::make_shared<const MerlTable>(glossy_table(0.3, 8, 12)));
  return all;
}

TEST(SampleFormats, SamplesSurviveTheRoundTrip) {
  for (const auto& m : some_measurements())
    for (const bool as_csv : {false, true}) {
      const Bytes bytes = as_csv ? encode_scatter_csv(*m) : encode_astm(*m);
      const auto back = as_csv ? parse_scatter_csv(bytes, "x") : parse_astm(bytes, "x");
      const MeasuredSamples a = samples_to_write(*m), b = back->samples();
      ASSERT_EQ(a.size(), b.size());
      EXPECT_EQ(a.f, b.f); // numbers are written so that they read back as themselves
      EXPECT_EQ(m->is_isotropic(), back->is_isotropic());
      EXPECT_EQ(m->channels().wavelengths_nm(), back->channels().wavelengths_nm());
      EXPECT_EQ(m->channels().count(), back->channels().count());
      for (std::size_t n = 0; n < a.size(); ++n) {
        EXPECT_LT(length(a.wo[n] - b.wo[n]), 3e-7f);
        EXPECT_LT(length(a.wi[n] - b.wi[n]), 3e-7f);
      }
    }
}

TEST(SampleFormats, ATableWrittenAsSamplesIsTheSameFunction) {
  const MerlTable small = glossy_table(0.3, 24, 24);
  const auto back = parse_scatter_csv(encode_scatter_csv(small), "x");
  double sum = 0, norm = 0;
  int covered = 0;
  for (std::uint64_t n = 0; n < 2000; ++n) {
    const Vec3d wo = random_direction(2 * n, 60), wi = random_direction(2 * n + 1, 60);
    const double f = grey(small, wo, wi), g = grey(*back, wo, wi);
    if (g == -1) continue;
    ++covered;
    sum += sqr(f - g);
    norm += sqr(f);
  }
  EXPECT_GT(covered, 1950);
  EXPECT_LT(std::sqrt(sum / norm), 0.06);
}

TEST(SampleFormats, FormatsAreFoundByEndingAndFirstLine) {
  EXPECT_TRUE(is_measured_file("a.astm") && is_measured_file("b.CSV"));
  EXPECT_TRUE(is_scatter_csv(bytes_of("#nacre-bsdf 1; channels=grey\n")));
  EXPECT_FALSE(is_scatter_csv(bytes_of("theta,phi\n")));
  EXPECT_FALSE(is_scatter_csv({}));
}

TEST(AstmFormat, MutatedFilesGiveSamplesOrAnError) {
  const std::string text = astm("theta_i,phi_i,theta_s,phi_s,BSDF", rows(Glossy{}));
  expect_measurement_or_error(
      bytes_of(text), [](const Bytes& b) { return parse_astm(b, "mutant"); }, 4000, 120);
  expect_measurement_or_error(
      encode_astm(*some_measurements()[1]), [](const Bytes& b) { return parse_astm(b, "mutant"); }, 4000,
      120);
}

TEST(CsvFormat, MutatedFilesGiveSamplesOrAnError) {
  for (const auto& m : some_measurements())
    expect_measurement_or_error(
        encode_scatter_csv(*m), [](const Bytes& b) { return parse_scatter_csv(b, "mutant"); }, 1500, 150);
}

} // namespace
} // namespace nacre
