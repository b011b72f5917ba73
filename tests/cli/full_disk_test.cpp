// Places that cannot be written to: one line, and nothing is left behind.

#include "run_command.h"
#include "small_input.h"

#include <sys/mount.h>

namespace nacre {
namespace {

struct Writer {
  std::vector<std::string> command; ///< with the output's name last
  std::string extension;
};

/// One line for every command that writes a file.
std::vector<Writer> writers(const ScratchFolder& folder) {
  const std::string picture = small_picture(folder, "in.exr", 96, 64);
  SceneParts parts;
  parts.film = "<integer name='width' value='96'/><integer name='height' value='64'/>";
  return {{{"render", small_scene(folder, parts), "--spp", "1", "--quiet", "-o"}, ".exr"},
          {{"plot", "lambert", "-o"}, ".svg"},
          {{"fit", small_table(folder), "--model", "lambert", "--starts", "1", "-o"}, ".json"},
          {{"tonemap", picture}, ".png"},
          {{"compare", picture, picture, "--flip-map"}, ".exr"},
          {{"compare", picture, picture, "--difference"}, ".exr"}};
}

std::vector<std::string> to(Writer writer, const std::string& place) {
  writer.command.push_back(place + writer.extension);
  return writer.command;
}

TEST(FullDisk, AFileThatGrowsTooLargeIsAnErrorAndLeavesNothing) {
  const ScratchFolder folder;
  const std::vector<Writer> all = writers(folder);
  const std::vector<std::string> before = folder.contents();
  RunOptions options;
  options.largest_file = 300;
  for (const Writer& writer : all)
    expect_failure(1, to(writer, folder / "out"), {folder / "out", "cannot be written", "File too large"},
                   options);
  EXPECT_EQ(folder.contents(), before);
}

TEST(FullDisk, AFullFileSystemIsAnErrorAndLeavesNothing) {
  const ScratchFolder folder, place;
  const std::string disk = place / "disk";
  std::filesystem::create_directory(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=4k") != 0)
    GTEST_SKIP() << "mounting a small file system needs root";
  const std::vector<Writer> all = writers(folder);
  {
    // All but the last bytes are taken already.
    std::ofstream(disk + "/taken") << std::string(4096, 'x');
    std::ofstream(disk + "/small.exr"); // what was there stays as it was
    for (const Writer& writer : all)
      expect_failure(1, to(writer, disk + "/out"), {disk + "/out", "No space left"});
    expect_failure(1, to(all[0], disk + "/small"), {"small.exr", "No space left"});
  }
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(disk))
    left.push_back(entry.path().filename().string());
  std::sort(left.begin(), left.end());
  EXPECT_EQ(left, (std::vector<std::string>{"small.exr", "taken"}));
  EXPECT_EQ(std::filesystem::file_size(disk + "/small.exr"), 0u);
  EXPECT_EQ(::umount(disk.c_str()), 0);
}

TEST(FullDisk, AFullStandardOutputIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  RunOptions options;
  options.stdout_to = "/dev/full";
  expect_failure(1, {"materials", "--json"}, {"standard output"}, options);
  expect_failure(1, {"eval", "lambert"}, {"standard output"}, options);
}

TEST(FullDisk, AMissingFolderOrAFolderInPlaceOfTheFileIsNamed) {
  const ScratchFolder folder;
  const std::vector<Writer> all = writers(folder);
  for (const char* extension : {".exr", ".svg", ".json", ".png"})
    std::filesystem::create_directory(folder / ("taken" + std::string(extension)));
  const std::vector<std::string> before = folder.contents();
  for (const Writer& writer : all) {
    expect_failure(1, to(writer, folder / "nowhere/out"), {"folder", folder / "nowhere"});
    expect_failure(1, to(writer, folder / "taken"), {folder / "taken", writer.extension});
  }
  expect_failure(1, {"demo", small_table(folder), "-o", folder / "in.exr", "--spp", "1", "--quiet"},
                 {"in.exr", "folder"});
  EXPECT_EQ(folder.contents(), before);
}

} // namespace
} // namespace nacre
