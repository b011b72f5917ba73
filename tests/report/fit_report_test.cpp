#include "report/fit_report.h"

#include "core/error.h"
#include "core/file.h"
#include "core/scratch_folder.h"
#include "measured/merl_table.h"
#include "report/fit_sections.h"
#include "report/material_plots.h"
#include "report/surface_plots.h"

#include <gmock/gmock.h>

namespace nacre {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Two fits of a rough gold, one of them poor.
const FitReport& example() {
  static const FitReport report = [] {
    FitReport r;
    r.title = "little <gold>";
    r.source = "gold & more.binary";
    r.command = "nacre fit 'gold & more.binary'";
    r.version = "1.2.3";
    r.measured = std::make_shared<MerlTable>(
        MerlTable::tabulate(20, 12, 12, [](double theta_h, double, double) -> std::array<double, 3> {
          const double lobe = std::exp(-sqr(theta_h / 0.3));
          return {0.05 + 0.9 * lobe, 0.04 + 0.6 * lobe, 0.02 + 0.2 * lobe};
        }));
    for (const char* model : {"ggx_schlick+lambert", "lambert"}) {
      FitOptions options;
      options.model = model;
      options.starts = 2, options.refined = 1;
      r.fits.push_back(fit(*r.measured, options));
    }
    return r;
  }();
  return report;
}

const std::string& example_page() {
  static const std::string page = fit_report_html(example());
  return page;
}

TEST(FitReport, HoldsParametersErrorsCurvesPicturesLawsAndRanking) {
  const std::string& page = example_page();
  for (const char* section : {"id=ranking", "id=fit", "id=plots", "id=lobes", "id=slices", "id=spheres",
                              "id=validation", "id=origin"})
    EXPECT_THAT(page, HasSubstr(section));
  for (const FittedParameter& p : example().fits[0].parameters) {
    EXPECT_THAT(page, HasSubstr("<td>" + p.label + "<td"));
    if (!p.partner.empty() && p.identifiable && !p.at_bound) {
      EXPECT_THAT(page, HasSubstr(p.partner + ", "));
    }
  }
  EXPECT_THAT(page, HasSubstr("little &lt;gold&gt;"));
  EXPECT_THAT(page, Not(HasSubstr("<gold>")));
  EXPECT_THAT(page, HasSubstr("gold &amp; more.binary"));
  EXPECT_LT(page.find("ggx_schlick + lambert"), page.find("<td>lambert<td"));
}

TEST(FitReport, NeedsNothingOutsideIt) {
  const std::string& page = example_page();
  for (const char* outside : {"http", "url(", "@import", "<link", "<script", "src='/", "src=\""})
    EXPECT_THAT(page, Not(HasSubstr(outside)));
}

TEST(FitReport, OfOneModelHasNoRanking) {
  FitReport one = example();
  one.fits.resize(1);
  EXPECT_THAT(fit_report_html(one), Not(HasSubstr("id=ranking")));
}

TEST(FitReport, IsAFileOrAFolderWithTheFit) {
  const ScratchFolder folder;
  EXPECT_EQ(write_fit_report(example(), folder / "page.html"), folder / "page.html");
  EXPECT_EQ(read_text_file(folder / "page.html"), example_page());
  const std::string page = write_fit_report(example(), folder / "out");
  EXPECT_THAT(read_text_file(page), HasSubstr("</html>"));
  EXPECT_NO_THROW(parse_material(folder / "out/fit.json"));
  write_file_atomically(folder / "file", "");
  EXPECT_THROW(write_fit_report(example(), folder / "file"), Error);
}

TEST(FitSections, APropertyIsNeitherKeptNorViolated) {
  ValidationReport report;
  report.laws.push_back({"energy lost", "share lost", Verdict::stated, 0.4});
  const std::array<ValidatedMaterial, 1> one{{{"fit", &report}}};
  EXPECT_THAT(validation_section(one), Not(HasSubstr("violated<")));
  EXPECT_THAT(html_verdict(report), HasSubstr("holds"));
  report.laws.push_back({"reciprocity", "difference", Verdict::violated, 0.4});
  EXPECT_THAT(validation_section(one), HasSubstr("✗ violated"));
  EXPECT_THAT(html_verdict(report), HasSubstr("1 violated"));
}

TEST(HalfVectorPlot, BeginsInTheMirrorDirectionAndEndsAtTheHorizonBehindTheLight) {
  const MaterialSpec material = parse_material("ggx_schlick:alpha=0.3");
  const PlottedMaterial plotted{&material, "m"};
  const std::array<double, 2> angles{0, 60};
  const Plot plot = half_vector_plot({&plotted, 1}, angles, true);
  ASSERT_EQ(plot.series.size(), 2u);
  const auto bsdf = make_bsdf<double>(material);
  for (std::size_t i = 0; i < 2; ++i) {
    const double theta = angles[i] * pi / 180;
    const Vec3d wi = spherical_direction(theta, pi);
    EXPECT_EQ(plot.series[i].x.front(), 0);
    const auto peak = bsdf.eval(spherical_direction(theta, 0.0), wi);
    EXPECT_NEAR(plot.series[i].y.front() / luminance({peak[0], peak[1], peak[2]}), 1, 1e-4);
    EXPECT_NEAR(plot.series[i].x.back(), (angles[i] + 88) / 2, 0.5);
    // At theta_h = theta_i the viewer stands where the light does.
    const auto at =
        std::min_element(plot.series[i].x.begin(), plot.series[i].x.end(), [&](double a, double b) {
          return std::abs(a - angles[i]) < std::abs(b - angles[i]);
        });
    const double theta_h = *at * pi / 180;
    const auto f = bsdf.eval(spherical_direction(theta - 2 * theta_h, 0.0), wi);
    EXPECT_NEAR(plot.series[i].y[std::size_t(at - plot.series[i].x.begin())] / luminance({f[0], f[1], f[2]}),
                1, 1e-4);
  }
}

TEST(PolarElement, IsTheFilesPictureWithoutItsHead) {
  const MaterialSpec material = parse_material("lambert");
  const PlottedMaterial plotted{&material, "m"};
  const std::array<double, 1> angles{30};
  const std::string file = polar_svg({&plotted, 1}, angles), element = polar_element({&plotted, 1}, angles);
  EXPECT_THAT(element, Not(HasSubstr("xmlns")));
  EXPECT_EQ(file.substr(file.find(" width=")), element.substr(element.find(" width=")));
}

} // namespace
} // namespace nacre
