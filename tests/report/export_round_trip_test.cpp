// What is written for Mitsuba and read back as a scene scatters as the material that was exported.
#include "core/random.h"
#include "fit/export_material.h"
#include "scene/mitsuba.h"

#include <gtest/gtest.h>
#include <regex>

namespace nacre {
namespace {

/// The first material of an exported file, put on a shape of a scene.
Material read_back(const std::string& xml) {
  std::string text = std::regex_replace(xml, std::regex("<!--[^]*?-->"), "");
  text.insert(text.find("</scene>"), "<sensor type='perspective'/><shape type='sphere'><ref id='material'/>"
                                     "</shape>");
  const Scene scene = parse_mitsuba_scene(text, "exported.xml", {{}, {}, true});
  return scene.materials.at(static_cast<std::size_t>(scene.shapes.at(0).material));
}

/// With spectra as the linear RGB they have under D65.
MaterialSpec in_rgb(const Material& material) {
  MaterialSpec spec{material.id, {}};
  for (const Lobe& lobe : material.lobes) {
    LobeSpec out = default_lobe(model_index(lobe.model));
    out.weight = double(lobe.weight);
    for (std::size_t i = 0; i < lobe.parameters.size(); ++i) {
      if (const float* x = std::get_if<float>(&lobe.parameters[i])) {
        out.values[i].fill(double(*x));
      } else {
        const RGB rgb = std::get<SpectrumSource>(lobe.parameters[i]).to_srgb_reflectance();
        for (std::size_t c = 0; c < 3; ++c)
          out.values[i][c] = double(rgb[int(c)]);
      }
    }
    spec.lobes.push_back(std::move(out));
  }
  return spec;
}

Vec3d direction(std::uint64_t i, std::uint64_t dimension, bool both_sides) {
  const double z = unit_double(hash(i, dimension, 0)), phi = 2 * pi * unit_double(hash(i, dimension, 1));
  const double cosine = 0.05 + 0.95 * z, s = std::sqrt(1 - cosine * cosine);
  const bool below = both_sides && (hash(i, dimension, 2) & 1) != 0;
  return {s * std::cos(phi), s * std::sin(phi), below ? -cosine : cosine};
}

/// @param tolerance  relative; spectra made of RGB return it to within 0.003 (tests/scene)
void expect_same(const MaterialSpec& expected, const MaterialSpec& found, double tolerance) {
  const auto a = make_bsdf<double>(expected), b = make_bsdf<double>(found);
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const Vec3d wo = direction(i, 0, true), wi = direction(i, 1, true);
    const auto f = a.eval(wo, wi), g = b.eval(wo, wi);
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(g[c], f[c], tolerance * f[c] + 1e-4) << expected.name << " at pair " << i;
  }
}

TEST(ExportedToMitsuba, ScattersAsTheMaterialItWasMadeFrom) {
  for (const char* text :
       {"lambert:reflectance=0.7/0.4/0.2", "ggx_conductor:eta=0.4,k=3,alpha_x=0.2,alpha_y=0.4,separable=1",
        "beckmann_conductor:eta=1.2,k=2,alpha_x=0.3,alpha_y=0.3,specular_reflectance=0.9/0.6/0.3,separable=1",
        "ggx_dielectric:eta=1.7,alpha_x=0.3,alpha_y=0.2,specular_transmittance=0.8/0.7/0.6,separable=1",
        "beckmann_dielectric:eta=1.3,alpha_x=0.4,alpha_y=0.4,separable=1",
        "ggx_plastic:diffuse_reflectance=0.6/0.3/0.1,alpha=0.3,separable=1",
        "beckmann_plastic:diffuse_reflectance=0.4,eta=1.7,nonlinear=0,separable=1",
        "smooth_plastic:diffuse_reflectance=0.6/0.3/0.1,eta=1.4",
        "disney_2015:base_color=0.6/0.3/"
        "0.1,metallic=0.4,roughness=0.4,sheen=0.3,clearcoat=0.5,spec_trans=0.5",
        "0.4*ggx_conductor:eta=0.4,k=3,separable=1+lambert:reflectance=0.5/0.3/0.2",
        "0.3*ggx_conductor:eta=0.4,k=3,separable=1+0.2*beckmann_conductor:separable=1+"
        "0.5*lambert:reflectance=0.5/0.3/0.2"}) {
    const MaterialSpec material = parse_material(text);
    const Translation t = translate(material, ".xml");
    expect_same(material, in_rgb(read_back(t.text)), 0.01);
  }
}

TEST(ExportedToMitsuba, AFitIsReadBackAsWhatItsErrorWasStatedFor) {
  const MaterialSpec material =
      parse_material("ggx_schlick:f0=0.05,alpha=0.3+lambert:reflectance=0.4/0.2/0.1");
  for (const char* model : {"ggx_plastic", "ggx_conductor+lambert", "disney_2015"}) {
    const Translation t = translate(material, ".xml", {.model = model});
    EXPECT_TRUE(t.fitted);
    // Indices of a conductor far from grey come back from their spectra less exactly.
    expect_same(t.target, in_rgb(read_back(t.text)), 0.02);
  }
}

TEST(ExportedToMitsuba, TheMaskingThatMitsubaLacksIsWithinTheStatedError) {
  const MaterialSpec material = parse_material("ggx_conductor:eta=0.4,k=3,alpha_x=0.3,alpha_y=0.3");
  const Translation t = translate(material, ".xml");
  ASSERT_FALSE(t.is_exact());
  const auto a = make_bsdf<double>(material), b = make_bsdf<double>(in_rgb(read_back(t.text)));
  double worst = 0;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const Vec3d wo = direction(i, 0, false), wi = direction(i, 1, false);
    if (wo.z < 0.18 || wi.z < 0.18) continue; // 80 degrees
    for (int c = 0; c < 3; ++c)
      worst = std::max(worst,
                       std::abs(b.eval(wo, wi)[c] - a.eval(wo, wi)[c]) / std::max(a.eval(wo, wi)[c], 1e-3));
  }
  EXPECT_LT(worst, 1.05 * t.error.relative + 0.002);
}

} // namespace
} // namespace nacre
