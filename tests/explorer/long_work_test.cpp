#include "explorer/workbench.h"
#include "fit/fit.h"
#include "report/curves.h"

#include <cmath>
#include <gmock/gmock.h>

namespace nacre {
namespace {

using nlohmann::json;
using testing::HasSubstr;

json object(const char* sampling, int samples) {
  return {{"material", {{"text", "lambert:reflectance=0.5"}}},
          {"mesh", "sphere"},
          {"environment", "white"},
          {"width", 24},
          {"height", 24},
          {"sampling", sampling},
          {"samples", samples}};
}

TEST(ExplorerObject, AWhiteSkyLightsItAlikeHoweverLightIsFound) {
  Workbench w;
  for (const char* sampling : {"mis", "bsdf", "light"}) {
    const Answer a = w.ask("object", object(sampling, 256));
    const auto& image = array_of(a, "image");
    ASSERT_EQ(image.shape, (std::vector<std::size_t>{24, 24, 3}));
    // A convex grey body of albedo 1/2 under radiance 1. The lights' own sampling is uniform over the sphere:
    // a sample of f L cos / pdf has a standard deviation of 0.6, so 256 have 0.04.
    EXPECT_NEAR(image.data[(12 * 24 + 12) * 3 + 1], 0.5, 0.15) << sampling;
    double mean = 0;
    for (int y = 9; y < 15; ++y)
      for (int x = 9; x < 15; ++x)
        mean += double(image.data[std::size_t((y * 24 + x) * 3 + 1)]) / 36;
    EXPECT_NEAR(mean, 0.5, 0.025) << sampling;
    EXPECT_EQ(a.header["samples"], 256);
  }
  EXPECT_THAT(w.error("object", object("mist", 1)), HasSubstr("mis"));
}

TEST(ExplorerObject, EveryMeshAndEnvironmentRenders) {
  Workbench w;
  w.folder.write("m.obj", "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  Image sky(8, 4, {"R", "G", "B"});
  std::fill(sky.data.begin(), sky.data.end(), 1.0f);
  write_exr(sky, w.folder / "e.exr");
  std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n";
  for (int i = 0; i < 16; ++i)
    hdr += "\x80\x80\x80\x81";
  w.folder.write("e.hdr", hdr);
  // A triangle, by a buffer within the file.
  w.folder.write("m.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri":
    "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
  for (const char* mesh : {"sphere", "teapot", "plane", "m.obj", "m.gltf"})
    for (const char* environment : {"white", "e.exr", "e.hdr"}) {
      json ask = object("mis", 16);
      ask["mesh"] = mesh, ask["environment"] = environment;
      const auto image = array_of(w.ask("object", ask), "image");
      EXPECT_TRUE(std::all_of(image.data.begin(), image.data.end(), [](float v) { return v >= 0 && v < 3; }));
      EXPECT_LT(*std::min_element(image.data.begin(), image.data.end()), 0.8) << mesh << " is not seen";
    }
  json ask = object("mis", 1);
  ask["mesh"] = "../m.obj";
  EXPECT_THAT(w.error("object", ask), HasSubstr("'..'"));
}

TEST(ExplorerObject, CancelEndsWhatHasNoEnd) {
  Workbench w;
  w.on_progress = [&] { w.cancelled = true; };
  const Answer a = w.ask("object", object("mis", 0));
  EXPECT_EQ(a.header["complete"], false);
  EXPECT_FALSE(w.progress.empty());
}

constexpr const char* scene = R"(<scene version="3.0.0">
  <integrator type="path"/>
  <sensor type="perspective"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="20"/><integer name="height" value="20"/></film>
    <sampler type="independent"><integer name="sample_count" value="16"/></sampler></sensor>
  <emitter type="constant"/>
  <bsdf type="diffuse" id="grey"><rgb name="reflectance" value="0.5"/></bsdf>
  <shape type="sphere"><ref id="grey"/></shape>
</scene>)";

TEST(ExplorerRender, SwapsMaterialsAndTurnsTheCamera) {
  Workbench w;
  w.folder.write("s.xml", scene);
  const Answer plain = w.ask("render", {{"scene", "s.xml"}});
  EXPECT_EQ(array_of(plain, "image").shape, (std::vector<std::size_t>{20, 20, 3}));
  const json first = w.progress.empty() ? plain.header : w.progress.front().second.header;
  EXPECT_EQ(first.at("materials"), json::array({"grey"}));
  EXPECT_NEAR(first.at("camera").at("distance").get<double>(), 5, 1e-6);
  EXPECT_NEAR(first.at("camera").at("azimuth").get<double>(), 0, 1e-6);
  const std::size_t middle = (10 * 20 + 10) * 3;
  EXPECT_NEAR(array_of(plain, "image").data[middle + 1], 0.5, 0.08);
  const Answer swapped = w.ask(
      "render",
      {{"scene", "s.xml"}, {"swap", {{"grey", {{"text", "lambert:reflectance=0.1"}}}}}, {"samples", 32}});
  EXPECT_NEAR(array_of(swapped, "image").data[middle + 1], 0.1, 0.03);
  // From where it stands, and turned round half: the sphere is in the middle still.
  json turned = first.at("camera");
  turned["azimuth"] = 180, turned["elevation"] = 35;
  const Answer back = w.ask("render", {{"scene", "s.xml"}, {"camera", turned}, {"scale", 0.5}});
  EXPECT_EQ(array_of(back, "image").shape, (std::vector<std::size_t>{10, 10, 3}));
  EXPECT_NEAR(array_of(back, "image").data[(5 * 10 + 5) * 3 + 1], 0.5, 0.12);
  EXPECT_THAT(w.error("render", {{"scene", "s.xml"}, {"swap", {{"gray", {{"text", "lambert"}}}}}}),
              HasSubstr("grey"));
  EXPECT_THAT(w.error("render", {{"scene", "none.xml"}}), HasSubstr("no such file"));
}

TEST(ExplorerPicture, IsInspectedShownAndSaved) {
  Workbench w;
  w.ask("object", object("mis", 64));
  const auto of = w.last_id;
  const json pixel = w.ask("inspect", {{"of", of}, {"x", 12}, {"y", 12}}).header;
  EXPECT_EQ(pixel["material"], "lambert:reflectance=0.5");
  EXPECT_EQ(pixel["samples"], 64);
  EXPECT_NEAR(pixel["rgb"][0].get<double>(), 0.5, 0.1);
  // Grey under D65: as bright in the middle of the spectrum as the light is.
  EXPECT_EQ(pixel["spectrum"]["radiance"].size(), pixel["spectrum"]["wavelength_nm"].size());
  EXPECT_EQ(w.ask("inspect", {{"of", of}, {"x", 0}, {"y", 0}}).header["material"], nullptr);
  EXPECT_THAT(w.error("inspect", {{"of", of}, {"x", 24}, {"y", 0}}), HasSubstr("'x'"));
  const Answer shown = w.ask("display", {{"of", of}, {"operator", "reinhard"}, {"exposure", 1}});
  for (const float v : array_of(shown, "image").data)
    ASSERT_TRUE(v >= 0 && v <= 1);
  EXPECT_THAT(w.error("display", {{"of", of}, {"operator", "reinhart"}}), HasSubstr("reinhard"));
  EXPECT_THAT(w.error("display", {{"of", 999}}), HasSubstr("999"));
  w.ask("save", {{"of", of}, {"file", "p.exr"}});
  w.ask("save", {{"of", of}, {"file", "p.png"}});
  EXPECT_EQ(read_exr(w.folder / "p.exr").width, 24);
  EXPECT_EQ(read_ldr(w.folder / "p.png").height, 24);
  EXPECT_THAT(w.error("save", {{"of", of}, {"file", "../p.png"}}), HasSubstr("'..'"));
}

TEST(ExplorerFit, RecoversTheModelThatMadeTheTable) {
  Workbench w;
  const auto truth = make_bsdf<double>(parse_material("lambert:reflectance=0.2/0.4/0.6"));
  const auto table =
      MerlTable::tabulate(24, 12, 16, [&](double h, double d, double p) -> std::array<double, 3> {
        const auto pair = directions(HalfDifference<double>{h, d, p});
        if (pair.wo.z <= 0 || pair.wi.z <= 0) return {-1, -1, -1};
        return truth.eval(pair.wo, pair.wi).c;
      });
  write_merl(table, w.folder / "t.binary");
  const json h = w.ask("fit", {{"measured", "t.binary"},
                               {"models", {"lambert", "oren_nayar"}},
                               {"metric", "log"},
                               {"starts", 2}})
                     .header;
  ASSERT_EQ(h["results"].size(), 2u);
  const json& fit = h["results"][0];
  EXPECT_EQ(fit["model"], "lambert");
  EXPECT_LT(fit["errors"]["log"].get<double>(), 1e-5);
  ASSERT_EQ(fit["parameters"].size(), 3u);
  EXPECT_EQ(fit["parameters"][1]["name"], "reflectance.g");
  EXPECT_NEAR(fit["parameters"][1]["value"].get<double>(), 0.4, 1e-4);
  // What comes back is a material.
  EXPECT_EQ(w.ask("material", {{"material", fit["material"]}}).header["kind"], "model");
  EXPECT_GE(w.progress.size(), 2u);
  EXPECT_THAT(w.error("fit", {{"measured", {{"text", "smooth_conductor"}}}, {"models", {"lambert"}}}),
              HasSubstr("mirror"));
  // What hello offers is what a fit takes, and says of what it found.
  for (const json& metric : w.ask("hello", {}).header["metrics"]) {
    const json one =
        w.ask("fit",
              {{"measured", "t.binary"}, {"models", {"lambert"}}, {"metric", metric["name"]}, {"starts", 1}})
            .header["results"][0];
    EXPECT_LT(one["errors"][metric["name"].get<std::string>()].get<double>(), 1e-4) << metric;
  }
  EXPECT_EQ(w.ask("hello", {}).header["metrics"].size(), all_metrics.size());
  EXPECT_EQ(w.ask("hello", {}).header["metrics"][0]["name"], metric_name(FitOptions().metric));
}

/// A table of two lobes that takes some time to fit.
void write_two_lobes(const ScratchFolder& folder) {
  const auto truth = make_bsdf<double>(
      parse_material("ggx_schlick:f0=0.9/0.6/0.3,alpha=0.3+oren_nayar:reflectance=0.1,sigma=0.4"));
  const auto table =
      MerlTable::tabulate(90, 90, 90, [&](double h, double d, double p) -> std::array<double, 3> {
        const auto pair = directions(HalfDifference<double>{h, d, p});
        if (pair.wo.z <= 0 || pair.wi.z <= 0) return {-1, -1, -1};
        return truth.eval(pair.wo, pair.wi).c;
      });
  write_merl(table, folder / "two.binary");
}

TEST(ExplorerFit, ShowsTheBestSoFarWhileItConverges) {
  Workbench w;
  write_two_lobes(w.folder);
  const json h =
      w.ask("fit", {{"measured", "two.binary"}, {"models", {"ggx_conductor+oren_nayar"}}, {"starts", 8}})
          .header;
  EXPECT_EQ(h["results"].size(), 1u);
  ASSERT_GE(w.progress.size(), 3u);
  const json &first = w.progress.front().second.header, &last = w.progress.back().second.header;
  EXPECT_LT(last["best_error"].get<double>(), 0.5 * first["best_error"].get<double>());
  EXPECT_LT(first["iteration"].get<int>(), 20) << "there is something to see at once";
  for (std::size_t i = 1; i < w.progress.size(); ++i)
    EXPECT_GE(w.progress[i].first, w.progress[i - 1].first);
  EXPECT_EQ(w.ask("material", {{"material", first["material"]}}).header["kind"], "model");
}

TEST(ExplorerFit, CancelEndsItAtTheNextStepAndKeepsWhatWasFitted) {
  Workbench w;
  write_two_lobes(w.folder);
  // Told of the second model: the first one is done.
  w.on_progress = [&] { w.cancelled = w.progress.back().second.header["model"] != "lambert"; };
  const auto began = std::chrono::steady_clock::now();
  const json h = w.ask("fit", {{"measured", "two.binary"},
                               {"models", {"lambert", "ggx_schlick+ggx_schlick+oren_nayar"}},
                               {"starts", 200}})
                     .header;
  ASSERT_EQ(h["results"].size(), 1u);
  EXPECT_EQ(h["results"][0]["model"], "lambert");
  EXPECT_FALSE(h["results"][0].contains("failed"));
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20)) << "200 starts take minutes";
}

TEST(ExplorerValidate, CancelEndsItAndLawsAreToldOneByOne) {
  Workbench w;
  std::size_t told = 0;
  w.on_progress = [&] {
    const json& h = w.progress.back().second.header;
    if (h.contains("laws")) told = h["laws"].size();
    w.cancelled = told >= 3;
  };
  const auto began = std::chrono::steady_clock::now();
  const Answer a = w.ask("validate", {{"material", {{"text", "ggx_plastic"}}}, {"samples", 10000000}});
  EXPECT_EQ(told, 3u);
  EXPECT_FALSE(a.header.contains("laws"));
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20)) << "10^7 samples take longer";
}

