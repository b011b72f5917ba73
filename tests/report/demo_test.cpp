#include "report/demo.h"

#include "core/error.h"
#include "core/file.h"
#include "core/scratch_folder.h"
#include "measured/merl_table.h"
#include "report/output_folder.h"
#include "report/pictures.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <optional>

namespace nacre {
namespace {
namespace fs = std::filesystem;

class DemoTest : public testing::Test {
protected:
  ScratchFolder scratch;
  fs::path home = scratch.path();

  /// A rough gold, as a small table.
  static std::string write_table(const fs::path& home) {
    const std::string path = (home / "little <gold>.binary").string();
    write_merl(MerlTable::tabulate(20, 12, 12,
                                   [](double theta_h, double, double) -> std::array<double, 3> {
                                     const double lobe = std::exp(-sqr(theta_h / 0.3));
                                     return {0.05 + 0.9 * lobe, 0.04 + 0.6 * lobe, 0.02 + 0.2 * lobe};
                                   }),
               path);
    return path;
  }
  DemoOptions small() const { return small(home); }
  static DemoOptions small(const fs::path& home) {
    DemoOptions o;
    o.folder = (home / "out").string();
    o.width = 32, o.height = 24, o.samples_per_pixel = 2;
    o.fit.starts = 2, o.fit.refined = 1;
    o.validate.directions = 500;
    o.command = "nacre demo 'little <gold>.binary' --spp 2";
    return o;
  }
  std::vector<std::string> files(const std::string& folder) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }
};
using DemoFailure = DemoTest;
using OutputFolders = DemoTest;

/// One run that several tests look at.
class Demo : public DemoTest {
protected:
  static inline std::optional<ScratchFolder> shared;
  static inline DemoOptions options;
  static inline DemoResult result;
  static void SetUpTestSuite() {
    shared.emplace();
    options = small(shared->path());
    options.file = write_table(shared->path());
    result = run_demo(options);
  }
  static void TearDownTestSuite() { shared.reset(); }
};

TEST_F(Demo, GoesTheWholeWayAndReportsIt) {
  EXPECT_EQ(files(options.folder),
            (std::vector<std::string>{"fit.exr", "fit.json", "measured.exr", "picture.png", "report.html"}));
  EXPECT_EQ(read_exr(options.folder + "/fit.exr").width, 32);
  EXPECT_EQ(read_ldr(result.picture).width, 3 * 32 + 2 * 6);
  EXPECT_NO_THROW(parse_material(options.folder + "/fit.json"));

  const std::string report = read_text_file(result.report);
  for (const char* section : {"id=pictures", "id=plots", "id=fit", "id=validation", "id=time", "id=origin"})
    EXPECT_NE(report.find(section), std::string::npos) << section;
  for (const FittedParameter& p : result.fit.parameters)
    EXPECT_NE(report.find(p.label), std::string::npos) << p.label;
  for (const LawResult& law : result.fit_validation.laws)
    EXPECT_NE(report.find(law.law), std::string::npos) << law.law;
  for (const DemoStep& step : result.steps)
    EXPECT_NE(report.find(step.name), std::string::npos) << step.name;
  EXPECT_NE(report.find("little &lt;gold&gt;"), std::string::npos);
  EXPECT_EQ(report.find("<gold>"), std::string::npos);
}

TEST_F(Demo, ReportNeedsNothingOutsideIt) {
  const std::string report = read_text_file(result.report);
  for (const char* outside : {"http", "url(", "@import", "<link", "<script", "src='/", "src=\""})
    EXPECT_EQ(report.find(outside), std::string::npos) << outside;
}

TEST_F(Demo, SameSeedGivesTheSamePictures) {
  DemoOptions again = small();
  again.file = options.file;
  run_demo(again);
  for (const char* name : {"measured.exr", "fit.exr"}) // but for the time it took, which the file records
    EXPECT_EQ(read_exr((fs::path(again.folder) / name).string()).data,
              read_exr((fs::path(options.folder) / name).string()).data)
        << name;
  EXPECT_EQ(read_file((fs::path(again.folder) / "picture.png").string()), read_file(result.picture));
}

TEST_F(DemoFailure, WrongInputLeavesNoFolder) {
  const std::string truncated = (home / "truncated.binary").string();
  std::ofstream(truncated) << "too short to be a table";
  for (const std::string& file : {home.string(), truncated, (home / "missing.binary").string()}) {
    DemoOptions options = small();
    options.file = file;
    try {
      run_demo(options);
      ADD_FAILURE() << file << " was taken for a measurement";
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(file), std::string::npos) << e.what();
    }
    EXPECT_FALSE(fs::exists(options.folder));
  }
}

