// Nacre's own models in scene files: by name, as on the command line, and as a fit wrote them.
#include "bsdf/list.h"
#include "core/image.h"
#include "measured/material_spec.h"
#include "small_scene.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

using testing::HasSubstr;

Material material(const std::string& bsdf, const MitsubaOptions& options = {}) {
  const Scene scene = parse("<shape type='rectangle'>" + bsdf + "</shape>", options);
  return scene.materials.at(static_cast<std::size_t>(scene.shapes.at(0).material));
}
std::string whole(const std::string& text) {
  return "<bsdf type='nacre'><string name='material' value='" + text + "'/></bsdf>";
}

TEST(ListedModels, EachIsABsdfOfItsNameWithItsDefaults) {
  for (const ModelInfo& model : model_infos()) {
    const Material m = material("<bsdf type='" + model.name + "'/>");
    ASSERT_EQ(m.lobes.size(), 1u);
    EXPECT_EQ(m.lobes[0].model, model.name);
    EXPECT_EQ(m.lobes[0].parameters.size(), model.parameters.size());
  }
}

TEST(ListedModels, TakeTheirDeclaredParameters) {
  const Material m = material("<bsdf type='oren_nayar'><rgb name='reflectance' value='0.9 0.5 0.1'/>"
                              "<float name='sigma' value='0.7'/></bsdf>");
  EXPECT_EQ(std::get<float>(m.lobes[0].parameters[1]), 0.7f);
  const RGB color = std::get<SpectrumSource>(m.lobes[0].parameters[0]).to_srgb_reflectance();
  EXPECT_NEAR(color[0], 0.9, 3e-3); // what a sigmoid spectrum returns
  EXPECT_NEAR(color[1], 0.5, 3e-3);
  EXPECT_NEAR(color[2], 0.1, 3e-3);
}

TEST(ListedModels, TakeNegativeNumbersWhereTheirDomainHasThem) {
  const Material m = material("<bsdf type='lafortune'><float name='cx' value='-0.5'/></bsdf>");
  const auto& declared = find_model("lafortune");
  EXPECT_EQ(std::get<float>(m.lobes[0].parameters[declared.parameter_index("cx")]), -0.5f);
  EXPECT_EQ(std::get<float>(m.lobes[0].parameters[declared.parameter_index("cy")]), -1);
  const Material text = material(whole("lafortune:cx=-0.5"));
  EXPECT_EQ(std::get<float>(text.lobes[0].parameters[declared.parameter_index("cx")]), -0.5f);
}

TEST(ListedModels, RefuseWhatTheyDoNotDeclareOrAllow) {
  EXPECT_THAT(error("<bsdf type='oren_nayar' id='a'><float name='sigm' value='0.7'/></bsdf>"),
              HasSubstr("'sigma'"));
  EXPECT_THAT(error("<bsdf type='oren_nayar' id='a'><float name='sigma' value='2'/></bsdf>"),
              HasSubstr("[0, 1.5]"));
  EXPECT_THAT(error("<bsdf type='oren_nayer' id='a'/>"), HasSubstr("did you mean 'oren_nayar'"));
}

TEST(WholeMaterial, IsReadAsOnTheCommandLine) {
  const Material m = material(whole("ggx_schlick:f0=0.9/0.6/0.3,alpha=0.25+lambert:reflectance=0.1"));
  ASSERT_EQ(m.lobes.size(), 2u);
  EXPECT_EQ(m.lobes[0].model, "ggx_schlick");
  EXPECT_EQ(std::get<float>(m.lobes[0].parameters[1]), 0.25f);
  EXPECT_FLOAT_EQ(std::get<SpectrumSource>(m.lobes[1].parameters[0]).eval(550), 0.1f);
}

TEST(WholeMaterial, IsReadFromTheFileOfAFit) {
  const ScratchFolder folder;
  folder.write("fit.json", to_json(parse_material("ggx_schlick:f0=0.5,alpha=0.3+lambert")).dump());
  const Material m = material("<bsdf type='nacre'><string name='filename' value='fit.json'/></bsdf>",
                              {{folder.path()}, {}, false});
  ASSERT_EQ(m.lobes.size(), 2u);
  EXPECT_EQ(std::get<float>(m.lobes[0].parameters[1]), 0.3f);
}

TEST(WholeMaterial, ErrorsHaveTheirPlace) {
  EXPECT_THAT(error(whole("lambertt")), HasSubstr("s.xml:1:"));
  EXPECT_THAT(error(whole("lambertt")), HasSubstr("'lambert'"));
  EXPECT_THAT(error("<bsdf type='nacre' id='a'/>"), HasSubstr("needs either 'material'"));
}

TEST(WholeMaterial, ThatTransmitsIsNotTwoSided) {
  EXPECT_THAT(error("<bsdf type='twosided' id='a'>" + whole("ggx_dielectric") + "</bsdf>"),
              HasSubstr("transmits light"));
}

} // namespace
} // namespace nacre
