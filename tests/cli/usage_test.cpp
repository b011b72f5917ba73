// A wrong command line ends with status 2 and one line that says what to mend; help says how.

#include "run_command.h"
#include "small_input.h"

namespace nacre {
namespace {

const std::vector<std::string> commands{"demo",     "materials", "info",    "eval",    "plot",
                                        "validate", "fit",       "tonemap", "compare", "render"};

TEST(Usage, EveryCommandHasHelpWithItsUsageAndAnExample) {
  const Outcome all = expect_success({"--help"});
  for (const std::string& command : commands) {
    EXPECT_NE(all.out.find("\n  " + command + " "), std::string::npos) << command << " in:\n" << all.out;
    const Outcome o = expect_success({command, "--help"});
    EXPECT_NE(o.out.find("Usage: nacre " + command), std::string::npos) << o.out;
    EXPECT_NE(o.out.find("Example"), std::string::npos) << o.out;
    EXPECT_EQ(o.err, "");
  }
}

TEST(Usage, VersionIsOneLine) {
  const Outcome o = expect_success({"--version"});
  EXPECT_EQ(std::count(o.out.begin(), o.out.end(), '\n'), 1) << o.out;
}

TEST(Usage, AnUnknownCommandIsNamedWithTheNearest) {
  expect_failure(2, {}, {"expected a command", "render", "see nacre --help"});
  expect_failure(2, {"materals"}, {"unknown command 'materals'", "did you mean 'materials'?"});
  expect_failure(2, {"help"}, {"unknown command 'help'", "see nacre --help"});
  expect_failure(2, {"rendr", "scene.xml", "-o", "out.exr"},
                 {"unknown command 'rendr'", "did you mean 'render'?"});
}

TEST(Usage, AnUnknownOptionIsNamedWithTheNearest) {
  for (const std::string& command : commands)
    expect_failure(2, {command, "--nonsense"},
                   {"nacre: " + command, "'--nonsense'", "see nacre " + command + " --help"});
  expect_failure(2, {"--thread", "2", "materials"}, {"'--thread'", "did you mean '--threads'?"});
  expect_failure(2, {"render", "s.xml", "--ouput", "x.exr"}, {"'--ouput'", "did you mean '--output'?"});
  expect_failure(2, {"eval", "lambert", "--thetai=3"}, {"'--thetai'", "did you mean '--theta-i'?"});
}

TEST(Usage, AMissingArgumentIsNamed) {
  expect_failure(2, {"eval"}, {"eval: MATERIAL"});
  expect_failure(2, {"validate"}, {"validate: MATERIAL"});
  expect_failure(2, {"plot"}, {"plot: MATERIAL"});
  expect_failure(2, {"info"}, {"info: expected a FILE"});
  expect_failure(2, {"fit"}, {"fit: MEASURED"});
  expect_failure(2, {"render"}, {"render: SCENE"});
  expect_failure(2, {"render", "scene.xml"}, {"render: --output"});
  expect_failure(2, {"tonemap", "a.exr"}, {"tonemap: OUT"});
  expect_failure(2, {"compare", "a.exr"}, {"compare: REFERENCE"});
  expect_failure(2, {"eval", "lambert", "--theta-i"}, {"--theta-i"});
}

TEST(Usage, AnArgumentTooManyIsNamed) {
  expect_failure(2, {"eval", "lambert", "extra"}, {"unexpected argument 'extra'"});
  expect_failure(2, {"render", "a.xml", "b.xml", "-o", "c.exr"}, {"unexpected argument 'b.xml'"});
  expect_failure(2, {"demo", "a.binary", "--material", "gold-paint"}, {"excludes"});
}

TEST(Usage, ANumberMustBeOneAndLieInItsRange) {
  struct Case {
    std::vector<std::string> command;
    std::string option;
    std::vector<std::string> wrong;
  };
  const std::vector<std::string> reals{"abc", "nan", "inf", "1e400", "1,5", "", "3deg"};
  const std::vector<std::string> wholes{"abc", "nan", "-1", "1.5", "1e3", "", "99999999999999999999999",
                                        "010", "0x10"};
  const std::vector<Case> cases{
      {{"eval", "lambert"}, "--theta-i", reals},
      {{"eval", "lambert"}, "--theta-o", {"-1", "181"}},
      {{"eval", "lambert"}, "--phi", reals},
      {{"materials"}, "--threads", wholes},
      {{"materials"}, "--threads", {"1000000"}},
      {{"plot", "lambert"}, "--theta", {"30,abc", "30,nan", "95"}},
      {{"plot", "lambert"}, "--theta-d", reals},
      {{"plot", "lambert"}, "--kind", {"lobes"}},
      {{"validate", "lambert"}, "--samples", wholes},
      {{"validate", "lambert"}, "--seed", wholes},
      {{"fit", "a.binary"}, "--starts", wholes},
      {{"fit", "a.binary"}, "--starts", {"0"}},
      {{"fit", "a.binary"}, "--max-theta", reals},
      {{"fit", "a.binary"}, "--metric", {"logg"}},
      {{"render", "s.xml", "-o", "a.exr"}, "--spp", wholes},
      {{"render", "s.xml", "-o", "a.exr"}, "--spp", {"0"}},
      {{"render", "s.xml", "-o", "a.exr"}, "--time", reals},
      {{"render", "s.xml", "-o", "a.exr"}, "--time", {"0", "-1"}},
      {{"render", "s.xml", "-o", "a.exr"}, "--seed", wholes},
      {{"render", "s.xml", "-o", "a.exr"}, "--integrator", {"bdpt"}},
      {{"tonemap", "a.exr", "a.png"}, "--exposure", reals},
      {{"compare", "a.exr", "b.exr"}, "--start-exposure", reals},
      {{"compare", "a.exr", "b.exr"}, "--pixels-per-degree", reals},
      {{"compare", "a.exr", "b.exr"}, "--exposures", wholes},
      {{"demo"}, "--spp", wholes},
      {{"demo"}, "--seed", wholes},
      {{"demo"}, "--metric", {"logg"}},
  };
  for (const Case& c : cases)
    for (const std::string& wrong : c.wrong) {
      std::vector<std::string> arguments = c.command;
      arguments.push_back(c.option + "=" + wrong);
      expect_failure(2, arguments, {c.option});
    }
}

TEST(Usage, ANumberOutsideItsRangeIsShownBesideTheRange) {
  expect_failure(2, {"render", "s.xml", "-o", "a.exr", "--spp", "0"},
                 {"--spp", "from 1 to 1048576", "found '0'"});
  expect_failure(2, {"eval", "lambert", "--theta-i", "nan"}, {"--theta-i", "from 0 to 180", "found 'nan'"});
}

TEST(Usage, OutputsOfTheWrongKindAreRefusedBeforeAnyWork) {
  expect_failure(2, {"render", "s.xml", "-o", "a.png"}, {"a.png", ".exr", "nacre tonemap"});
  expect_failure(2, {"tonemap", "a.exr", "a.tif"}, {"a.tif", ".png", ".jpg"});
  expect_failure(2, {"plot", "lambert", "-o", "a.pdf"}, {"a.pdf", ".svg"});
  expect_failure(2, {"fit", "a.binary", "-o", "a.txt"}, {"a.txt", ".json"});
  expect_failure(2, {"compare", "a.exr", "b.exr", "--flip-map", "a.svg"}, {"a.svg", ".png"});
  expect_failure(2, {"compare", "a.exr", "b.exr", "--variance", "v.exr"}, {"--variance", "--spp"});
  expect_failure(2, {"compare", "a.exr", "b.exr", "--metric", "rmsee"}, {"'rmsee'", "did you mean 'rmse'?"});
  expect_failure(2, {"tonemap", "a.exr", "a.png", "--operator", "reinhardt"}, {"did you mean 'reinhard'?"});
  expect_failure(2, {"tonemap", "a.exr", "a.png", "-p", "key=abc"}, {"key=", "found 'abc'"});
}

TEST(Usage, ADefinitionTakesOneArgumentAlone) {
  const ScratchFolder folder;
  SceneParts parts;
  parts.samples = "$spp";
  const std::string scene = small_scene(folder, parts);
  expect_success({"render", "-D", "spp=2", "-I", folder.path(), scene, "-o", folder / "a.exr"});
  expect_failure(2, {"render", "-D", "spp", scene, "-o", folder / "b.exr"}, {"NAME=VALUE", "'spp'"});
  expect_failure(1, {"render", scene, "-o", folder / "b.exr"}, {"scene.xml:2:", "'$spp' has no value"});
  expect_failure(1, {"render", "-D", "ssp=2", "-D", "spp=2", scene, "-o", folder / "b.exr"}, {"'ssp'"});
  expect_failure(1, {"render", "-I", folder / "nowhere", scene, "-o", folder / "b.exr"}, {"-I", "nowhere"});
  EXPECT_EQ(folder.contents(), (std::vector<std::string>{"a.exr", "scene.xml"}));
}

} // namespace
} // namespace nacre
