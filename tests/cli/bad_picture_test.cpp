// Pictures that do not work: status 1, one line with the file and the byte, and no output.

#include "run_command.h"
#include "small_input.h"

namespace nacre {
namespace {

/// Every command that reads a picture names this one and says `parts`; none writes anything.
void expect_refused(const ScratchFolder& folder, const std::string& picture,
                    const std::vector<std::string>& parts) {
  const std::string good = small_picture(folder, "good.exr");
  const std::vector<std::string> before = folder.contents();
  expect_failure(1, {"info", picture}, parts);
  expect_failure(1, {"tonemap", picture, folder / "out.png"}, parts);
  expect_failure(1, {"compare", picture, good, "--flip-map", folder / "out.png"}, parts);
  expect_failure(1, {"compare", good, picture, "--difference", folder / "out.exr"}, parts);
  EXPECT_EQ(folder.contents(), before);
}

TEST(BadPicture, TruncatedAnywhereIsNamedWithTheByte) {
  const ScratchFolder folder;
  const std::string whole = small_picture(folder, "whole.exr");
  const std::size_t size = std::filesystem::file_size(whole);
  for (const std::size_t cut : {std::size_t(0), std::size_t(3), std::size_t(300), size / 2, size - 1})
    expect_refused(folder, truncated(folder, whole, "cut.exr", cut), {"cut.exr: byte "});
}

TEST(BadPicture, OfAnotherKindADirectoryOrMissingIsSaidToBe) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "folder.exr");
  expect_refused(folder, write(folder, "text.exr", "this is no picture"),
                 {"text.exr: byte 0", "not an OpenEXR file"});
  expect_refused(folder, folder / "folder.exr", {"folder.exr: is a directory, expected a file"});
  expect_refused(folder, folder / "missing.exr", {"missing.exr: no such file"});
  expect_refused(folder, write(folder, "picture.txt", "P3"), {"picture.txt", ".exr"});
  expect_refused(folder, "/dev/null", {"/dev/null", ".exr"});
}

TEST(BadPicture, OfHundredGigabytesIsRefusedAtOnce) {
  const ScratchFolder folder;
  const std::string picture = write(folder, "sparse.exr", "");
  std::error_code no_room;
  std::filesystem::resize_file(picture, 100ull << 30, no_room);
  if (no_room) GTEST_SKIP() << "no sparse files here: " << no_room.message();
  RunOptions quick;
  quick.seconds = 5;
  expect_failure(1, {"tonemap", picture, folder / "out.png"}, {"sparse.exr", "107374182400 bytes"}, quick);
}

TEST(BadPicture, OfAnotherSizeIsNamedWithBothSizes) {
  const ScratchFolder folder;
  const std::string a = small_picture(folder, "a.exr", 24, 16), b = small_picture(folder, "b.exr", 16, 24);
  const std::vector<std::string> before = folder.contents();
  expect_failure(1, {"compare", a, b, "--flip-map", folder / "out.png", "--json"},
                 {"a.exr is 24 x 16", "b.exr is 16 x 24"});
  expect_failure(1, {"compare", a, a, "--variance", b, "--spp", "4"}, {"16 x 24", "24 x 16"});
  EXPECT_EQ(folder.contents(), before);
}

TEST(BadPicture, PixelsThatAreNoNumbersAreCountedInAWarning) {
  const ScratchFolder folder;
  Image image(4, 4, {"R", "G", "B"});
  std::fill(image.data.begin(), image.data.end(), 0.5f);
  image.data[0] = std::nanf("");
  write_exr(image, folder / "nan.exr");
  const Outcome tone = expect_success({"tonemap", folder / "nan.exr", folder / "nan.png"});
  EXPECT_NE(tone.err.find("nan.exr: 1 pixel not a number"), std::string::npos) << tone.err;
  const Outcome compare = expect_success({"compare", folder / "nan.exr", folder / "nan.exr"});
  EXPECT_NE(compare.err.find("1 of 16 pixels are not finite"), std::string::npos) << compare.err;
}

} // namespace
} // namespace nacre
