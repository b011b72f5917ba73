#include "report/material_plots.h"

#include "scene/scene_material.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

TEST(MaterialCurves, PacksAgreeWithDoublePrecision) {
  const MaterialSpec material =
      parse_material("ggx_schlick:f0=0.9/0.6/0.3,alpha=0.2+lambert:reflectance=0.1");
  const auto reference = make_bsdf<double>(material);
  Directions d;
  std::vector<Vec3d> wo, wi;
  for (int i = 0; i < 37; ++i) { // no multiple of any pack's width
    wo.push_back(spherical_direction(0.04 * i, 0.1 * i));
    wi.push_back(spherical_direction(1.5 - 0.04 * i, 2.0));
    d.add(wo.back(), wi.back());
  }
  const auto f = evaluate(material, d);
  ASSERT_EQ(f.size(), wo.size());
  for (std::size_t i = 0; i < f.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const double expected = reference.eval(wo[i], wi[i])[static_cast<int>(c)];
      // Float directions are good to 6e-8; near the peak the slope of GGX at alpha 0.2 magnifies that
      // 100-fold.
      EXPECT_NEAR(f[i][c], expected, 2e-5 * (1 + expected)) << i;
    }
}

TEST(MaterialCurves, SampledAlbedoOfLambertIsItsReflectance) {
  const auto a = sampled_albedo(parse_material("lambert:reflectance=0.2/0.5/0.8"), 1.1);
  EXPECT_NEAR(a[0], 0.2, 1e-5);
  EXPECT_NEAR(a[1], 0.5, 1e-5);
  EXPECT_NEAR(a[2], 0.8, 1e-5);
}

TEST(MaterialCurves, SampledAlbedoOfClearGlassIsOne) {
  for (const double a : sampled_albedo(parse_material("smooth_dielectric:eta=1.5"), 0.7))
    EXPECT_NEAR(a, 1, 0.02); // the chance of reflection is 4 %, of which 4096 samples miss at most a tenth
}

TEST(MaterialCurves, PairOfDotsAndLinesSharesColours) {
  const MaterialSpec a = parse_material("lambert"), b = parse_material("oren_nayar");
  const std::array<PlottedMaterial, 2> pair{{{&a, "measured", true}, {&b, "fit", false}}};
  const std::array<double, 2> theta{0, 45};
  const Plot plot = incidence_plane_plot(pair, theta, true);
  ASSERT_EQ(plot.series.size(), 4u);
  EXPECT_TRUE(plot.series[0].dots);
  EXPECT_FALSE(plot.series[2].dots);
  EXPECT_EQ(plot.series[0].colour, plot.series[2].colour);
  EXPECT_NE(plot.series[0].colour, plot.series[1].colour);
  EXPECT_NEAR(plot.series[0].y[40], 0.5 / pi, 1e-6);
}

TEST(PreviewScene, ColoursOfAMaterialComeBackFromItsSpectra) {
  const MaterialSpec material =
      parse_material("ggx_schlick:f0=0.9/0.6/0.1,alpha=0.3+lambert:reflectance=0.05/0.2/0.4");
  const Material m = scene_material(material);
  ASSERT_EQ(m.lobes.size(), 2u);
  for (std::size_t l = 0; l < 2; ++l) {
    const RGB rgb = std::get<SpectrumSource>(m.lobes[l].parameters[0]).to_srgb_reflectance();
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(rgb[c], material.lobes[l].values[0][c], 2e-3); // the basis's own accuracy
  }
  EXPECT_EQ(std::get<float>(m.lobes[0].parameters[1]), 0.3f);
}

TEST(PreviewScene, EveryListedModelBecomesASceneMaterial) {
  for (std::size_t i = 0; i < model_infos().size(); ++i) {
    const Material m = scene_material({"x", {default_lobe(static_cast<int>(i))}});
    EXPECT_EQ(m.lobes[0].parameters.size(), model_infos()[i].parameters.size());
  }
}

} // namespace
} // namespace nacre
