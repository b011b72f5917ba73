// nacre info and nacre convert, of measurements: what they say when all is well, and when it is not.

#include "run_command.h"
#include "small_input.h"

#include "measured/formats.h"

#include <nlohmann/json.hpp>

namespace nacre {
namespace {

nlohmann::json json_of(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  return nlohmann::json::parse(expect_success(arguments).out);
}

TEST(Info, OfATableSaysWhatItHolds) {
  const ScratchFolder folder;
  const nlohmann::json info = json_of({"info", small_table(folder)});
  EXPECT_EQ(info["kind"], "isotropic reflectance table (MERL)");
  EXPECT_EQ(info["channels"], (std::vector<std::string>{"red", "green", "blue"}));
  EXPECT_EQ(info["isotropic"], true);
  EXPECT_EQ(info["entries"], 8 * 8 * 16);
  EXPECT_EQ(info["holes"], 0);
  EXPECT_EQ(info["filled"], 0);
  EXPECT_NEAR(info["range"]["red"]["max"].get<double>(), 0.4, 1e-6);
  ASSERT_EQ(info["coverage"].size(), 1u);
  EXPECT_EQ(info["coverage"][0]["share"], 1.0);
  EXPECT_EQ(info["coverage"][0]["share_by_theta_o_theta_i"].size(), 18u);
  EXPECT_EQ(info["albedo"].size(), 5u);
  EXPECT_LT(info["reciprocity_error"]["worst"].get<double>(), 1e-5);
}

TEST(Info, FitsATerminal) {
  const ScratchFolder folder;
  std::istringstream text(expect_success({"info", small_table(folder)}).out);
  int lines = 0;
  for (std::string line; std::getline(text, line); ++lines)
    if (!line.starts_with("/") && !line.starts_with("  reciprocity")) {
      EXPECT_LE(line.size(), 100u) << line;
    }
  EXPECT_LT(lines, 50);
}

TEST(Info, ListsTheFormatsThatThereAre) {
  const nlohmann::json list = json_of({"info", "--formats"})["formats"];
  ASSERT_EQ(list.size(), measured_formats().size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    EXPECT_EQ(list[i]["name"], measured_formats()[i].name);
    EXPECT_EQ(list[i]["writes"], measured_formats()[i].encode != nullptr);
  }
  EXPECT_NE(expect_success({"info", "--formats"}).out.find("merl"), std::string::npos);
}

TEST(Info, AWrongCommandOrEndingIsExplained) {
  const ScratchFolder folder;
  expect_failure(2, {"info"}, {"expected a FILE or --formats"});
  expect_failure(2, {"info", "a.binary", "--formats"}, {"--formats"});
  expect_failure(1, {"info", write(folder, "a.binray", "x")},
                 {"a.binray", "'.binray'", "did you mean '.binary'?", "nacre info --formats"});
}

TEST(Convert, OfATableToItsOwnFormatLosesNothing) {
  const ScratchFolder folder;
  const std::string in = small_table(folder), out = folder / "out.binary";
  const nlohmann::json json = json_of({"convert", in, out});
  EXPECT_EQ(json["format"], "merl");
  EXPECT_EQ(json["difference"]["pairs"], 10000);
  EXPECT_EQ(json["difference"]["worst"], 0.0);
  EXPECT_EQ(json["lost"].size(), 0u);
  EXPECT_EQ(read_file(in), read_file(out));
  EXPECT_NE(expect_success({"convert", in, out}).out.find("difference  none at 10000 random pairs"),
            std::string::npos);
}

TEST(Convert, OfAMaterialSaysHowFarTheTableIs) {
  const ScratchFolder folder;
  const nlohmann::json json =
      json_of({"convert", "ggx_conductor:alpha_x=0.4,alpha_y=0.4", folder / "out.binary"});
  EXPECT_GT(json["difference"]["mean"].get<double>(), 0);
  EXPECT_LT(json["difference"]["mean"].get<double>(), 0.02); // a table of 90 x 90 x 180 of a smooth lobe
  EXPECT_NE(expect_success({"convert", "ggx_conductor:alpha_x=0.1,alpha_y=0.4", folder / "a.binary"})
                .out.find("lost        anisotropy"),
            std::string::npos);
}

TEST(Convert, WritesASliceAsAnImage) {
  const ScratchFolder folder;
  const std::string table = small_table(folder);
  expect_success({"convert", table, folder / "a.exr", "--size", "16"});
  const Image image = read_exr(folder / "a.exr");
  EXPECT_EQ(image.width, 16);
  EXPECT_NEAR(image.at(0, 15)[0], 0.4, 0.01); // theta_h = 0
  EXPECT_TRUE(image.metadata.contains("nacre.slice"));
  expect_success({"convert", table, folder / "a.png"});
  EXPECT_EQ(read_ldr(folder / "a.png").width, 256);
}

TEST(Convert, FillsHolesWhenAsked) {
  const ScratchFolder folder;
  write_merl(MerlTable::tabulate(8, 8, 16,
                                 [](double h, double d, double) -> std::array<double, 3> {
                                   if (h < 0.3 && d > 0.5 && d < 0.8) return {-1, -1, -1};
                                   return {0.5, 0.4, 0.3};
                                 }),
             folder / "holes.binary");
  const nlohmann::json before = json_of({"info", folder / "holes.binary"});
  EXPECT_GT(before["holes_above_horizon"].get<int>(), 0);
  const nlohmann::json json = json_of({"convert", folder / "holes.binary", folder / "full.binary", "--fill"});
  EXPECT_EQ(json["filled"]["by_extrapolation"], before["holes_above_horizon"]);
  EXPECT_EQ(json["lost"][0], "marks of filled entries: the format has no place for them");
  const nlohmann::json after = json_of({"info", folder / "full.binary"});
  EXPECT_EQ(after["holes_above_horizon"], 0);
  EXPECT_NEAR(after["range"]["red"]["max"].get<double>(), 0.5, 1e-5);
  EXPECT_NEAR(after["range"]["red"]["min"].get<double>(), 0.5, 1e-5);
}

TEST(Convert, WhatItCannotWriteIsExplainedAndNoFileIsLeft) {
  const ScratchFolder folder;
  const std::string out = folder / "out.binary";
  expect_failure(2, {"convert", "lambert", folder / "out.binry"}, {"'.binry'", "did you mean '.binary'?"});
  expect_failure(2, {"convert", "lambert", out, "--to", "mrel"},
                 {"no format 'mrel'", "did you mean 'merl'?"});
  expect_failure(2, {"convert", "lambert", out, "--to", "slice"}, {"a slice is an image", ".exr or .png"});
  expect_failure(2, {"convert", "lambert"}, {"OUT"});
  expect_failure(1, {"convert", "lamber", out}, {"unknown model 'lamber'", "did you mean 'lambert'?"});
  expect_failure(1, {"convert", folder / "missing.binary", out}, {"missing.binary", "no such file"});
  expect_failure(1, {"convert", "smooth_conductor", out}, {"smooth_conductor", "no table holds"});
  expect_failure(1, {"convert", "ggx_dielectric:alpha_x=0.2,alpha_y=0.2", out, "--fill"},
                 {"--fill", "isotropic reflection from the front"});
  expect_failure(1, {"convert", "lambert", folder / "nowhere/out.binary"}, {"nowhere/out.binary"});
  EXPECT_EQ(folder.contents(), std::vector<std::string>{});
}

} // namespace
} // namespace nacre
