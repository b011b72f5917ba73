// Materials in the words of other programs: nothing is lost where the format has the words, the error is said
// where it has not, and what is written is well formed.
#include "fit/export_material.h"

#include "core/error.h"
#include "core/scratch_folder.h"
#include "fit/export/brdf_shaders.h"
#include "fit/export/evaluated_material.h"
#include "fit/export/target.h"
#include "fit/metric.h"
#include "synthetic.h"

#include <fstream>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <numeric>
#include <regex>

namespace nacre {
namespace {

using testing::HasSubstr;
using testing::Not;

Translation written(const std::string& material, std::string_view ending, const std::string& as = "") {
  return translate(parse_material(material), ending, {.model = as});
}
std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    ++n;
  return n;
}
/// Every element is closed by its own name, in order.
void expect_balanced(const std::string& xml) {
  const std::string text = std::regex_replace(xml, std::regex("<!--[^]*?-->|<\\?[^]*?\\?>"), "");
  std::vector<std::string> open;
  const std::regex tag("<(/?)([A-Za-z_]+)([^<>]*?)(/?)>");
  for (std::sregex_iterator i(text.begin(), text.end(), tag), end; i != end; ++i) {
    if ((*i)[4] == "/") continue;
    if ((*i)[1] == "/") {
      ASSERT_FALSE(open.empty()) << xml;
      EXPECT_EQ(open.back(), (*i)[2]) << xml;
      open.pop_back();
    } else {
      open.push_back((*i)[2]);
    }
  }
  EXPECT_TRUE(open.empty()) << xml;
}

TEST(Export, WritesTheModelsOwnWordsWithoutError) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases{
      {"lambert:reflectance=0.2/0.5/0.7", {".json", ".brdf", ".xml", ".pbrt", ".gltf", ".mtlx"}},
      {"ggx_conductor:metal=Au,alpha_x=0.1,alpha_y=0.3", {".json", ".brdf", ".pbrt", ".mtlx"}},
      {"ggx_conductor:metal=Au,alpha_x=0.1,alpha_y=0.3,separable=1", {".xml"}},
      {"beckmann_plastic:alpha=0.2,separable=1", {".xml"}},
      {"ggx_plastic:alpha=0.2", {".pbrt"}},
      {"ggx_schlick:f0=0.3/0.2/0.1+lambert:reflectance=0.2", {".json", ".brdf", ".mtlx"}},
      {"0.3*ggx_conductor:separable=1+lambert:reflectance=0.6/0.2/0.1", {".xml"}},
      {"0.4*ggx_conductor+0.5*lambert", {".pbrt"}},
      {"oren_nayar:sigma=0.5", {".brdf", ".mtlx"}},
      {"ggx_dielectric:separable=1", {".xml"}},
      {"ggx_dielectric", {".pbrt", ".mtlx"}},
      {"gltf:metallic=0.3,clearcoat=0.5", {".gltf"}},
      {"openpbr:base_metalness=0.3,coat_weight=0.5", {".mtlx"}},
      {"disney_2015:metallic=0.3", {".xml"}}};
  for (const auto& [material, endings] : cases)
    for (const std::string& ending : endings) {
      const Translation t = written(material, ending);
      EXPECT_TRUE(t.is_exact()) << material << " " << ending << "\n" << to_text(t);
      EXPECT_FALSE(t.fitted) << material << " " << ending;
    }
}

TEST(Export, ErrorIsThatOfTheMetricOverTheWholeGrid) {
  // Mitsuba has the product of masking and shadowing alone.
  const std::string source = "ggx_dielectric:alpha_x=0.5,alpha_y=0.5";
  const Translation t = written(source, ".xml");
  const MerlTable table = tabulate(source, 0, 0, {90, 90, 180});
  const MetricErrors whole = metric_errors(table, parse_material(source + ",separable=1"), 80);
  EXPECT_GT(whole.of(Metric::log), 1e-4);
  EXPECT_NEAR(t.error.log / whole.of(Metric::log), 1, 0.02);
  EXPECT_NEAR(t.error.cosine / whole.of(Metric::cosine), 1, 0.02);
  EXPECT_FALSE(t.is_exact());
  EXPECT_THAT(t.text, HasSubstr("Mapping error: log"));
}

