// Bagher's and Low's models against the values that other programs compute for their published fits.
#include "bsdf/models/low.h"
#include "bsdf/models/sgd.h"

#include "published_fits.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

using Color = Spectrum<double, 3>;
using Json = nlohmann::json;

Color color(const Json& j) { return Color(j.get<std::array<double, 3>>()); }

Sgd<double, 3> sgd(const Json& lobe) {
  Sgd<double, 3> m;
  m.specular = color(lobe["albedo"]);
  m.alpha = color(lobe["alpha"]);
  m.p = color(lobe["p"]);
  m.r0 = color(lobe["eta"][0]) - color(lobe["eta"][1]);
  m.f1 = color(lobe["eta"][1]);
  m.lambda = color(lobe["Lambda"]);
  m.log_c = color(lobe["c"]).map([](double c) { return std::log(c); });
  m.k = color(lobe["k"]);
  m.theta0 = color(lobe["theta0"]);
  m.published_masking = 1;
  return m;
}
template <class M>
M low(const Json& lobe) {
  return {{}, color(lobe["A"]), lobe["B"].get<double>(), lobe["C"].get<double>(), lobe["eta"].get<double>()};
}

constexpr const char* absent = "no published fits beside the source tree";

TEST(Sgd, PublishedFitsEvaluateToBbmsValues) {
  const auto d = published_fits::compare("bagher_sgd", sgd);
  if (d.count == 0) GTEST_SKIP() << absent;
  EXPECT_EQ(d.count, 3750);
  EXPECT_EQ(d.beyond, 0) << d.where;
  EXPECT_LT(d.worst, 1e-5) << d.where;
}

/// dj_brdf's values for its own tables of fits, which hold the same parameters with fewer digits.
template <class Make>
published_fits::Deviation compare_with_dj_brdf(const std::string& set, const std::string& name, Make make,
                                               double rounding = 0) {
  std::map<std::string, std::vector<published_fits::Row>> rows;
  std::ifstream in(std::string(NACRE_SOURCE_DIR) + "/../shared/data/reference/dj_sgd_abc.csv");
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream columns(line);
    std::string model, material;
    published_fits::Row r{};
    columns >> model >> material >> r.theta_i >> r.theta_o >> r.phi >> r.f[0] >> r.f[1] >> r.f[2];
    if (!columns || model != name) continue;
    r.wo = spherical_direction(r.theta_o * pi / 180, 0.0);
    r.wi = spherical_direction(r.theta_i * pi / 180, r.phi * pi / 180);
    rows[material].push_back(r);
  }
  published_fits::Deviation all;
  for (const auto& fit : published_fits::read(set)) {
    const auto model = make(fit.lobe);
    for (const auto& row : rows[fit.material]) {
      const auto f = model.eval(row.wo, row.wi);
      for (int c = 0; c < 3; ++c) {
        const double theirs = row.f[std::size_t(c)],
                     ours = f[c] + fit.diffuse_albedo[std::size_t(c)] * inv_pi;
        all.add(ours + std::clamp(theirs - ours, -rounding, rounding), theirs, fit.text(row));
      }
    }
  }
  return all;
}

TEST(Sgd, PublishedFitsEvaluateToDjBrdfsValues) {
  const auto d = compare_with_dj_brdf("bagher_sgd", "sgd", sgd);
  if (d.count == 0) GTEST_SKIP() << absent;
  EXPECT_EQ(d.count, 3750);
  EXPECT_LT(d.worst, 1e-4) << d.where; // it prints 7 digits
}

TEST(Sgd, PublishedNormalisationIsThatOfTheProjectedArea) {
  for (const auto& fit : published_fits::read("bagher_sgd"))
    for (int c = 0; c < 3; ++c) {
      const double ours = shifted_gamma_normalisation(color(fit.lobe["alpha"])[c], color(fit.lobe["p"])[c]);
      EXPECT_NEAR(color(fit.lobe["K"])[c], ours, 1e-5 * ours) << fit.material;
    }
}

TEST(LowMicrofacet, PublishedFitsEvaluateToBbmsValues) {
  const auto d = published_fits::compare("low_lowmicrofacet_E2", low<LowMicrofacet<double, 3>>);
  if (d.count == 0) GTEST_SKIP() << absent;
  EXPECT_EQ(d.count, 3750);
  EXPECT_LT(d.worst, 1e-5) << d.where;
}

TEST(LowSmooth, PublishedFitsEvaluateToBbmsValues) {
  const auto d = published_fits::compare("low_lowsmooth_E2", low<LowSmooth<double, 3>>);
  if (d.count == 0) GTEST_SKIP() << absent;
  EXPECT_EQ(d.count, 3750);
  EXPECT_LT(d.worst, 1e-5) << d.where;
}

// Its table has the Lambertian albedos with more digits than the published fits, which are rounded to 1e-4.
TEST(LowMicrofacet, PublishedFitsEvaluateToDjBrdfsValuesUpToRoundedAlbedos) {
  const auto d =
      compare_with_dj_brdf("low_lowmicrofacet_E2", "abc", low<LowMicrofacet<double, 3>>, 0.51e-4 * inv_pi);
  if (d.count == 0) GTEST_SKIP() << absent;
  EXPECT_EQ(d.count, 3750);
  EXPECT_LT(d.worst, 1e-4) << d.where;
}

} // namespace
} // namespace nacre