TEST(ExplorerValidate, TellsWhatIsBrokenAndWhere) {
  Workbench w;
  const Answer good = w.ask("validate", {{"material", {{"text", "lambert"}}}, {"samples", 2000}});
  EXPECT_EQ(good.header["holds"], true);
  EXPECT_EQ(array_of(good, "reciprocity_map").shape, (std::vector<std::size_t>{46, 46}));
  // The energy map is the albedo per angle: lambert's default reflectance of a half.
  const auto& energy = array_of(good, "energy_map").data;
  double albedo = 0;
  for (std::size_t o = 0; o < 46; ++o)
    albedo += double(energy[10 * 46 + o]) * (2 * pi / 180);
  EXPECT_NEAR(albedo, 0.5, 2e-3);
  EXPECT_EQ(array_of(good, "albedo").shape[1], 3u);
  const json gains{{"brdf",
                    {{"name", "g.brdf"},
                     {"source", "analytic\n::begin shader\nvec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) "
                                "{ return vec3(L.z); }\n::end shader\n"}}}};
  const Answer bad = w.ask("validate", {{"material", gains}, {"samples", 2000}});
  EXPECT_EQ(bad.header["holds"], false);
  bool found = false;
  for (const json& law : bad.header["laws"])
    if (law["name"] == "reciprocity") {
      found = true;
      EXPECT_EQ(law["verdict"], "violated");
      EXPECT_TRUE(law["where"].contains("theta_i") && law["where"].contains("theta_o")) << law;
    }
  EXPECT_TRUE(found);
}

