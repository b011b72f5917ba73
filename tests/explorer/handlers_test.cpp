#include "explorer/workbench.h"
#include "report/material_images.h"
#include "report/material_plots.h"

#include <cmath>
#include <gmock/gmock.h>

namespace nacre {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr double radians = pi / 180;

TEST(ExplorerHello, ListsEveryModelWithItsDeclarations) {
  Workbench w;
  w.shop.start.materials = {"lambert"};
  const json h = w.ask("hello", {}).header;
  ASSERT_EQ(h["models"].size(), model_infos().size());
  EXPECT_EQ(h["models"][0]["name"], model_infos()[0].name);
  EXPECT_EQ(h["models"][0]["parameters"].size(), model_infos()[0].parameters.size());
  EXPECT_EQ(h["start"], json::array({{{"text", "lambert"}}}));
  EXPECT_FALSE(h["operators"].empty());
}

TEST(ExplorerMaterial, WhatIsAnsweredCanBeAskedAgain) {
  Workbench w;
  const json first =
      w.ask("material", {{"material", {{"text", "0.5*ggx_conductor:metal=Au,alpha_x=0.35+lambert"}}}}).header;
  EXPECT_EQ(first["kind"], "model");
  ASSERT_EQ(first["lobes"].size(), 2u);
  EXPECT_EQ(first["lobes"][0]["weight"], 0.5);
  EXPECT_EQ(first["is_isotropic"], false);
  json again{{"name", first["name"]}, {"lobes", json::array()}};
  for (const json& lobe : first["lobes"]) {
    json parameters = json::object();
    for (const json& p : lobe["parameters"])
      parameters[p["name"].get<std::string>()] = p["value"];
    again["lobes"].push_back(
        {{"model", lobe["model"]}, {"weight", lobe["weight"]}, {"parameters", parameters}});
  }
  EXPECT_EQ(w.ask("material", {{"material", again}}).header["lobes"], first["lobes"]);
}

TEST(ExplorerMaterial, ErrorsNameTheNearestModel) {
  Workbench w;
  EXPECT_THAT(w.error("material", {{"material", {{"text", "lambrt"}}}}), HasSubstr("lambert"));
  EXPECT_THAT(w.error("material", {{"material", json::object()}}), HasSubstr("'text'"));
  EXPECT_THAT(w.error("material", {{"material", 3}}), HasSubstr("object"));
  EXPECT_THAT(w.error("material", json::object()), HasSubstr("'material'"));
}

/// f at one pair, as `nacre eval` computes it.
std::array<double, 3> eval(const std::string& material, const Vec3d& wo, const Vec3d& wi) {
  return make_bsdf<double>(parse_material(material)).eval(wo, wi).c;
}

TEST(ExplorerCurves, AreWhatEvalSays) {
  Workbench w;
  const std::string text = "ggx_conductor:metal=Cu,alpha_x=0.3,alpha_y=0.2+lambert:reflectance=0.1/0.2/0.3";
  const double theta_i = 40, phi_i = 20;
  for (const char* kind : {"theta_h", "theta_d", "theta_i", "theta_o", "phi", "polar"}) {
    const Answer a = w.ask("curves", {{"materials", {{{"text", text}}, {{"text", "lambert"}}}},
                                      {"kind", kind},
                                      {"theta_i", theta_i},
                                      {"phi_i", phi_i},
                                      {"theta_d", 30},
                                      {"phi_o", 180},
                                      {"points", 90}});
    const NamedArray &x = array_of(a, "x"), &y = array_of(a, "y"), &cosine = array_of(a, "cosine");
    ASSERT_EQ(x.shape, (std::vector<std::size_t>{90}));
    ASSERT_EQ(y.shape, (std::vector<std::size_t>{2, 90, 3}));
    EXPECT_TRUE(std::is_sorted(x.data.begin(), x.data.end()));
    for (std::size_t i = 1; i + 1 < 90; i += 7) {
      const double at = double(x.data[i]);
      Vec3d wo, wi = spherical_direction(theta_i * radians, phi_i * radians);
      const std::string k = kind;
      if (k == "theta_h" || k == "theta_d") {
        const double h = k == "theta_h" ? at : 0, d = k == "theta_h" ? 30 : at;
        const auto pair = directions(HalfDifference<double>{h * radians, d * radians, pi / 2});
        wo = pair.wo, wi = pair.wi;
      } else if (k == "phi") {
        wo = spherical_direction(theta_i * radians, (phi_i + at) * radians);
      } else if (k == "theta_i") {
        wo = spherical_direction(theta_i * radians, (phi_i + 180) * radians);
        wi = spherical_direction(at * radians, phi_i * radians);
      } else {
        wo = spherical_direction(at * radians, (phi_i + 180) * radians);
      }
      const auto f = eval(text, wo, wi);
      for (std::size_t c = 0; c < 3; ++c) // directions in float beside a peak of alpha 0.2
        EXPECT_NEAR(y.data[3 * i + c], f[c], 2e-4 * f[c]) << kind << " at " << at;
      EXPECT_NEAR(cosine.data[i], k == "theta_o" || k == "phi" || k == "polar" ? wo.z : wi.z, 1e-6);
      EXPECT_NEAR(y.data[3 * (90 + i)], 0.5 * inv_pi, 1e-6) << "lambert's default";
    }
  }
}

TEST(ExplorerCurves, HolesAreNotANumberAndModelsWithoutFacetsHaveNoD) {
  Workbench w;
  // A table with holes beyond theta_d = 45 degrees.
  const auto table =
      MerlTable::tabulate(90, 90, 180, [](double, double theta_d, double) -> std::array<double, 3> {
        return theta_d > pi / 4 ? std::array{-1.0, -1.0, -1.0} : std::array{0.25, 0.5, 0.75};
      });
  write_merl(table, w.folder / "holes.binary");
  const Answer a =
      w.ask("curves", {{"materials", {{{"file", "holes.binary"}}}}, {"kind", "theta_d"}, {"points", 91}});
  const auto& y = array_of(a, "y").data;
  EXPECT_NEAR(y[3 * 30 + 1], 0.5, 1e-6);
  EXPECT_TRUE(std::isnan(y[3 * 60]));
  // The same in pictures: theta_d goes upwards in a slice; on a sphere it is half the angle between light and
  // viewer, 30 degrees under light from 60.
  const json material{{"file", "holes.binary"}};
  const auto slice = array_of(w.ask("slice", {{"material", material}, {"size", 9}}), "image");
  EXPECT_TRUE(std::isnan(slice.data[3 * (9 * 2 + 0)]));
  EXPECT_NEAR(slice.data[3 * (9 * 6 + 0)], 0.25, 1e-6);
  const auto centre = [&](double theta_i) {
    return array_of(w.ask("sphere", {{"material", material},
                                     {"size", 33},
                                     {"theta_i", theta_i},
                                     {"phi_i", 0},
                                     {"cosine", false}}),
                    "image")
        .data[3 * (33 * 16 + 22)];
  };
  EXPECT_NEAR(centre(60), 0.25 * pi, 1e-4);
  EXPECT_TRUE(std::isnan(centre(95)));
  const Answer d = w.ask(
      "curves",
      {{"materials", {{{"text", "lambert"}}, {{"text", "ggx_conductor"}}}}, {"kind", "D"}, {"points", 10}});
  EXPECT_TRUE(std::isnan(array_of(d, "y").data[0]));
  EXPECT_GT(array_of(d, "y").data[30], 0);
}

TEST(ExplorerCurves, AlbedoIsThatOfTheMaterial) {
  Workbench w;
  const Answer a = w.ask("curves", {{"materials",
                                     {{{"text", "lambert:reflectance=0.2/0.4/0.8"}},
                                      {{"text", "ggx_conductor:metal=Au,alpha_x=0.5,alpha_y=0.5"}}}},
                                    {"kind", "albedo"},
                                    {"points", 91}});
  const auto& y = array_of(a, "y").data;
  const auto gold = parse_material("ggx_conductor:metal=Au,alpha_x=0.5,alpha_y=0.5");
  for (const std::size_t i : {0u, 20u, 45u, 70u, 85u}) {
    EXPECT_NEAR(y[3 * i + 2], 0.8, 1e-5);
    const auto albedo = sampled_albedo(gold, double(i) * radians, 16384);
    EXPECT_NEAR(y[3 * (91 + i)], albedo[0], 0.01) << i; // 256 points
  }
}

TEST(ExplorerCurves, ImpossibleRequestsAreErrors) {
  Workbench w;
  const json lambert = {{{"text", "lambert"}}};
  EXPECT_THAT(w.error("curves", {{"materials", lambert}, {"kind", "thetah"}}), HasSubstr("theta_h"));
  EXPECT_THAT(w.error("curves", {{"materials", lambert}, {"kind", "polar"}, {"points", 1e9}}),
              HasSubstr("points"));
  EXPECT_THAT(w.error("curves", {{"materials", lambert}, {"kind", "polar"}, {"theta_i", 91}}),
              HasSubstr("theta_i"));
  EXPECT_THAT(w.error("curves", {{"materials", lambert}, {"kind", "polar"}, {"theta_i", "x"}}),
              HasSubstr("number"));
  EXPECT_THAT(w.error("curves", {{"materials", 1}, {"kind", "polar"}}), HasSubstr("list"));
}

TEST(ExplorerLobe, IsEvaluatedOverTheHemisphere) {
  Workbench w;
  const std::string text = "ggx_conductor:alpha_x=0.4,alpha_y=0.4";
  const Answer a =
      w.ask("lobe3d",
            {{"material", {{"text", text}}}, {"theta_i", 30}, {"phi_i", 10}, {"n_theta", 10}, {"n_phi", 19}});
  const NamedArray& f = array_of(a, "f");
  ASSERT_EQ(f.shape, (std::vector<std::size_t>{10, 19, 3}));
  const auto expected = eval(text, spherical_direction(40 * radians, 180 * radians),
                             spherical_direction(30 * radians, 10 * radians));
  EXPECT_NEAR(f.data[(4 * 19 + 9) * 3], expected[0], 1e-4 * expected[0]);
}

TEST(ExplorerPictures, AreThoseOfTheReport) {
  Workbench w;
  const std::string text = "ggx_conductor:metal=Au";
  const Answer sphere =
      w.ask("sphere", {{"material", {{"text", text}}}, {"size", 37}, {"theta_i", 50}, {"phi_i", 70}});
  EXPECT_EQ(array_of(sphere, "image").data, lit_sphere(parse_material(text), 37, {50, 70}).data);
  const Answer slice =
      w.ask("slice", {{"material", {{"text", text}}}, {"size", 20}, {"sqrt_theta_h", false}});
  SliceAxes axes;
  axes.square_root = false;
  EXPECT_EQ(array_of(slice, "image").data, image_slice(parse_material(text), 20, axes).data);
}

TEST(ExplorerPictures, DoubledThetaShowsTheNormalsOfHalfTheSphere) {
  Workbench w;
  const auto image = w.ask("sphere", {{"material", {{"text", "lambert:reflectance=1"}}},
                                      {"size", 64},
                                      {"theta_i", 0},
                                      {"phi_i", 0},
                                      {"double_theta", true}});
  const auto& data = array_of(image, "image").data;
  // Seen and lit along the axis: the cosine of the normal that leans half as far. The sphere's radius is size
  // / 2.04.
  const double x = 30.5 * 2.04 / 64, y = 0.5 * 2.04 / 64;
  EXPECT_NEAR(data[(32 * 64 + 1) * 3], std::cos(std::asin(std::hypot(x, y)) / 2), 1e-5);
  EXPECT_NEAR(data[(32 * 64 + 32) * 3], 1, 1e-3);
}

TEST(ExplorerBrdf, FilesAreMaterialsWithSliders) {
  Workbench w;
  w.folder.write("mine.brdf", simple_brdf);
  const json brdf{{"name", "mine.brdf"}, {"source", simple_brdf}};
  const json compiled = w.ask("compile", {{"brdf", brdf}}).header;
  ASSERT_EQ(compiled["parameters"].size(), 3u) << compiled;
  EXPECT_EQ(compiled["parameters"][1]["initial"], json({1.0, 0.5, 0.25}));
  EXPECT_EQ(compiled["parameters"][2]["is_switch"], true);
  const auto value = [&](const json& material) {
    const Answer a = w.ask("curves", {{"materials", {material}}, {"kind", "theta_o"}, {"points", 3}});
    return array_of(a, "y").data[3 + 1];
  };
  EXPECT_NEAR(value({{"file", "mine.brdf"}}), 0.5 * 0.5 / pi, 1e-6);
  EXPECT_NEAR(value({{"brdf", brdf}, {"values", {{"gain", 2}, {"tint", {0, 1, 0}}}}}), 2 / pi, 1e-6);
  EXPECT_NEAR(value({{"brdf", brdf}, {"values", {{"on", false}}}}), 0, 0);
  EXPECT_THAT(w.error("material", {{"material", {{"brdf", brdf}, {"values", {{"gian", 2}}}}}}),
              HasSubstr("gain"));
  EXPECT_THAT(w.error("material", {{"material", {{"brdf", brdf}, {"values", {{"gain", 9}}}}}}),
              HasSubstr("domain"));
  const json material = w.ask("material", {{"material", {{"brdf", brdf}, {"values", {{"gain", 2}}}}}}).header;
  EXPECT_EQ(material["kind"], "user");
  EXPECT_EQ(material["lobes"][0]["parameters"][0]["value"], 2);
}

// Like a listed model: what is done with parameters is done with its own.
TEST(ExplorerBrdf, IsExportedVariedAndFittedLikeAModel) {
  Workbench w;
  std::filesystem::create_directory(w.folder / "sub");
  w.folder.write("sub/mine.brdf", simple_brdf);
  const json saved{{"brdf", {{"name", "sub/mine.brdf"}, {"source", simple_brdf}}},
                   {"values", {{"gain", 1.5}}}};
  json edited = saved, by_file{{"file", "sub/mine.brdf"}, {"values", {{"gain", 1.5}}}};
  edited["brdf"]["source"] = std::string(simple_brdf) + "\n";
  const auto exported = [&](const json& material, const char* format) {
    return w.ask("export", {{"material", material}, {"format", format}}).header;
  };
  for (const json& material : {saved, by_file}) {
    const json text = exported(material, "text");
    EXPECT_EQ(text["text"], "sub/mine.brdf:gain=1.5,tint=1/0.5/0.25,on=1\n");
    EXPECT_EQ(text["remark"], "exact");
    EXPECT_THAT(
        w.error("material", {{"material", {{"text", text["text"].get<std::string>().substr(0, 43)}}}}),
        testing::IsEmpty());
  }
  EXPECT_THAT(exported(edited, "text")["remark"].get<std::string>(), HasSubstr("not saved"));
  EXPECT_THAT(exported(saved, "json")["text"].get<std::string>(), HasSubstr("lobes"));
  EXPECT_THAT(exported(saved, "brdf")["text"].get<std::string>(), HasSubstr("::begin shader"));
  EXPECT_THAT(exported(saved, "xml")["text"].get<std::string>(), HasSubstr("<bsdf"));

  const Answer furnace = w.ask("furnace", {{"material", saved}, {"parameter", "gain"}, {"size", 16}});
  EXPECT_EQ(array_of(furnace, "image").shape, (std::vector<std::size_t>{16, 6 * 16, 3}));
  // Albedo of the third sphere's middle: gain 0.4, tint's red 1.
  EXPECT_NEAR(array_of(furnace, "image").data[(8 * 6 * 16 + 2 * 16 + 8) * 3], 0.4, 2e-3);

  for (const json& measured : {saved, json("sub/mine.brdf")}) {
    const json fit =
        w.ask("fit", {{"measured", measured}, {"models", {"lambert"}}, {"starts", 1}}).header["results"][0];
    EXPECT_NEAR(fit["parameters"][1]["value"].get<double>(), measured.is_string() ? 0.25 : 0.75, 1e-3) << fit;
  }
  // And fitted itself, to another.
  const json fit = w.ask("fit", {{"measured", {{"text", "lambert:reflectance=0.6/0.3/0.15"}}},
                                 {"models", {"sub/mine.brdf"}},
                                 {"starts", 2}})
                       .header["results"][0];
  EXPECT_LT(fit["errors"]["log"].get<double>(), 1e-4) << fit;
  const json again = w.ask("material", {{"material", fit["material"]}}).header;
  EXPECT_EQ(again["kind"], "user");
  EXPECT_EQ(again["lobes"][0]["parameters"][0]["initial"], 0.5);
  EXPECT_EQ(again["lobes"][0]["parameters"][1]["initial"], json({1, 0.5, 0.25}));
}

TEST(ExplorerBrdf, PacksAndSingleDirectionsAgree) {
  Workbench w;
  const json material{{"brdf", {{"name", "a.brdf"}, {"source", R"(analytic
::begin parameters
::end parameters
::begin shader
vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) { vec3 H = normalize(L + V); return vec3(pow(dot(N, H), 20.0), L.x * L.x, V.y * V.y); }
::end shader
)"}}}};
  const auto spec = w.shop.materials.resolve(material, w.shop.folder);
  const auto bsdf = make_bsdf<double>(*spec);
  Directions d;
  for (int i = 0; i < 37; ++i)
    d.add(spherical_direction(0.04 * i, 1.0 * i), spherical_direction(1.5 - 0.04 * i, 2.0 * i));
  const auto f = evaluate(*spec, d);
  for (std::size_t i = 0; i < f.size(); ++i) {
    const auto one = bsdf.eval({d.wo_x[i], d.wo_y[i], d.wo_z[i]}, {d.wi_x[i], d.wi_y[i], d.wi_z[i]});
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(f[i][std::size_t(c)], one[c], 1e-5);
  }
}

TEST(ExplorerBrdf, ErrorsHaveTheirLine) {
  Workbench w;
  std::string wrong = simple_brdf;
  wrong.replace(wrong.find("gain *"), 6, "gain_ *");
  const json h = w.ask("compile", {{"brdf", {{"name", "mine.brdf"}, {"source", wrong}}}}).header;
  ASSERT_TRUE(h.contains("errors")) << h;
  EXPECT_EQ(h["errors"][0]["line"], 9) << h;
  const std::string endless = R"(analytic
::begin shader
vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {
  float x = 0.0;
  while (x < 1.0) x = x * 0.5;
  return vec3(x);
}
::end shader
)";
  const json e = w.ask("compile", {{"brdf", {{"name", "e.brdf"}, {"source", endless}}}}).header;
  ASSERT_TRUE(e.contains("errors")) << e;
  EXPECT_EQ(e["errors"][0]["line"], 5) << e;
}

TEST(ExplorerExport, TextAndJsonAreReadBack) {
  Workbench w;
  const std::string text = "ggx_schlick:f0=0.9/0.6/0.3,alpha=0.2";
  const json material{{"text", text}};
  const std::string written = w.ask("export", {{"material", material}, {"format", "text"}}).header["text"];
  EXPECT_EQ(to_json(parse_material(written.substr(0, written.size() - 1)))["lobes"],
            to_json(parse_material(text))["lobes"]);
  EXPECT_THAT(w.error("export", {{"material", material}, {"format", "gtlf"}}), HasSubstr("gltf"));
}

TEST(ExplorerExport, EveryFormatThatHelloListsIsWritten) {
  Workbench w;
  const json material{{"text", "disney_2012:base_color=0.6/0.3/0.1,roughness=0.4"}};
  const json formats = w.ask("hello", {}).header["formats"];
  ASSERT_GE(formats.size(), 7u);
  for (const json& format : formats) {
    const json written = w.ask("export", {{"material", material}, {"format", format["name"]}}).header;
    EXPECT_GT(written["text"].get<std::string>().size(), 40u) << format;
    EXPECT_FALSE(written["remark"].get<std::string>().empty()) << format;
  }
}

TEST(ExplorerRequests, UnknownTypeNamesTheNearest) {
  EXPECT_THAT([] { find_handler("curvs"); }, testing::ThrowsMessage<Error>(HasSubstr("curves")));
}

} // namespace
} // namespace nacre