TEST_F(DemoFailure, MisspeltNamesAreSaidBeforeAnyWork) {
  DemoOptions options = small();
  options.published = "gold-metalic-paint";
  EXPECT_THROW(run_demo(options), Error);
  options = small();
  options.fit.model = "ggx_shlick";
  EXPECT_THROW(run_demo(options), Error);
  options = small();
  options.environment = (home / "missing.exr").string();
  EXPECT_THROW(run_demo(options), Error);
  EXPECT_FALSE(fs::exists(options.folder));
}

TEST_F(DemoFailure, FailureLaterOnLeavesNoFile) {
  DemoOptions options = small();
  options.file = write_table(home);
  // The pictures are made and measured.exr, fit.exr, fit.json written when this stands in the way.
  fs::create_directories(fs::path(options.folder) / "picture.png");
  EXPECT_THROW(run_demo(options), Error);
  EXPECT_EQ(files(options.folder), std::vector<std::string>{"picture.png"});
}

TEST_F(DemoFailure, FileInPlaceOfTheFolderIsRefused) {
  DemoOptions options = small();
  options.file = write_table(home);
  std::ofstream(options.folder) << "mine";
  EXPECT_THROW(run_demo(options), Error);
  EXPECT_EQ(read_text_file(options.folder), "mine");
}

TEST_F(OutputFolders, AreRemovedUnlessKept) {
  const std::string deep = (home / "a" / "b" / "c").string();
  const auto write = [](const std::string& path) { write_file_atomically(path, std::string_view("x")); };
  { OutputFolder(deep).add("f", write); }
  EXPECT_FALSE(fs::exists(home / "a"));
  {
    OutputFolder folder(deep);
    folder.add("f", write);
    folder.keep();
  }
  EXPECT_TRUE(fs::exists(deep + "/f"));
}

TEST_F(OutputFolders, KeepFilesThatWereThereBefore) {
  std::ofstream(home / "old") << "old";
  const auto write = [](const std::string& path) { write_file_atomically(path, std::string_view("new")); };
  {
    OutputFolder folder(home.string());
    folder.add("old", write);
    folder.add("fresh", write);
  }
  EXPECT_EQ(files(home.string()), std::vector<std::string>{"old"});
}

Image constant_picture(float value) {
  Image image(24, 16, {"R", "G", "B"});
  std::fill(image.data.begin(), image.data.end(), value);
  return image;
}

TEST(ReportPictures, EqualRendersDifferNowhere) {
  const ComparedPictures p = compare_for_display(constant_picture(3), constant_picture(3));
  EXPECT_EQ(p.rmse, 0);
  EXPECT_EQ(p.flip_mean, 0);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(p.signed_luminance.data[i], signed_colour(0)[i]);
}

TEST(ReportPictures, BrighterAndDarkerHaveColoursOfTheirOwn) {
  const ComparedPictures brighter = compare_for_display(constant_picture(1.1f), constant_picture(1)),
                         darker = compare_for_display(constant_picture(0.9f), constant_picture(1));
  EXPECT_GT(brighter.signed_luminance.data[0], brighter.signed_luminance.data[2]); // orange
  EXPECT_LT(darker.signed_luminance.data[0], darker.signed_luminance.data[2]);     // blue
  EXPECT_GT(brighter.flip_mean, 0);
}

TEST(ReportPictures, ExposureOfTheReferenceHoldsForBoth) {
  // Twice the light through the same exposure: RMSE is the reference's displayed key.
  const ComparedPictures p = compare_for_display(constant_picture(40), constant_picture(20));
  EXPECT_NEAR(p.rmse, 0.16, 1e-6);
}

TEST(ReportPictures, StandSideBySideWithGaps) {
  const std::array<Image, 2> two{constant_picture(0), constant_picture(1)};
  const Image row = side_by_side(two, 3, 0.5f);
  EXPECT_EQ(row.width, 51);
  EXPECT_EQ(row.at(23, 5)[0], 0);
  EXPECT_EQ(row.at(24, 5)[0], 0.5f);
  EXPECT_EQ(row.at(27, 5)[0], 1);
}

TEST(ReportPictures, DataUrlDecodesToThePng) {
  for (const int width : {1, 2, 3, 4, 5, 6}) { // lengths of all remainders by three
    const Image image(width, 1, {"R", "G", "B"});
    const std::string url = png_data_url(image), head = "data:image/png;base64,";
    ASSERT_EQ(url.substr(0, head.size()), head);
    ASSERT_EQ((url.size() - head.size()) % 4, 0u);
    static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<std::uint8_t> bytes;
    std::uint32_t word = 0;
    int bits = 0;
    for (const char c : url.substr(head.size())) {
      if (c == '=') break;
      word = word << 6 | static_cast<std::uint32_t>(digits.find(c));
      if ((bits += 6) >= 8) bytes.push_back(static_cast<std::uint8_t>(word >> (bits -= 8)));
    }
    EXPECT_EQ(bytes, encode_png(image));
  }
}

} // namespace
} // namespace nacre
