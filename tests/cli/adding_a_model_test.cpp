// The guide to a new model, followed word by word in a copy of the sources: its header and its line of the
// list are taken from docs/adding-a-model.md, the copy is built, and the commands that the guide promises are
// run. For the sake of time the copy is built without optimisation, and with two other models alone in its
// list.

#include "core/scratch_folder.h"
#include "core/vec.h"

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <sys/wait.h>

#include <gmock/gmock.h>

namespace nacre {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string content(const fs::path& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}
void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

/// What lies between `begin` and the next `end`, in the part of the text from `after` on.
std::string between(const std::string& text, const std::string& after, const std::string& begin,
                    const std::string& end) {
  const std::size_t part = text.find(after), first = text.find(begin, part),
                    last = text.find(end, first + begin.size());
  if (part == text.npos || first == text.npos || last == text.npos) {
    ADD_FAILURE() << "the guide has no " << begin << " after " << after;
    return {};
  }
  return text.substr(first + begin.size(), last - first - begin.size());
}

/// The copy of the sources, and how to build and run it.
struct Copy {
  ScratchFolder folder;
  fs::path root = folder / "nacre copy", build = root / "build";

  Copy() {
    const fs::path source = NACRE_SOURCE_DIR;
    fs::create_directories(root / "tests");
    for (const char* part : {"src", "cmake", "fuzz", "tests/models"})
      fs::copy(source / part, root / part, fs::copy_options::recursive);
    fs::copy_file(source / "CMakeLists.txt", root / "CMakeLists.txt");
  }
  /// Exit status; what was printed goes to `out`.
  int run(const std::string& command, std::string& out) const {
    const std::string log = folder / "log";
    const int status =
        std::system(("( cd '" + root.string() + "' && " + command + " ) >'" + log + "' 2>&1").c_str());
    out = content(log);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
};

/// The list without the lines of its models, but for Lambert's and one with facets.
void shorten_list(const fs::path& list) {
  std::istringstream lines(content(list));
  std::string shortened;
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with("  X(") || line.starts_with("  X(Lambert, ") ||
        line.starts_with("  X(GgxConductor, "))
      shortened += line + "\n";
  write(list, shortened);
}

TEST(LongAddingAModel, TheGuideIsTrueToTheLetter) {
  const std::string guide = content(NACRE_SOURCE_DIR "/docs/adding-a-model.md");
  const Copy copy;
  const fs::path list = copy.root / between(guide, "## 2.", "`", "`");
  shorten_list(list);

  // Step 1 and step 2 of the guide.
  write(copy.root / between(guide, "## 1.", "`", "`"), between(guide, "## 1.", "```cpp\n", "```"));
  std::string text = content(list);
  const std::string neighbour = between(guide, "say after", "`", "`");
  const std::size_t place = text.find('\n', text.find("  " + neighbour)) + 1;
  ASSERT_GT(place, 1u) << neighbour;
  write(list, text.insert(place, between(guide, "## 2.", "```cpp\n", "```")));

  std::string out;
  // With these a second run of this test, in another folder, finds in ccache what did not change.
  const std::string cache = "CCACHE_BASEDIR='" + copy.root.string() + "' CCACHE_NOHASHDIR=1 ";
  ASSERT_EQ(
      copy.run("cmake -S . -B build -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0", out), 0)
      << out;
  ASSERT_EQ(copy.run(cache + "cmake --build build -j 2 --target nacre test_models", out), 0) << out;

  // Step 3: the commands, as they stand there.
  std::istringstream commands(between(guide, "## 3.", "\n\n    ", "\n\n"));
  std::map<std::string, std::string> printed;
  for (std::string line; std::getline(commands, line);) {
    const std::string words = line.substr(line.find("nacre ") + 6);
    EXPECT_EQ(copy.run("build/nacre " + words, out), 0) << words << "\n" << out;
    printed[words.substr(0, words.find(' '))] = out;
  }
  ASSERT_EQ(printed.size(), 4u);
  EXPECT_THAT(printed["materials"],
              testing::AllOf(HasSubstr("limb_darkened: diffuse reflection"), HasSubstr("reflectance"),
                             HasSubstr("darkening of the limb")));
  EXPECT_THAT(printed["eval"], HasSubstr(between(guide, "The second prints", "= ", ". For")));
  EXPECT_THAT(printed["validate"], HasSubstr("All laws hold"));
  EXPECT_THAT(content(copy.root / "limb_darkened.svg"), HasSubstr("</svg>"));

  // The formula, by more digits.
  ASSERT_EQ(
      copy.run("build/nacre eval limb_darkened:reflectance=0.8,u=0.5 --theta-i 30 --theta-o 60 --json", out),
      0);
  const double expected = 0.8 / pi * (1 - 0.5 * (1 - 0.5)) * (1 - 0.5 * (1 - std::sqrt(0.75)));
  EXPECT_NEAR(nlohmann::json::parse(out).at("f").at(0).get<double>(), expected, 1e-6 * expected);

  // Step 4: the tests that the line alone made.
  EXPECT_EQ(
      copy.run("build/test_models --gtest_filter='" + between(guide, "## 4.", "--gtest_filter='", "'") + "'",
               out),
      0)
      << out;
  for (const char* suite : {"ModelNumbers", "ModelLaws", "LongModelLaws"})
    EXPECT_THAT(out, HasSubstr("LimbDarkened/" + std::string(suite) + "/0."));
}

} // namespace
} // namespace nacre