TEST(Export, WhatTheFormatLacksIsFitted) {
  const std::string source = "ggx_schlick:f0=0.05,alpha=0.3+lambert:reflectance=0.4/0.2/0.1";
  for (const char* ending : {".pbrt", ".gltf"}) {
    const Translation t = written(source, ending);
    EXPECT_TRUE(t.fitted) << ending;
    EXPECT_LT(t.error.log, 0.02) << to_text(t); // black would be some 0.1
    EXPECT_GT(t.error.relative, 1e-3) << to_text(t);
    EXPECT_THAT(t.text, HasSubstr("fitted to the material")) << ending;
    EXPECT_THAT(t.text, HasSubstr("largest relative difference")) << ending;
  }
}

TEST(Export, AnotherMaskingIsMadeUpForByAFitOfTheSameModel) {
  const std::string source = "ggx_conductor:eta=1.5,k=4,alpha_x=0.5,alpha_y=0.5";
  const Translation t = written(source, ".xml", "ggx_conductor");
  const MetricErrors unfitted =
      metric_errors(EvaluatedMaterial(parse_material(source), 2, 4), parse_material(source + ",separable=1"));
  EXPECT_TRUE(t.fitted);
  EXPECT_LT(t.error.log, unfitted.of(Metric::log));
}

TEST(Export, AMeasurementIsFitted) {
  LobeSpec lobe;
  lobe.measured = std::make_shared<MerlTable>(tabulate("ggx_plastic:alpha=0.3,diffuse_reflectance=0.3"));
  const Translation t = translate({"measured", {lobe}}, ".pbrt", {.model = "ggx_plastic"});
  EXPECT_TRUE(t.fitted);
  EXPECT_LT(t.error.log, 1e-3);
  EXPECT_NEAR(number(t.target.lobes[0], "alpha"), 0.3, 1e-3);
}

TEST(Export, AMaterialThatIsNotIsotropicIsComparedAtAllAzimuths) {
  const EvaluatedMaterial brushed(parse_material("ward:alpha_x=0.05,alpha_y=0.5"), 8, 18),
      round(parse_material("ward:alpha_x=0.5,alpha_y=0.5"), 8, 18);
  EXPECT_FALSE(brushed.is_isotropic());
  EXPECT_TRUE(round.is_isotropic());
  double x = 0, y = 0;
  for (const Vec3f& wo : brushed.samples().wo)
    x += sqr(wo.x), y += sqr(wo.y);
  EXPECT_NEAR(x / y, 1, 0.02);
}

