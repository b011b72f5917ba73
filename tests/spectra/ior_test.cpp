#include "spectra/ior.h"

#include "spectra/illuminants.h"

#include <gtest/gtest.h>

using namespace nacre;

namespace {
// Linear sRGB of normal-incidence reflectance under D65.
RGB f0(const ConductorIor& metal) {
  return xyz_to_srgb * integrate_xyz([&](float l) {
           const double n = static_cast<double>(metal.eta.eval(l)), k = static_cast<double>(metal.k.eval(l));
           const double f = ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
           return f * static_cast<double>(unit_d65()(l));
         });
}
} // namespace

TEST(Metals, ColorsMatchPublishedReflectance) {
  struct Row {
    const char* name;
    RGB rgb;
  };
  // Akenine-Moeller et al. 2018, Real-Time Rendering, 4th edition, table 9.2: linear sRGB under D65.
  for (const Row& row : {Row{"Au", {1.022, 0.782, 0.344}}, Row{"Ag", {0.972, 0.960, 0.915}},
                         Row{"Al", {0.913, 0.922, 0.924}}, Row{"Cu", {0.955, 0.638, 0.538}}}) {
    const ConductorIor* metal = find_metal(row.name);
    ASSERT_NE(metal, nullptr) << row.name;
    const RGB rgb = f0(*metal);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(rgb[c], row.rgb[c], 2e-3) << row.name << " channel " << c;
  }
}

TEST(Metals, ChromiumMatchesItsHandbook) {
  // Palik 1991: polished chromium reflects 55 to 70 percent of visible light.
  for (double v : f0(*find_metal("Cr")))
    EXPECT_NEAR(v, 0.65, 0.08);
}

TEST(Metals, EveryTableCoversTheVisibleRange) {
  for (const auto& name : metal_names()) {
    const ConductorIor* metal = find_metal(name);
    ASSERT_NE(metal, nullptr) << name;
    for (float lambda_nm = 360; lambda_nm <= 830; lambda_nm += 2) {
      const float eta = metal->eta.eval(lambda_nm), k = metal->k.eval(lambda_nm);
      EXPECT_GT(eta + k, 0.5f) << name << " at " << lambda_nm;
      EXPECT_TRUE(eta >= 0 && eta < 20 && k >= 0 && k < 20) << name << " at " << lambda_nm;
    }
  }
}

TEST(Metals, NoneIsTheIdealMirror) {
  for (double v : f0(*find_metal("none")))
    EXPECT_NEAR(v, 1, 5e-4);
}

TEST(Metals, UnknownNamesAreNotFound) {
  EXPECT_EQ(find_metal("Unobtainium"), nullptr);
  EXPECT_EQ(find_metal(""), nullptr);
  EXPECT_EQ(find_metal("au"), nullptr);
  EXPECT_TRUE(std::is_sorted(metal_names().begin(), metal_names().end()));
}

TEST(Dielectrics, KnownSubstancesHaveTheirIndex) {
  EXPECT_EQ(find_dielectric("vacuum"), 1.0);
  EXPECT_EQ(find_dielectric("water"), 1.3330);
  EXPECT_EQ(find_dielectric("bk7"), 1.5046);
  EXPECT_EQ(find_dielectric("diamond"), 2.419);
  EXPECT_EQ(find_dielectric("unknown"), std::nullopt);
  for (const auto& name : dielectric_names()) {
    const double eta = find_dielectric(name).value();
    EXPECT_TRUE(eta >= 1 && eta < 3) << name;
  }
}
