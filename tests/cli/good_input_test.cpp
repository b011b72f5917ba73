// Every command on small good input: status 0, sane output, and one JSON object where --json asks for it.

#include "run_command.h"
#include "small_input.h"

#include <nlohmann/json.hpp>

namespace nacre {
namespace {

using Json = nlohmann::json;

/// Expects success and exactly one JSON object on standard output. (The parser refuses anything after it.)
Json json_of(std::vector<std::string> arguments, int status = 0) {
  arguments.push_back("--json");
  const Outcome o = nacre_command(arguments);
  EXPECT_EQ(o.status, status) << spelled(arguments) << "\n" << o.err;
  const Json json = Json::parse(o.out, nullptr, false);
  EXPECT_TRUE(json.is_object()) << spelled(arguments) << "\n" << o.out;
  return json.is_object() ? json : Json::object();
}

std::vector<std::uint8_t> first_bytes(const std::string& file, std::size_t n) {
  std::vector<std::uint8_t> bytes = read_file(file);
  bytes.resize(std::min(n, bytes.size()));
  return bytes;
}

TEST(GoodInput, MaterialsListsTheModels) {
  EXPECT_NE(expect_success({"materials"}).out.find("\noren_nayar: "), std::string::npos);
  const Json all = json_of({"materials"}), one = json_of({"materials", "lambert"});
  EXPECT_GE(all["models"].size(), 8u);
  EXPECT_EQ(one["models"].size(), 1u);
  EXPECT_EQ(one["models"][0]["parameters"][0]["name"], "reflectance");
}

TEST(GoodInput, EvalOfLambertIsReflectanceOverPi) {
  const Json json =
      json_of({"eval", "lambert:reflectance=0.3/0.6/0.9", "--theta-i", "30", "--theta-o", "45"});
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(json["f"][std::size_t(c)].get<double>(), 0.3 * (c + 1) / pi, 1e-7);
  EXPECT_NEAR(json["pdf"].get<double>(), std::cos(pi / 6) / pi, 1e-7);
  EXPECT_NE(expect_success({"eval", "lambert"}).out.find("1/sr"), std::string::npos);
}

TEST(GoodInput, ATableIsDescribedEvaluatedPlottedAndValidated) {
  const ScratchFolder folder;
  const std::string table = small_table(folder);
  EXPECT_EQ(json_of({"info", table})["file"], table);
  EXPECT_NE(expect_success({"info", table}).out.find("theta_h 8 "), std::string::npos);
  EXPECT_NEAR(json_of({"eval", table})["f"][0].get<double>(), 0.4, 1e-6);
  expect_success({"plot", table, "lambert", "-o", folder / "a.svg"});
  EXPECT_TRUE(read_text_file(folder / "a.svg").find("<svg") != std::string::npos);
  EXPECT_TRUE(json_of({"validate", table, "--samples", "20000"}).contains("holds"));
}

TEST(GoodInput, ValidateSaysByItsStatusWhetherTheLawsHold) {
  EXPECT_EQ(nacre_command({"validate", "lambert"}).status, 0);
  EXPECT_EQ(nacre_command({"validate", "oren_nayar:reflectance=1,sigma=0.2"}).status, 3);
  EXPECT_EQ(json_of({"validate", "lambert"})["holds"], true);
  EXPECT_EQ(json_of({"validate", "oren_nayar:reflectance=1,sigma=0.2"}, 3)["holds"], false);
}

TEST(GoodInput, ValidateWritesAPageBesidesWhatItPrints) {
  const ScratchFolder folder;
  const Outcome run =
      nacre_command({"validate", "oren_nayar:reflectance=1,sigma=0.2", "--report", folder / "page.html"});
  EXPECT_EQ(run.status, 3);
  EXPECT_NE(run.out.find("Some laws are violated."), std::string::npos);
  EXPECT_EQ(read_text_file(folder / "page.html").find("<!DOCTYPE html>"), 0u);
}

TEST(GoodInput, AFitIsAMaterialAgain) {
  const ScratchFolder folder;
  const std::string table = small_table(folder), fit = folder / "fit.json";
  expect_success({"fit", table, "--model", "lambert", "--starts", "2", "-o", fit});
  EXPECT_GT(json_of({"eval", fit})["f"][0].get<double>(), 0.05);
  EXPECT_TRUE(json_of({"fit", table, "--model", "lambert", "--starts", "2"}).contains("fit"));
}

TEST(GoodInput, ARenderedPictureIsDescribedComparedAndToneMapped) {
  const ScratchFolder folder;
  const std::string scene = small_scene(folder), exr = folder / "a.exr";
  const Json rendered = json_of({"render", scene, "-o", exr, "--spp", "2", "--variance"});
  EXPECT_EQ(rendered["complete"], true);
  EXPECT_EQ(rendered["samples"], 32 * 24 * 2);
  EXPECT_EQ(json_of({"info", exr})["channels"].size(), 6u);
  EXPECT_EQ(json_of({"compare", exr, exr})["metrics"]["rmse"], 0.0);
  EXPECT_NE(expect_success({"compare", exr, exr}).out.find("rmse"), std::string::npos);
  EXPECT_EQ(json_of({"tonemap", exr, folder / "a.png"})["operator"], "reinhard");
  EXPECT_EQ(first_bytes(folder / "a.png", 4), (std::vector<std::uint8_t>{0x89, 'P', 'N', 'G'}));
}

TEST(GoodInput, ATableIsRenderedInAScene) {
  const ScratchFolder folder;
  small_table(folder);
  expect_success({"render",
                  scene_of(folder, "<shape type='sphere'><bsdf type='merl'><string name='filename' "
                                   "value='small.binary'/></bsdf></shape>"),
                  "-o", folder / "a.exr", "--quiet"});
  const Image image = read_exr(folder / "a.exr");
  const float* middle = image.at(16, 12);
  EXPECT_GT(middle[0], middle[2]); // it is red
  EXPECT_LT(middle[0], 1);
}

TEST(GoodInput, QuietSaysNothing) {
  const ScratchFolder folder;
  const Outcome o = expect_success({"render", small_scene(folder), "-o", folder / "a.exr", "--quiet"});
  EXPECT_EQ(o.out + o.err, "");
}

TEST(GoodInput, ThePictureDoesNotDependOnTheNumberOfThreads) {
  const ScratchFolder folder;
  SceneParts parts;
  parts.shapes = "<shape type='sphere'><bsdf type='roughconductor'/></shape>";
  const std::string scene = small_scene(folder, parts);
  std::vector<Image> images;
  for (const char* threads : {"1", "2"}) {
    const std::string out = folder / (std::string(threads) + ".exr");
    expect_success({"--threads", threads, "render", scene, "-o", out, "--spp", "8", "--variance"});
    images.push_back(read_exr(out));
  }
  ASSERT_EQ(images[0].data.size(), images[1].data.size());
  EXPECT_EQ(std::memcmp(images[0].data.data(), images[1].data.data(), images[0].data.size() * sizeof(float)),
            0);
  expect_success({"render", scene, "-o", folder / "other.exr", "--spp", "8", "--variance", "--seed", "1"});
  EXPECT_NE(read_exr(folder / "other.exr").data, images[0].data);
}

TEST(GoodInput, ASceneThatStaysDarkIsSaidToBe) {
  const ScratchFolder folder;
  SceneParts parts;
  parts.light = "";
  const std::string scene = small_scene(folder, parts);
  const Outcome o = expect_success({"render", scene, "-o", folder / "a.exr", "--quiet"});
  EXPECT_NE(o.err.find("scene.xml: the scene has no light"), std::string::npos) << o.err;
  EXPECT_EQ(json_of({"render", scene, "-o", folder / "a.exr"})["warnings"].size(), 1u);
  expect_failure(1, {"render", scene, "-o", folder / "b.exr", "--strict"}, {"scene.xml", "no light"});
}

TEST(GoodInput, TheDemoWritesItsReport) {
  const ScratchFolder folder;
  const std::string table = small_table(folder);
  const Json json = json_of({"demo", table, "-o", folder / "out", "--spp", "1", "--model", "lambert"});
  const std::string report = read_text_file(json.value("report", ""));
  EXPECT_NE(report.find("</html>"), std::string::npos);
  EXPECT_EQ(report.find("src=\"http"), std::string::npos);
  EXPECT_NE(expect_success({"demo", "--material", "help"}).out.find("gold-paint\n"), std::string::npos);
}

} // namespace
} // namespace nacre
