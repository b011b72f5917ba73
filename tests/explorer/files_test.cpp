#include "explorer/workbench.h"

#include <gmock/gmock.h>

namespace nacre {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

TEST(ExplorerFolder, NothingOutsideIsOpened) {
  ScratchFolder outside;
  outside.write("secret.brdf", "secret");
  Workbench w;
  w.folder.write("inside/a.brdf", "text");
  fs::create_symlink(outside / "secret.brdf", w.folder / "link.brdf");
  fs::create_directory_symlink(outside.path(), w.folder / "linked");
  fs::create_symlink(w.folder / "inside/a.brdf", w.folder / "good.brdf");

  EXPECT_EQ(w.ask("read", {{"file", "inside/a.brdf"}}).header["text"], "text");
  EXPECT_EQ(w.ask("read", {{"file", "good.brdf"}}).header["text"], "text");
  EXPECT_THAT(w.error("read", {{"file", outside / "secret.brdf"}}), HasSubstr("relative"));
  EXPECT_THAT(
      w.error("read", {{"file", "../" + fs::path(outside.path()).filename().string() + "/secret.brdf"}}),
      HasSubstr("'..'"));
  EXPECT_THAT(w.error("read", {{"file", "inside/../inside/a.brdf"}}), HasSubstr("'..'"));
  EXPECT_THAT(w.error("read", {{"file", "link.brdf"}}), HasSubstr("leads out"));
  EXPECT_THAT(w.error("read", {{"file", "linked/secret.brdf"}}), HasSubstr("leads out"));
  EXPECT_THAT(w.error("read", {{"file", std::string("a\0b", 3)}}), HasSubstr("zero byte"));
  EXPECT_THAT(w.error("read", {{"file", "upload:../x"}}), HasSubstr("plain"));
  EXPECT_THAT(w.error("files", {{"folder", ".."}}), HasSubstr("'..'"));
  EXPECT_THAT(w.error("files", {{"folder", "linked"}}), HasSubstr("leads out"));
  for (const char* type : {"material", "validate"})
    for (const std::string name : {"../x.binary", "/etc/hostname", "../x.json", "./x"})
      EXPECT_NE(w.error(type, {{"material", {{"text", name}}}}), "") << name;
}

TEST(ExplorerFolder, APrefixOfTheNameIsNotTheFolder) {
  EXPECT_TRUE(lies_below("/a/b/c", "/a/b"));
  EXPECT_TRUE(lies_below("/a/b", "/a/b"));
  EXPECT_FALSE(lies_below("/a/bc", "/a/b"));
  EXPECT_FALSE(lies_below("/a", "/a/b"));
}

TEST(ExplorerFolder, AFenceStopsEveryReader) {
  ScratchFolder inside, outside;
  inside.write("a.txt", "a"), outside.write("b.txt", "b");
  fs::create_symlink(outside / "b.txt", inside / "link.txt");
  {
    const ReadingFence fence({inside.path()});
    EXPECT_EQ(read_text_file(inside / "a.txt"), "a");
    EXPECT_THROW(read_text_file(outside / "b.txt"), Error);
    EXPECT_THROW(read_text_file(inside / "link.txt"), Error);
  }
  EXPECT_EQ(read_text_file(outside / "b.txt"), "b");
}

TEST(ExplorerFolder, WritesOnlyWhatItMay) {
  ScratchFolder outside;
  outside.write("kept.brdf", "kept");
  Workbench w;
  fs::create_directory_symlink(outside.path(), w.folder / "linked");
  fs::create_symlink(outside / "kept.brdf", w.folder / "link.brdf");
  fs::create_symlink(outside / "new.brdf", w.folder / "dangling.brdf");
  fs::create_directory(w.folder / "folder.brdf");
  w.ask("write", {{"file", "a.brdf"}, {"text", "one"}});
  w.ask("write", {{"file", "a.brdf"}, {"text", "two"}});
  EXPECT_EQ(read_text_file(w.folder / "a.brdf"), "two");
  for (const std::string name :
       {"a.sh", "a", ".bashrc", "a.binary", "a.exr", "../a.brdf", "/tmp/a.brdf", "none/a.brdf",
        "linked/a.brdf", "link.brdf", "dangling.brdf", "folder.brdf", ".brdf", ""})
    EXPECT_NE(w.error("write", {{"file", name}, {"text", "x"}}), "") << name;
  // Longer than a name may be on this disk; what is said of it holds no path of this machine.
  EXPECT_THAT(w.error("write", {{"file", std::string(300, 'a') + ".brdf"}, {"text", "x"}}),
              testing::AllOf(HasSubstr("too long"), testing::Not(HasSubstr(w.folder.path()))));
  EXPECT_EQ(read_text_file(outside / "kept.brdf"), "kept");
  EXPECT_FALSE(fs::exists(outside / "new.brdf"));
}

TEST(ExplorerFiles, AreListedByWhatTheyAre) {
  Workbench w;
  w.folder.write("b.brdf", ""), w.folder.write("s.xml", "<scene version='3.0.0'/>"),
      w.folder.write("x.o", "");
  w.folder.write("sub/m.obj", ""), w.folder.write(".hidden.json", ""), w.folder.write("t.binary", "1234");
  const json entries = w.ask("files", {{"folder", ""}}).header["entries"];
  std::vector<std::string> seen;
  for (const json& e : entries)
    seen.push_back(e["name"].get<std::string>() + ":" +
                   (e["is_folder"].get<bool>() ? "folder" : e["kind"].get<std::string>()));
  EXPECT_THAT(seen, testing::ElementsAre("sub:folder", "b.brdf:brdf", "s.xml:scene", "t.binary:measured"));
  EXPECT_EQ(entries[3]["size"], 4);
  EXPECT_NEAR(entries[3]["modified"].get<double>(), double(std::time(nullptr)), 100);
}

TEST(ExplorerFiles, AChangeIsTold) {
  Workbench w;
  w.folder.write("b.brdf", "one");
  int calls = 0;
  w.on_progress = [&] { w.cancelled = ++calls > 0; };
  std::thread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    write_file_atomically(w.folder / "b.brdf", std::string_view("three"));
  });
  w.ask("watch", {{"files", {"b.brdf"}}});
  writer.join();
  ASSERT_EQ(w.progress.size(), 1u);
  EXPECT_EQ(w.progress[0].second.header["changed"], "b.brdf");
}

