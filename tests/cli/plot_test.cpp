// Every kind of plot writes its file; mistakes are named before anything is written.

#include "core/file.h"
#include "run_command.h"

#include <filesystem>

namespace nacre {
namespace {

TEST(PlotCommand, EveryKindWritesItsFile) {
  const ScratchFolder folder;
  for (const std::string kind :
       {"lobe", "theta_i", "polar", "theta_h", "theta_d", "phi", "albedo", "albedo-roughness", "D", "G1"}) {
    const std::string file = folder / (kind + ".svg");
    expect_success({"plot", "ggx_schlick:alpha=0.3", "--kind", kind, "-o", file});
    EXPECT_NE(read_text_file(file).find("</svg>"), std::string::npos) << kind;
  }
  for (const std::string kind : {"fresnel", "fresnel-wavelength"}) {
    const std::string file = folder / (kind + ".svg");
    expect_success({"plot", "Au", "BK7", "--kind", kind, "-o", file});
    EXPECT_NE(read_text_file(file).find("BK7"), std::string::npos) << kind;
  }
  for (const std::string kind : {"sphere", "furnace", "slice"})
    for (const std::string end : {".png", ".exr"}) {
      const std::string file = folder / (kind + end);
      expect_success({"plot", "ggx_schlick:alpha=0.3", "lambert+ggx_schlick", "--kind", kind, "-o", file,
                      "--size", "16"});
      EXPECT_GT(std::filesystem::file_size(file), 100u) << kind;
    }
}

TEST(PlotCommand, MistakesAreNamedWithTheirRemedy) {
  const ScratchFolder folder;
  const std::string png = folder / "a.png", svg = folder / "a.svg";
  expect_failure(2, {"plot", "lambert", "--kind", "sphere", "-o", svg}, {".png or .exr"});
  expect_failure(2, {"plot", "lambert", "-o", png}, {".svg"});
  expect_failure(1, {"plot", "Aux", "--kind", "fresnel", "-o", svg}, {"'Aux'", "'Au'"});
  expect_failure(1, {"plot", "lambert", "--kind", "D", "-o", svg}, {"lambert", "facets"});
  expect_failure(1, {"plot", "lambert", "--kind", "furnace", "-o", png},
                 {"lambert", "roughness", "--parameter"});
  expect_failure(1, {"plot", "ggx_conductor", "--kind", "furnace", "--parameter", "alpha_z", "-o", png},
                 {"alpha_z", "alpha_x"});
  expect_failure(1, {"plot", "ggx_conductor", "--kind", "furnace", "--range", "0.1,2", "-o", png},
                 {"[0.001, 1]"});
  expect_failure(2, {"plot", "ggx_conductor", "--kind", "furnace", "--range", "1,0", "-o", png},
                 {"from < to"});
  EXPECT_FALSE(std::filesystem::exists(png));
  EXPECT_FALSE(std::filesystem::exists(svg));
}

} // namespace
} // namespace nacre
