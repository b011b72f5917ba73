#include "core/file.h"

#include "core/error.h"
#include "core/scratch_folder.h"

#include <csignal>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <thread>

namespace nacre {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// No file of this process may grow beyond `bytes` while this lives: writing more fails as on a full disk,
/// only with another reason (EFBIG).
class FileSizeLimit {
public:
  explicit FileSizeLimit(rlim_t bytes) : signal_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, signal_);
  }

private:
  rlimit before_{};
  void (*signal_)(int);
};

std::string read_error(const std::string& path) {
  return message_of<Error>([&] { read_file(path); });
}
std::string write_error(const std::string& path, const std::string& text = "text") {
  return message_of<Error>([&] { write_file_atomically(path, text); });
}

TEST(File, WhatIsWrittenIsRead) {
  const ScratchFolder folder;
  std::vector<std::uint8_t> bytes(300'000);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(i * 2654435761u >> 13);
  write_file_atomically(folder / "bytes", bytes);
  EXPECT_EQ(read_file(folder / "bytes"), bytes);
  const std::string text("a\0b\r\n\n", 6);
  write_file_atomically(folder / "text", text);
  EXPECT_EQ(read_text_file(folder / "text"), text);
  write_file_atomically(folder / "empty", std::string_view());
  EXPECT_THAT(read_file(folder / "empty"), IsEmpty());
  EXPECT_THAT(folder.contents(), ElementsAre("bytes", "empty", "text"));
}

TEST(File, AFileWhoseSizeIsUnknownIsReadWhole) {
  // The kernel says that this file has 0 bytes.
  EXPECT_THAT(read_text_file("/proc/self/status"), AllOf(HasSubstr("Name:"), HasSubstr("Threads:")));
}

TEST(File, WhatCannotBeReadIsSaid) {
  const ScratchFolder folder;
  EXPECT_EQ(read_error(folder / "none"), folder / "none" + ": no such file");
  EXPECT_EQ(read_error(folder.path()), folder.path() + ": is a directory, expected a file");
  EXPECT_THAT(read_error(""), HasSubstr("empty"));
  EXPECT_THAT(read_error("/dev/zero"), HasSubstr("not a regular file"));
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(read_error(folder / "pipe"), HasSubstr("not a regular file"));
}

TEST(File, ASizeBeyondMemoryIsRefusedBeforeItIsAllocated) {
  const ScratchFolder folder;
  write_file_atomically(folder / "sparse", "x");
  if (::truncate((folder / "sparse").c_str(), off_t(1) << 43) != 0) GTEST_SKIP() << "no sparse files here";
  EXPECT_THAT(read_error(folder / "sparse"), HasSubstr("more than this machine's memory"));
}

TEST(File, AFileThatCannotBeWrittenWholeIsNotWrittenAtAll) {
  const ScratchFolder folder;
  write_file_atomically(folder / "old", "what was here before");
  const std::string large(100'000, 'x');
  {
    const FileSizeLimit limit(4096);
    EXPECT_THAT(write_error(folder / "old", large), AllOf(HasSubstr("old"), HasSubstr("File too large")));
    EXPECT_THAT(write_error(folder / "new", large), AllOf(HasSubstr("new"), HasSubstr("File too large")));
  }
  EXPECT_THAT(folder.contents(), ElementsAre("old"));
  EXPECT_EQ(read_text_file(folder / "old"), "what was here before");
}

TEST(File, AFullDiskIsSaid) {
  if (::access("/dev/full", W_OK) != 0) GTEST_SKIP() << "there is no /dev/full here";
  EXPECT_EQ(write_error("/dev/full"), "/dev/full: cannot be written: No space left on device");
  struct stat status {};
  ASSERT_EQ(::stat("/dev/full", &status), 0);
  EXPECT_TRUE(S_ISCHR(status.st_mode)) << "a device must not be replaced by a file";
}

TEST(File, AMissingFolderIsNamed) {
  const ScratchFolder folder;
  EXPECT_EQ(write_error(folder / "none/a.exr"),
            (folder / "none/a.exr") + ": cannot be written: there is no folder '" + (folder / "none") + "'");
  write_file_atomically(folder / "file", "x");
  EXPECT_THAT(write_error(folder / "file/a.exr"), HasSubstr("there is no folder"));
  EXPECT_THAT(write_error(folder.path()), HasSubstr("is a directory"));
  EXPECT_THAT(write_error(folder / "none/"), HasSubstr("name of a folder"));
  EXPECT_THAT(write_error(""), HasSubstr("empty"));
  EXPECT_THAT(folder.contents(), ElementsAre("file"));
}

TEST(File, ANameTooLongForTheFileSystemIsAnError) {
  const ScratchFolder folder;
  EXPECT_THAT(write_error(folder / std::string(300, 'n')), HasSubstr("File name too long"));
}

TEST(File, ALinkKeepsPointingAndPermissionsStay) {
  const ScratchFolder folder;
  write_file_atomically(folder / "file", "old");
  ASSERT_EQ(::chmod((folder / "file").c_str(), 0640), 0);
  std::filesystem::create_symlink("file", folder / "link");
  write_file_atomically(folder / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(read_text_file(folder / "file"), "new");
  struct stat status {};
  ASSERT_EQ(::stat((folder / "file").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0640u);
}

TEST(File, AReaderSeesTheOldOrTheNewFileNeverAPart) {
  const ScratchFolder folder;
  const std::string path = folder / "file", a(200'000, 'a'), b(200'000, 'b');
  write_file_atomically(path, a);
  std::thread writer([&] {
    for (int i = 0; i < 20; ++i)
      write_file_atomically(path, i % 2 ? a : b);
  });
  for (int i = 0; i < 200; ++i) {
    const std::string seen = read_text_file(path);
    EXPECT_TRUE(seen == a || seen == b) << seen.size() << " bytes";
  }
  writer.join();
  EXPECT_THAT(folder.contents(), ElementsAre("file"));
}

TEST(FindFile, TakesTheFirstFolderThatHasIt) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "a");
  std::filesystem::create_directories(folder / "b");
  const std::vector<std::string> folders = {folder / "a", folder / "b"};
  write_file_atomically(folder / "b/brick.exr", "x");
  EXPECT_EQ(find_file("brick.exr", folders), folder / "b/brick.exr");
  std::filesystem::create_directories(folder / "a/brick.exr");
  EXPECT_EQ(find_file("brick.exr", folders), folder / "b/brick.exr") << "a folder is not a file";
  std::filesystem::remove(folder / "a/brick.exr");
  write_file_atomically(folder / "a/brick.exr", "x");
  EXPECT_EQ(find_file("brick.exr", folders), folder / "a/brick.exr");
  EXPECT_EQ(find_file("/anywhere/brick.exr", folders), "/anywhere/brick.exr");
}

TEST(FindFile, SaysWhereItLookedAndWhatWasMeant) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "textures");
  write_file_atomically(folder / "textures/brick.exr", "x");
  const std::vector<std::string> folders = {folder.path(), folder / "none"};
  EXPECT_THAT(message_of<Error>([&] { find_file("textures/birck.exr", folders); }),
              AllOf(HasSubstr(folder.path()), HasSubstr(folder / "none"),
                    HasSubstr("did you mean 'textures/brick.exr'?")));
  EXPECT_THAT(message_of<Error>([&] { find_file("x", {}); }), HasSubstr("no such file in any folder"));
}

} // namespace
} // namespace nacre