TEST(ExplorerFiles, WhatIsNotThereYetIsWatchedBesideWhatIs) {
  Workbench w;
  w.folder.write("b.brdf", "one");
  int calls = 0;
  w.on_progress = [&] { w.cancelled = ++calls > 1; };
  std::thread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    write_file_atomically(w.folder / "new.brdf", std::string_view("new"));
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    write_file_atomically(w.folder / "b.brdf", std::string_view("three"));
  });
  w.ask("watch", {{"files", {"new.brdf", "b.brdf"}}});
  writer.join();
  ASSERT_EQ(w.progress.size(), 2u);
  EXPECT_EQ(w.progress[0].second.header["changed"], "new.brdf");
  EXPECT_EQ(w.progress[1].second.header["changed"], "b.brdf");
}

TEST(ExplorerFiles, AChangedFileIsAnotherMaterial) {
  Workbench w;
  w.folder.write("m.json", to_json(parse_material("lambert:reflectance=0.2")).dump());
  const json ask{{"materials", {{{"file", "m.json"}}}}, {"kind", "theta_o"}, {"points", 2}};
  const float before = array_of(w.ask("curves", ask), "y").data[0];
  w.folder.write("m.json", to_json(parse_material("lambert:reflectance=0.45")).dump());
  const float after = array_of(w.ask("curves", ask), "y").data[0];
  EXPECT_NEAR(after / before, 0.45 / 0.2, 1e-5);
}

} // namespace
} // namespace nacre
