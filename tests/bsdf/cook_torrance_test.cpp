#include "bsdf/models/cook_torrance.h"

#include "bsdf/published_fits.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

using Exact = CookTorrance<double, 3>;
using Schlick = CookTorranceSchlick<double, 3>;
using Gray = Spectrum<double, 3>;

TEST(CookTorrance, PublishedFitsOfLoewHaveTheValuesOfBbm) {
  for (const std::string set : {"low_cooktorrance_E1", "low_cooktorrance_E2"}) {
    const auto d = published_fits::compare(set, [](const nlohmann::json& lobe) {
      auto m = default_model<Exact>();
      m.specular_reflectance = published_fits::albedo(lobe);
      m.fresnel = Gray(lobe["eta"].get<double>());
      m.m = lobe["roughness"];
      return m;
    });
    if (d.count == 0) GTEST_SKIP() << "no published fits beside the project";
    EXPECT_EQ(d.count, 3 * 1250);
    EXPECT_LT(d.worst, 1e-3) << d.beyond << " of " << d.count << " beyond, worst " << d.where;
    std::cout << set << " " << d.worst << " " << d.where << "\n";
  }
}

TEST(CookTorrance, PublishedFitsOfNganHaveTheValuesOfBbm) {
  const auto d = published_fits::compare("ngan_cooktorrance", [](const nlohmann::json& lobe) {
    auto m = default_model<Schlick>();
    m.specular_reflectance = published_fits::albedo(lobe);
    m.fresnel = Gray(lobe["eta"].get<double>()); // reflectance at normal incidence, whatever its name
    m.m = lobe["roughness"];
    m.divisor = pi;
    return m;
  });
  if (d.count == 0) GTEST_SKIP() << "no published fits beside the project";
  EXPECT_LT(d.worst, 1e-3) << d.beyond << " of " << d.count << " beyond, worst " << d.where;
  std::cout << d.count << " " << d.worst << " " << d.where << "\n";
}

} // namespace
} // namespace nacre