TEST(ExplorerPhysics, EveryTopicAnswersByItsOwnDefaults) {
  Workbench w;
  for (const char* topic : {"snell", "fresnel", "lambert", "inverse_square", "solid_angle", "radiance", "ndf",
                            "visible_normals", "masking", "projected_area", "multiple_bounces", "furnace"}) {
    const Answer a = w.ask("physics", {{"topic", topic}, {"material", {{"text", "ggx_conductor"}}}});
    const auto &x = array_of(a, "x"), &y = array_of(a, "y");
    EXPECT_EQ(y.shape[1], x.shape[0]) << topic;
    EXPECT_EQ(y.shape[0], a.header["series"].size()) << topic;
    EXPECT_FALSE(a.header["formula"].get<std::string>().empty());
    EXPECT_FALSE(a.header["source"].get<std::string>().empty());
  }
  EXPECT_THAT(w.error("physics", {{"topic", "snel"}}), HasSubstr("snell"));
}

TEST(ExplorerPhysics, NumbersAreThoseOfTheBooks) {
  Workbench w;
  const auto values = [&](json ask) { return w.ask("physics", std::move(ask)).header["values"]; };
  const json glass = values({{"topic", "snell"}, {"eta_i", 1.5}, {"eta_t", 1}, {"theta_i", 30}});
  EXPECT_NEAR(glass["theta_t"].get<double>(), 48.590378, 1e-5); // asin 0.75
  EXPECT_NEAR(glass["critical"].get<double>(), 41.810315, 1e-5);
  EXPECT_EQ(values({{"topic", "snell"}, {"theta_i", 30}})["critical"], nullptr);
  EXPECT_NEAR(values({{"topic", "snell"}, {"theta_i", 0}})["reflectance"].get<double>(), 0.04, 1e-6);
  EXPECT_NEAR(values({{"topic", "solid_angle"}, {"half_angle", 90}})["projected"].get<double>(), pi, 1e-9);
  EXPECT_NEAR(values({{"topic", "solid_angle"}, {"half_angle", 90}})["solid_angle"].get<double>(), 2 * pi,
              1e-9);
  for (const char* distribution : {"ggx", "beckmann"}) {
    EXPECT_NEAR(
        values({{"topic", "ndf"}, {"distribution", distribution}, {"alpha", 0.3}})["integral"].get<double>(),
        1, 2e-3);
    EXPECT_NEAR(
        values({{"topic", "visible_normals"}, {"distribution", distribution}, {"theta_o", 70}})["integral"]
            .get<double>(),
        1, 2e-3);
    const json area = values({{"topic", "projected_area"}, {"distribution", distribution}, {"theta_o", 75}});
    EXPECT_NEAR(area["area seen"].get<double>(), area["cos θo"].get<double>(), 2e-3);
  }
  const json gold = values({{"topic", "fresnel"}, {"metal", "Au"}, {"theta_i", 0}});
  EXPECT_GT(gold["r"].get<double>(), gold["b"].get<double>() + 0.3);
  const double lost =
      values({{"topic", "multiple_bounces"}, {"metal", "Au"}, {"alpha", 0.9}})["lost"].get<double>();
  EXPECT_GT(lost, 0.05);
  EXPECT_LT(lost, 0.4);
}

} // namespace
} // namespace nacre