TEST(Export, RefusesWhatAFormatCannotHoldAndSaysWhy) {
  const auto message = [](const std::string& material, const std::string& ending,
                          const std::string& as = "") {
    try {
      written(material, ending, as);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(message("ggx_dielectric", ".brdf"), HasSubstr("transmits light"));
  EXPECT_THAT(message("smooth_conductor", ".brdf"), HasSubstr("ggx_conductor:alpha_x=0.001"));
  EXPECT_THAT(message("lambert", ".xlm"), HasSubstr("did you mean '.xml'"));
  EXPECT_THAT(message("lambert", ".mtlx", "openpbrr"), HasSubstr("did you mean 'openpbr'"));
}

TEST(Export, LeavesNoFileWhereItFails) {
  const ScratchFolder folder;
  EXPECT_THROW(export_material(parse_material("ggx_dielectric"), folder / "a.brdf"), Error);
  EXPECT_FALSE(std::ifstream(folder / "a.brdf").good());
  export_material(parse_material("lambert"), folder / "a.brdf");
  EXPECT_TRUE(std::ifstream(folder / "a.brdf").good());
}

TEST(ExportedBrdf, DeclaresEveryParameterWithItsRangeAndPassesItOn) {
  for (const Shader& shader : model_shaders()) {
    const ModelInfo& model = find_model(shader.name);
    std::string signature = "vec3 " + model.name + "(vec3 wo, vec3 wi";
    for (const ParameterInfo& p : model.parameters)
      signature += (p.per_channel ? ", vec3 " : ", float ") + p.name;
    const std::string text = std::regex_replace(std::string(shader.text), std::regex("\\s+"), " ");
    EXPECT_THAT(text, HasSubstr(signature + ")"));
    const Translation t = written(model.name, ".brdf");
    for (const ParameterInfo& p : model.parameters) {
      const std::string line = !p.per_channel
                                   ? "\nfloat " + p.name + " " + digits(p.lo) + " " + digits(p.hi) + " "
                               : p.lo >= 0 && p.hi <= 1 ? "\ncolor " + p.name + " "
                                                        : "\nfloat " + p.name + "_g " + digits(p.lo);
      EXPECT_EQ(count(t.text, line), 1u) << model.name << line;
    }
  }
}

TEST(ExportedBrdf, IsGlslThatCompiles) {
  if (std::system("glslangValidator --version > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "glslangValidator (package glslang-tools) is not installed";
  const ScratchFolder folder;
  std::vector<std::string> materials{"0.5*ggx_schlick+2*lambert+lambert:reflectance=0.1"};
  for (const Shader& shader : model_shaders())
    materials.emplace_back(shader.name);
  std::string files;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const std::string text = written(materials[i], ".brdf").text;
    std::string shader = "#version 410\n";
    std::istringstream lines(text);
    bool parameters = false;
    for (std::string line, type, name; std::getline(lines, line);) {
      if (line.starts_with("::")) parameters = line == "::begin parameters";
      std::istringstream words(line);
      if (parameters && words >> type >> name && !type.starts_with("::"))
        shader += "uniform " + (type == "color" ? std::string("vec3 ") : type + " ") + name + ";\n";
    }
    const std::size_t begin = text.find("::begin shader") + 14;
    shader += text.substr(begin, text.find("::end shader") - begin);
    shader += "out vec4 pixel;\nvoid main() { vec3 x = vec3(1, 0, 0), y = x.yxz, n = x.yzx;\n"
              "pixel = vec4(BRDF(n, n, n, x, y), 1); }\n";
    const std::string file = folder / (std::to_string(i) + ".frag");
    std::ofstream(file) << shader;
    files += " " + file;
  }
  EXPECT_EQ(std::system(("glslangValidator" + files + " > " + (folder / "log")).c_str()), 0)
      << std::ifstream(folder / "log").rdbuf();
}

TEST(ExportedMitsuba, IsBalancedXmlAndMixesToOne) {
  for (const char* material :
       {"lambert", "ggx_dielectric", "smooth_plastic", "thin_dielectric", "disney_2015",
        "0.3*ggx_conductor+0.2*beckmann_conductor+lambert:reflectance=0.3"}) {
    const std::string text = written(material, ".xml").text;
    expect_balanced(text);
    EXPECT_THAT(text, HasSubstr(" id=\"material\">"));
  }
  EXPECT_EQ(
      count(written("0.3*ggx_conductor:separable=1+0.2*ggx_conductor:separable=1+lambert:reflectance=0.3",
                    ".xml")
                .text,
            "type=\"blendbsdf\""),
      2u);
}

TEST(ExportedPbrt, NamesItsMaterialsAndGivesIndicesAsSpectra) {
  const std::string gold = written("ggx_conductor:metal=Au,alpha_x=0.1,alpha_y=0.3", ".pbrt").text;
  EXPECT_THAT(gold, HasSubstr("MakeNamedMaterial \"material\"\n  \"string type\" [ \"conductor\" ]"));
  EXPECT_THAT(gold, HasSubstr("\"spectrum eta\" [ 360 "));
  EXPECT_THAT(gold, HasSubstr("\"float vroughness\" [ 0.3 ]"));
  EXPECT_THAT(gold, HasSubstr("\"bool remaproughness\" [ false ]"));
  const std::string mix = written("0.4*ggx_conductor+0.6*lambert", ".pbrt").text;
  EXPECT_THAT(mix, HasSubstr("\"string materials\" [ \"material-lobe1\" \"material-lobe2\" ]"));
  EXPECT_THAT(mix, HasSubstr("\"float amount\" [ 0.6 ]"));
}

TEST(ExportedGltf, UsesTheExtensionsItNeedsAndNoOthers) {
  const auto json = [](const std::string& material) {
    return nlohmann::json::parse(written(material, ".gltf").text);
  };
  const auto plain = json("gltf:metallic=0.5,roughness=0.3,base_color=0.1/0.2/0.3");
  EXPECT_FALSE(plain.contains("extensionsUsed"));
  EXPECT_EQ(plain["asset"]["version"], "2.0");
  const auto& m = plain["materials"][0]["pbrMetallicRoughness"];
  EXPECT_EQ(m["baseColorFactor"], (nlohmann::json{0.1, 0.2, 0.3, 1}));
  EXPECT_EQ(m["roughnessFactor"], 0.3);
  const auto coated = json("gltf:clearcoat=0.5,ior=1.7,anisotropy=0.3,sheen_color=0.2");
  EXPECT_EQ(coated["extensionsUsed"], (nlohmann::json{"KHR_materials_anisotropy", "KHR_materials_clearcoat",
                                                      "KHR_materials_ior", "KHR_materials_sheen"}));
  EXPECT_EQ(coated["materials"][0]["extensions"]["KHR_materials_ior"]["ior"], 1.7);
}

TEST(ExportedGltf, TurnsWhatIsRougherAlongTheBitangent) {
  const Translation along = written("ggx_conductor:metal=Au,alpha_x=0.4,alpha_y=0.2", ".gltf"),
                    across = written("ggx_conductor:metal=Au,alpha_x=0.2,alpha_y=0.4", ".gltf");
  EXPECT_LT(across.error.log, 0.005);
  EXPECT_NEAR(across.error.log, along.error.log, 0.001);
  const auto json = nlohmann::json::parse(across.text);
  EXPECT_NEAR(json["materials"][0]["extensions"]["KHR_materials_anisotropy"]["anisotropyRotation"], pi / 2,
              1e-6);
}

// The error is taken at one azimuth, which is all of an isotropic material: what is written must be one too.
TEST(ExportedMaterials, OfIsotropicOnesAreIsotropic) {
  for (const auto& [ending, model] :
       {std::pair{".mtlx", "openpbr"}, {".xml", "disney_2015"}, {".gltf", ""}}) {
    const Translation t =
        translate(parse_material("ggx_schlick:f0=0.3,alpha=0.2+lambert"), ending, {.model = model});
    EXPECT_TRUE(is_isotropic(make_bsdf<double>(t.target))) << ending;
  }
}

TEST(ExportedMaterialX, ConnectsEveryNodeToTheMaterial) {
  for (const char* material :
       {"lambert", "ggx_conductor:specular_reflectance=0.5/0.4/0.3+oren_nayar+ggx_schlick", "openpbr",
        "openpbr_thin", "ggx_dielectric"}) {
    const std::string text = written(material, ".mtlx").text;
    expect_balanced(text);
    const std::regex node("<[a-z_]+ name=\"([^\"]+)\" type=\"(BSDF|surfaceshader)\">");
    for (std::sregex_iterator i(text.begin(), text.end(), node), end; i != end; ++i)
      EXPECT_EQ(count(text, "nodename=\"" + (*i)[1].str() + "\""), 1u) << text;
  }
  EXPECT_THAT(written("openpbr:eta=1.7", ".mtlx").text,
              HasSubstr("<input name=\"specular_ior\" type=\"float\" value=\"1.7\" />"));
  EXPECT_THAT(written("openpbr", ".mtlx").text, Not(HasSubstr("wavelength")));
}

TEST(ExportedComments, CannotEndThemselves) {
  MaterialSpec material = parse_material("lambert");
  material.name = "a --> b\n::begin parameters";
  for (const ExportFormat& f : export_formats()) {
    const std::string text = translate(material, f.ending).text;
    if (f.ending == ".xml" || f.ending == ".mtlx") {
      EXPECT_EQ(count(text, "-->"), 1u) << text;
    }
    EXPECT_EQ(count(text, "\n::begin parameters"), f.ending == ".brdf" ? 1u : 0u) << text;
  }
}

TEST(Mixtures, ScaleColoursSoThatWeightsSumToOne) {
  const auto scaled = [](const LobeSpec& lobe) -> std::vector<std::string> {
    if (is_model(lobe, "lambert")) return {"reflectance"};
    return {};
  };
  const auto mixed = [&](const char* text) { return as_mixture(parse_material(text), scaled); };
  const auto m = mixed("0.5*ggx_schlick+lambert:reflectance=0.4/0.2/0.1");
  ASSERT_TRUE(m);
  EXPECT_DOUBLE_EQ(m->lobes[0].weight + m->lobes[1].weight, 1);
  EXPECT_DOUBLE_EQ(m->lobes[1].weight * color(m->lobes[1], "reflectance")[0], 0.4);
  EXPECT_FALSE(mixed("0.5*ggx_schlick+lambert:reflectance=0.6"));
  const auto dark = mixed("0.5*ggx_schlick");
  ASSERT_TRUE(dark);
  ASSERT_EQ(dark->lobes.size(), 2u);
  EXPECT_DOUBLE_EQ(dark->lobes[1].weight, 0.5);
}

} // namespace
} // namespace nacre
