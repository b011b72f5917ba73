// The rooms of the house, and who may include whom: downwards only. And who knows which library.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <regex>
#include <set>

namespace {

namespace fs = std::filesystem;

/// What each room may include besides itself.
const std::map<std::string, std::set<std::string>> allowed = {
    {"core", {}},
    {"spectra", {"core"}},
    {"optics", {"core"}},
    {"bsdf", {"optics", "core"}},
    {"measured", {"bsdf", "optics", "spectra", "core"}},
    {"fit", {"measured", "bsdf", "optics", "spectra", "core"}},
    {"validate", {"measured", "bsdf", "optics", "spectra", "core"}},
    {"display", {"spectra", "core"}},
    {"scene", {"measured", "bsdf", "optics", "spectra", "core"}},
    {"render", {"scene", "measured", "bsdf", "optics", "spectra", "core"}},
    {"report",
     {"render", "scene", "fit", "validate", "display", "measured", "bsdf", "optics", "spectra", "core"}},
    {"explorer",
     {"report", "render", "scene", "fit", "validate", "display", "measured", "bsdf", "optics", "spectra",
      "core"}},
    {"cli",
     {"explorer", "report", "render", "scene", "fit", "validate", "display", "measured", "bsdf", "optics",
      "spectra", "core"}},
};

/// Libraries and the only places that may name them.
const std::multimap<std::string, std::string> libraries = {
    {"xsimd/", "core/pack.h"},
    {"tbb/", "core/"},
    {"OpenEXR/", "core/"},
    {"Imf", "core/"},
    {"stb", "core/"},
    {"embree3/", "render/accel.cpp"},
    {"ceres/", "fit/"},
    {"pugixml", "scene/"},
    {"pugixml", "measured/formats/"},
    {"hdf5", "measured/formats/"},
    {"zlib", "scene/"},
    {"CLI/", "cli/"},
    {"sqlite3", "fit/fit_store.cpp"},
    {"boost/", "explorer/server.cpp"},
    {"glslang/", "bsdf/shader/"},
};

template <class F>
void for_each_include(F f) {
  const fs::path src = fs::path(NACRE_SOURCE_DIR) / "src";
  const std::regex include(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  for (const auto& entry : fs::recursive_directory_iterator(src)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path());
    const std::string name = fs::relative(entry.path(), src).generic_string();
    std::smatch match;
    for (std::string line; std::getline(file, line);)
      if (std::regex_search(line, match, include)) f(name, match[1].str());
  }
}

std::string room_of(const std::string& path) { return path.substr(0, path.find('/')); }

TEST(Architecture, RoomsIncludeDownwardsOnly) {
  int includes = 0;
  for_each_include([&](const std::string& file, const std::string& included) {
    const std::string from = room_of(file), to = room_of(included);
    if (included.find('/') == std::string::npos || !allowed.count(to)) return;
    ++includes;
    ASSERT_TRUE(allowed.count(from)) << file << " lies in no room";
    EXPECT_TRUE(from == to || allowed.at(from).count(to)) << file << " includes " << included;
  });
  EXPECT_GT(includes, 100);
}

TEST(Architecture, LibrariesAreKnownInOnePlace) {
  for_each_include([&](const std::string& file, const std::string& included) {
    for (auto it = libraries.begin(); it != libraries.end(); it = libraries.upper_bound(it->first)) {
      if (included.rfind(it->first, 0) != 0) continue;
      const auto [first, last] = libraries.equal_range(it->first);
      EXPECT_TRUE(std::any_of(first, last, [&](const auto& l) { return file.rfind(l.second, 0) == 0; }))
          << file << " includes " << included;
    }
  });
}

} // namespace
