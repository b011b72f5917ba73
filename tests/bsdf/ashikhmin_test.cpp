#include "bsdf/models/ashikhmin_shirley.h"

#include "bsdf/published_fits.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

using Exact = AshikhminShirleyExact<double, 3>;
using Schlick = AshikhminShirley<double, 3>;

template <class M>
published_fits::Deviation deviation(const std::string& set) {
  return published_fits::compare(set, [](const nlohmann::json& lobe) {
    auto m = default_model<M>();
    m.specular_reflectance = published_fits::albedo(lobe);
    m.fresnel = Spectrum<double, 3>(lobe["fresnelReflectance"].get<double>());
    m.n_u = m.n_v = lobe["sharpness"];
    return m;
  });
}

TEST(AshikhminShirley, PublishedFitsHaveTheValuesOfBbm) {
  for (const std::string set : {"low_ashikhminshirley_E1", "low_ashikhminshirley_E2", "ngan_ashikhminshirley"}) {
    // Loew's "fresnelReflectance" is an index, for Fresnel's equations.
    const auto d = set == "ngan_ashikhminshirley" ? deviation<Schlick>(set) : deviation<Exact>(set);
    if (d.count == 0) GTEST_SKIP() << "no published fits beside the project";
    EXPECT_LT(d.worst, 1e-3) << d.beyond << " of " << d.count << " beyond, worst " << d.where;
    std::cout << d.count << " " << d.worst << " " << d.where << "\n";
  }
}

} // namespace
} // namespace nacre
