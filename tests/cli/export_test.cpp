// The commands that hand a fit on: nacre export, and the page of nacre fit --report.

#include "measured/material_spec.h"
#include "run_command.h"
#include "small_input.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

using testing::HasSubstr;

TEST(ExportCommand, WritesEveryFormatAndSaysTheError) {
  const ScratchFolder folder;
  for (const char* ending : {".json", ".brdf", ".xml", ".pbrt", ".gltf", ".mtlx"}) {
    const std::string file = folder / (std::string("a") + ending);
    const Outcome o = expect_success({"export", "lambert:reflectance=0.3", "-o", file});
    EXPECT_THAT(o.out, HasSubstr("mapping error: none"));
    EXPECT_FALSE(read_text_file(file).empty());
  }
  EXPECT_NO_THROW(parse_material(folder / "a.json"));
}

TEST(ExportCommand, TakesTheJsonOfAFit) {
  const ScratchFolder folder;
  const std::string fit = folder / "fit.json";
  expect_success({"fit", small_table(folder), "--model", "ggx_schlick+lambert", "--starts", "2", "-o", fit});
  const Outcome o = expect_success({"export", fit, "-o", folder / "a.gltf", "--json"});
  const auto json = nlohmann::json::parse(o.out);
  EXPECT_EQ(json["fitted"], true);
  EXPECT_GT(json["error"]["log"].get<double>(), 0);
  EXPECT_THAT(read_text_file(folder / "a.gltf"), HasSubstr("Mapping error"));
}

TEST(ExportCommand, WrongNamesAreSaidWithTheNearest) {
  const ScratchFolder folder;
  expect_failure(2, {"export", "lambert", "-o", folder / "a.mtl"}, {"'.mtl'", "'.mtlx'"});
  expect_failure(2, {"export", "lambert"}, {"--output"});
  expect_failure(1, {"export", "lambert", "-o", folder / "a.mtlx", "--as", "openpr"}, {"'openpbr'"});
  expect_failure(1, {"export", "ggx_dielectric", "-o", folder / "a.brdf"}, {"transmits"});
  EXPECT_FALSE(std::filesystem::exists(folder / "a.brdf"));
}

TEST(FitReportOption, WritesThePageAndSaysNothingElse) {
  const ScratchFolder folder;
  const std::string table = small_table(folder);
  expect_success({"fit", table, "--model", "lambert", "--starts", "2", "--report", folder / "a.html"});
  EXPECT_THAT(read_text_file(folder / "a.html"), HasSubstr("nacre fit "));
  expect_success({"fit", table, "--model", "lambert", "--starts", "2", "--report", folder / "out"});
  EXPECT_THAT(read_text_file(folder / "out/report.html"), HasSubstr("</html>"));
  EXPECT_NO_THROW(parse_material(folder / "out/fit.json"));
}

} // namespace
} // namespace nacre
