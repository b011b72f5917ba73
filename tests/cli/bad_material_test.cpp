// Materials and tables that do not work: status 1 and one line with the place.

#include "run_command.h"
#include "small_input.h"

#include <cstring>
#include <limits>

namespace nacre {
namespace {

/// Every command that reads a material, given this one.
std::vector<std::vector<std::string>> readers_of(const std::string& material, const ScratchFolder& folder) {
  return {{"eval", material}, {"validate", material}, {"plot", material, "-o", folder / "out.svg"}};
}
std::vector<std::vector<std::string>> readers_of_table(const std::string& table,
                                                       const ScratchFolder& folder) {
  auto commands = readers_of(table, folder);
  commands.push_back({"info", table});
  commands.push_back({"fit", table, "-o", folder / "out.json"});
  commands.push_back({"demo", table, "-o", folder / "out"});
  return commands;
}

/// Each of the commands names the file and says `parts`, and none leaves a file.
void expect_table_refused(const std::string& table, const std::vector<std::string>& parts,
                          const ScratchFolder& folder) {
  const std::vector<std::string> before = folder.contents();
  for (const auto& command : readers_of_table(table, folder)) {
    std::vector<std::string> said = parts;
    said.push_back(table + ": ");
    expect_failure(1, command, said);
  }
  EXPECT_EQ(folder.contents(), before);
}

std::string with_header(std::string bytes, std::array<std::int32_t, 3> dims) {
  std::memcpy(bytes.data(), dims.data(), sizeof dims);
  return bytes;
}

TEST(BadTable, TruncatedIsNamedWithTheByteAndBothSizes) {
  const ScratchFolder folder;
  const std::size_t whole = std::filesystem::file_size(small_table(folder)); // 12 + 24 * 8 * 8 * 16
  ASSERT_EQ(whole, 24588u);
  expect_table_refused(truncated(folder, folder / "small.binary", "cut.binary", whole - 8),
                       {"byte 24580", "expected 24588 bytes", "8 x 8 x 16"}, folder);
  expect_table_refused(truncated(folder, folder / "small.binary", "header.binary", 7), {"byte 7", "12 bytes"},
                       folder);
  expect_table_refused(write(folder, "empty.binary", ""), {"byte 0", "12 bytes"}, folder);
}

TEST(BadTable, OfTheWrongSizeIsNamedWithBothSizes) {
  const ScratchFolder folder;
  const std::string bytes = read_text_file(small_table(folder));
  expect_table_refused(write(folder, "long.binary", bytes + std::string(8, '\0')),
                       {"expected 24588 bytes", "found 24596"}, folder);
  constexpr std::int32_t huge = std::numeric_limits<std::int32_t>::max();
  for (const auto& dims :
       {std::array<std::int32_t, 3>{huge, huge, huge}, {-1, -1, 1024}, {0, 8, 16}, {huge, 1, 1}})
    expect_table_refused(write(folder, "dims.binary", with_header(bytes, dims)), {"byte 0", "90 x 90 x 180"},
                         folder);
}

TEST(BadTable, OfHundredGigabytesIsRefusedAtOnce) {
  const ScratchFolder folder;
  const std::string table = write(folder, "sparse.binary", "");
  std::error_code no_room;
  std::filesystem::resize_file(table, 100ull << 30, no_room);
  if (no_room) GTEST_SKIP() << "no sparse files here: " << no_room.message();
  RunOptions quick;
  quick.seconds = 5;
  for (const auto& command : readers_of_table(table, folder))
    expect_failure(1, command, {"sparse.binary", "107374182400 bytes"}, quick);
}

TEST(BadTable, WithAValueThatIsNoNumberIsNamedWithTheByte) {
  const ScratchFolder folder;
  std::string bytes = read_text_file(small_table(folder));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::memcpy(bytes.data() + 12 + 8 * 100, &nan, sizeof nan);
  expect_table_refused(write(folder, "nan.binary", bytes), {"byte 812", "nan"}, folder);
}

TEST(BadTable, ThatIsADirectoryOrMissingIsSaidToBe) {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "folder.binary");
  expect_table_refused(folder / "folder.binary", {"is a directory, expected a file"}, folder);
  expect_table_refused(folder / "missing.binary", {"no such file"}, folder);
}

TEST(BadMaterial, AMisspeltNameComesWithTheNearest) {
  const ScratchFolder folder;
  for (const auto& command : readers_of("lamber", folder))
    expect_failure(1, command, {"unknown model 'lamber'", "did you mean 'lambert'?"});
  for (const auto& command : readers_of("lambert:reflectence=0.5", folder))
    expect_failure(1, command, {"lambert", "'reflectence'", "did you mean 'reflectance'?"});
  expect_failure(1, {"materials", "ggx_condutor"}, {"'ggx_condutor'", "did you mean 'ggx_conductor'?"});
  expect_failure(1, {"fit", small_table(folder), "--model", "lambert+ggx_shlick"},
                 {"did you mean 'ggx_schlick'?"});
  expect_failure(1, {"demo", "--material", "gold-pant", "-o", folder / "out"},
                 {"did you mean 'gold-paint'?"});
  EXPECT_EQ(folder.contents(), std::vector<std::string>{"small.binary"});
}

TEST(BadMaterial, AValueOutsideItsDomainComesWithTheDomain) {
  const ScratchFolder folder;
  for (const auto& command : readers_of("lambert:reflectance=2", folder))
    expect_failure(1, command, {"lambert: reflectance = 2", "[0, 1]"});
  expect_failure(1, {"eval", "ggx_conductor:alpha_x=0"}, {"alpha_x = 0", "[0.001, 1]"});
  expect_failure(1, {"eval", "lambert:reflectance=0.1/-1/0.1"}, {"reflectance = -1"});
  expect_failure(1, {"fit", small_table(folder), "--model", "lambert:reflectance=3"}, {"reflectance = 3"});
}

TEST(BadMaterial, AMalformedValueIsShown) {
  for (const char* value : {"abc", "", "nan", "1e400", "0x1", "1.2.3"})
    expect_failure(1, {"eval", std::string("lambert:reflectance=") + value},
                   {"lambert: reflectance: expected a number, found '" + std::string(value) + "'"});
  expect_failure(1, {"eval", "lambert:reflectance=1/2"}, {"found 2 numbers"});
  expect_failure(1, {"eval", "lambert:reflectance"}, {"expected PARAM=VALUE", "'reflectance'"});
  expect_failure(1, {"eval", "lambert:reflectance=0.1,reflectance=0.2"}, {"reflectance is given twice"});
  expect_failure(1, {"eval", ""}, {"unknown model ''"});
  expect_failure(1, {"eval", "lambert+"}, {"unknown model ''"});
  expect_failure(1, {"eval", "lambert+lambert+lambert+lambert+lambert"}, {"found 5"});
}

TEST(BadMaterial, AJsonFileIsNamedWithThePlace) {
  const ScratchFolder folder;
  expect_failure(1, {"eval", write(folder, "a.json", "{\n  \"lobes\": [,]\n}")}, {"a.json:2:"});
  expect_failure(1, {"eval", write(folder, "b.json", "")}, {"b.json:1:1"});
  expect_failure(1, {"eval", write(folder, "c.json", "[]")}, {"c.json"});
  expect_failure(1, {"eval", write(folder, "d.json", "{\"lobes\": 3}")}, {"d.json", "lobes"});
  expect_failure(1, {"eval", write(folder, "e.json", std::string(200000, '['))}, {"e.json"});
  expect_failure(
      1,
      {"eval", write(folder, "g.json",
                     "{\"lobes\": [{\"model\": \"lambert\", \"weight\": -1, \"parameters\": {}}]}")},
      {"g.json", "weight = -1"});
  std::filesystem::create_directory(folder / "f.json");
  expect_failure(1, {"eval", folder / "f.json"}, {"f.json", "is a directory"});
}

} // namespace
} // namespace nacre
