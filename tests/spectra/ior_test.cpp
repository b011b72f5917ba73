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

TEST(Metals, MoreThanTwentyElementsEachWithASource) {
  int count = 0;
  for (const char* name : {"Ag", "Al", "Au", "Be", "Co", "Cr", "Cu", "Fe", "Hg", "Ir", "K", "Li", "Mn",
                           "Mo", "Na", "Nb", "Ni", "Pd", "Pt", "Rh", "Ta", "Ti", "V",  "W", "Zn"}) {
    ASSERT_NE(find_metal(name), nullptr) << name;
    ++count;
  }
  EXPECT_GE(count, 20);
  for (const auto& name : metal_names())
    EXPECT_FALSE(find_metal(name)->source.empty()) << name;
}

TEST(Metals, ReflectWhatHandbooksSay) {
  // Luminous reflectance at normal incidence in air, percent: Haynes (ed.), CRC Handbook, optical properties
  // of metals, near 590 nm; single films scatter by some percent.
  for (const auto& [name, percent] :
       {std::pair{"Fe", 56}, {"Ti", 57}, {"Co", 67}, {"Pd", 70}, {"Pt", 66}, {"Ni", 64}, {"W", 51}})
    EXPECT_NEAR(f0(*find_metal(name))[1], percent / 100.0, 0.06) << name;
}

TEST(Metals, BrassIsYellow) {
  const RGB rgb = f0(*find_metal("CuZn"));
  // Akenine-Moeller et al. 2018, table 9.2: brass (0.910, 0.778, 0.423), of another composition.
  EXPECT_NEAR(rgb[0], 0.910, 0.05);
  EXPECT_NEAR(rgb[1], 0.778, 0.05);
  EXPECT_NEAR(rgb[2], 0.423, 0.1);
}

TEST(Glasses, HaveTheIndexAndAbbeNumberOfTheirDataSheets) {
  struct Row {
    const char* name;
    double n_d, v_d;
  };
  for (const Row& row :
       {Row{"N-BK7", 1.5168, 64.17}, Row{"N-K5", 1.52249, 59.48}, Row{"N-FK51A", 1.48656, 84.47},
        Row{"N-BAK4", 1.56883, 55.98}, Row{"N-BAF10", 1.67003, 47.11}, Row{"F2", 1.62004, 36.37},
        Row{"SF5", 1.6727, 32.21}, Row{"SF10", 1.72825, 28.41}, Row{"SF11", 1.78472, 25.76},
        Row{"N-SF11", 1.78472, 25.68}, Row{"LASFN9", 1.85025, 32.17}, Row{"N-LASF9", 1.85025, 32.17},
        Row{"N-SF66", 1.92286, 20.88}}) {
    const DielectricIor* glass = find_glass(row.name);
    ASSERT_NE(glass, nullptr) << row.name;
    EXPECT_NEAR(glass->n_d(), row.n_d, 6e-6) << row.name;
    EXPECT_NEAR(glass->v_d(), row.v_d, 6e-3) << row.name;
  }
}

TEST(Glasses, CrystalsLiquidsAndPlasticsHaveTheirTextbookIndices) {
  struct Row {
    const char* name;
    double n, tolerance;
  };
  // At 589.3 nm: Haynes (ed.), CRC Handbook, and the papers of the formulas; water in vacuum.
  for (const Row& row : {Row{"fused silica", 1.4584, 1e-4},
                         Row{"quartz-o", 1.5443, 3e-4},
                         Row{"quartz-e", 1.5534, 3e-4},
                         Row{"calcite-o", 1.6584, 3e-4},
                         Row{"calcite-e", 1.4864, 3e-4},
                         Row{"sapphire-o", 1.7681, 5e-4},
                         Row{"sapphire-e", 1.7600, 5e-4},
                         Row{"rutile-o", 2.6124, 5e-3},
                         Row{"rutile-e", 2.8993, 1e-2},
                         Row{"magnesium fluoride-o", 1.3777, 2e-4},
                         Row{"magnesium fluoride-e", 1.3895, 2e-4},
                         Row{"calcium fluoride", 1.4338, 1e-4},
                         Row{"lithium fluoride", 1.3920, 4e-4},
                         Row{"sodium chloride", 1.5443, 3e-4},
                         Row{"yag", 1.8328, 1e-3},
                         Row{"diamond", 2.4175, 1e-3},
                         Row{"water", 1.33335, 1e-5},
                         Row{"ethanol", 1.3614, 5e-4},
                         Row{"acetone", 1.3588, 5e-4},
                         Row{"pmma", 1.4914, 1e-3},
                         Row{"polystyrene", 1.5903, 2e-3},
                         Row{"polycarbonate", 1.5848, 2e-3},
                         Row{"air", 1.000277, 1e-6}}) {
    const DielectricIor* substance = find_glass(row.name);
    ASSERT_NE(substance, nullptr) << row.name;
    EXPECT_NEAR(substance->eval(589.3), row.n, row.tolerance) << row.name;
  }
}

TEST(Glasses, DisperseNormallyOverTheVisibleRangeAndNameTheirSource) {
  int count = 0;
  for (const auto& row : data::dielectric_ior_rows()) {
    const DielectricIor& glass = *find_glass(row.names.substr(0, row.names.find(',')));
    ++count;
    EXPECT_FALSE(glass.source.empty()) << glass.name;
    for (double lambda_nm = 361; lambda_nm <= 830; ++lambda_nm) {
      const double n = glass.eval(lambda_nm);
      EXPECT_TRUE(n > 1 && n < 4 && n < glass.eval(lambda_nm - 1)) << glass.name << " at " << lambda_nm;
    }
  }
  EXPECT_GE(count, 15);
}

TEST(Glasses, DiamondsFormulaAgreesWithItsTableAmongTheSolids) {
  for (float lambda_nm = 404; lambda_nm < 656; lambda_nm += 20)
    EXPECT_NEAR(find_glass("diamond")->eval(lambda_nm), find_metal("d-C")->eta.eval(lambda_nm), 2e-3)
        << lambda_nm;
}

TEST(Glasses, AreFoundByAnyNameAndCapitals) {
  EXPECT_EQ(find_glass("BK7"), find_glass("bk7"));
  EXPECT_EQ(find_glass("BK7")->name, "n-bk7");
  EXPECT_EQ(find_glass("LASF9")->name, "n-lasf9");
  EXPECT_EQ(find_glass("Fused Quartz")->name, "fused silica");
  EXPECT_EQ(find_glass("unknown"), nullptr);
  EXPECT_EQ(find_glass(""), nullptr);
}

TEST(Dielectrics, SceneNumbersAreRoundingsOfTheFormulasButForBk7) {
  for (const auto& name : glass_names())
    EXPECT_NEAR(find_dielectric(name).value(), find_glass(name)->n_d(), name == "bk7" ? 0.0123 : 2.1e-3)
        << name;
  EXPECT_NEAR(find_dielectric("n-bk7").value(), 1.5168, 1e-5);
  EXPECT_NEAR(find_dielectric("sapphire").value(), 1.7682, 1e-4);
}
