#include "core/error.h"
#include "core/file.h"
#include "core/random.h"
#include "measured/merl_table.h"

#include <cstring>
#include <filesystem>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

using testing::HasSubstr;

/// Random floats of many magnitudes, a tenth of them holes.
MerlTable random_table(int n_theta_h, int n_theta_d, int n_phi_d) {
  std::vector<MerlTable::Cell> cells(static_cast<std::size_t>(n_theta_h) * n_theta_d * n_phi_d);
  for (std::size_t c = 0; c < cells.size(); ++c)
    if (uniform(1, c, 0, 0) > 0.1f)
      cells[c] = {std::pow(10.0f, 12 * uniform(1, c, 1, 0) - 8), uniform(1, c, 2, 0), 0.0f, 1.0f};
  return MerlTable(n_theta_h, n_theta_d, n_phi_d, std::move(cells));
}

void set_double(std::vector<std::uint8_t>& bytes, std::size_t offset, double x) {
  std::memcpy(&bytes[offset], &x, sizeof x);
}
std::vector<std::uint8_t> header(std::int32_t a, std::int32_t b, std::int32_t c, std::size_t size) {
  std::vector<std::uint8_t> bytes(std::max<std::size_t>(size, 12));
  const std::int32_t n[] = {a, b, c};
  std::memcpy(bytes.data(), n, 12);
  bytes.resize(size);
  return bytes;
}
std::string message_of(std::span<const std::uint8_t> bytes) {
  try {
    parse_merl(bytes, "x.binary");
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(MerlFormat, TablesSurviveTheRoundTripThroughBytes) {
  for (const auto& n : std::vector<std::array<int, 3>>{{1, 1, 1}, {3, 1, 5}, {7, 9, 12}, {4, 5, 360}}) {
    const MerlTable table = random_table(n[0], n[1], n[2]),
                    back = parse_merl(encode_merl(table), "round trip");
    EXPECT_EQ(back.n_theta_h(), n[0]);
    EXPECT_EQ(back.n_theta_d(), n[1]);
    EXPECT_EQ(back.n_phi_d(), n[2]);
    EXPECT_EQ(back.hole_count(), table.hole_count());
    EXPECT_TRUE(
        std::equal(table.cells().begin(), table.cells().end(), back.cells().begin(), back.cells().end()));
  }
}

TEST(MerlFormat, TablesSurviveTheRoundTripThroughAFile) {
  const std::string path = testing::TempDir() + "nacre_merl_round_trip.binary";
  const MerlTable table = random_table(6, 5, 8);
  write_merl(table, path);
  const auto back = read_merl(path);
  EXPECT_TRUE(std::equal(table.cells().begin(), table.cells().end(), back->cells().begin()));
  std::filesystem::remove(path);
}

TEST(MerlFormat, StoredNumbersAreScaledByChannelAndOrderedPhiFastest) {
  auto bytes = header(2, 3, 4, 12 + 24 * 24);
  const int i = 1, j = 2, k = 3, cell = k + 4 * (j + 3 * i);
  for (int channel = 0; channel < 3; ++channel)
    set_double(bytes, 12 + 8 * (24 * channel + cell), 1500);
  const MerlTable table = parse_merl(bytes, "x");
  EXPECT_EQ(table.cell(i, j, k), (MerlTable::Cell{1.0f, 1.15f, 1.66f, 1.0f}));
  EXPECT_EQ(table.cell(1, 2, 2), (MerlTable::Cell{0, 0, 0, 1}));
}

TEST(MerlFormat, AnyNegativeChannelMakesAHole) {
  auto bytes = header(1, 1, 2, 12 + 48);
  set_double(bytes, 12 + 16, -1e-9); // green of the first cell
  const MerlTable table = parse_merl(bytes, "x");
  EXPECT_EQ(table.hole_count(), 1u);
  EXPECT_TRUE(table.is_hole(0, 0, 0));
  EXPECT_FALSE(table.is_hole(0, 0, 1));
}

TEST(MerlFormat, NodesAreTheLowerEdgesOfTheFormatsCells) {
  const MerlTable table = random_table(9, 6, 18);
  EXPECT_EQ(table.theta_h(0), 0);
  EXPECT_DOUBLE_EQ(table.theta_h(3), pi / 18);
  EXPECT_DOUBLE_EQ(table.theta_d(3), pi / 4);
  EXPECT_DOUBLE_EQ(table.phi_d(9), pi / 2);
  EXPECT_DOUBLE_EQ(random_table(1, 1, 360).phi_d(90), pi / 2);
}

TEST(MerlFormat, WrongSizesAreNamedWithBytesExpectedAndFound) {
  EXPECT_THAT(message_of({}), HasSubstr("found 0 bytes"));
  EXPECT_THAT(message_of(header(1, 1, 1, 11)), HasSubstr("byte 11"));
  EXPECT_THAT(message_of(header(90, 90, 180, 1000)), AllOf(HasSubstr("34992012"), HasSubstr("1000")));
  EXPECT_THAT(message_of(header(1, 1, 1, 12)), HasSubstr("expected 36 bytes"));
  EXPECT_THAT(message_of(header(1, 1, 1, 37)), AllOf(HasSubstr("byte 36"), HasSubstr("found 37")));
}

TEST(MerlFormat, ImpossibleDimensionsAreRefusedBeforeAnythingIsAllocated) {
  const int huge = std::numeric_limits<std::int32_t>::max();
  EXPECT_THAT(message_of(header(0, 90, 180, 100)), AllOf(HasSubstr("byte 0"), HasSubstr("n_theta_h is 0")));
  EXPECT_THAT(message_of(header(90, -90, 180, 100)),
              AllOf(HasSubstr("byte 4"), HasSubstr("n_theta_d is -90")));
  EXPECT_THAT(message_of(header(90, 90, huge, 100)), AllOf(HasSubstr("byte 8"), HasSubstr("n_phi_d")));
  EXPECT_THAT(message_of(header(4096, 4096, 4096, 100)), HasSubstr("entries"));
  EXPECT_THAT(message_of(header(65536, 65536, 1, 12)), HasSubstr("65536")); // 2^32 wraps to 0
  EXPECT_THROW(MerlTable::tabulate(huge, huge, huge, {}), Error);
  EXPECT_THROW(MerlTable(2, 2, 2, std::vector<MerlTable::Cell>(7)), Error);
}

TEST(MerlFormat, NumbersThatAreNoReflectanceAreCountedAndTheFirstIsLocated) {
  auto bytes = encode_merl(random_table(2, 2, 2));
  set_double(bytes, 12 + 8 * 21, std::numeric_limits<double>::quiet_NaN());
  set_double(bytes, 12 + 8 * 11, -std::numeric_limits<double>::infinity());
  EXPECT_THAT(message_of(bytes), AllOf(HasSubstr("byte 100"), HasSubstr("2 values"), HasSubstr("-inf")));
  bytes = encode_merl(random_table(2, 2, 2));
  set_double(bytes, 12, 1e300);
  EXPECT_THAT(message_of(bytes), AllOf(HasSubstr("byte 12"), HasSubstr("1 value ")));
  EXPECT_THROW(MerlTable::tabulate(1, 1, 1,
                                   [](double, double, double) -> std::array<double, 3> {
                                     return {std::nan(""), 0, 0};
                                   }),
               Error);
}

TEST(MerlFormat, ADirectoryAndAMissingFileAreErrorsThatNameThePath) {
  for (const std::string& path : {testing::TempDir(), testing::TempDir() + "nacre_no_such.binary"})
    try {
      read_merl(path);
      FAIL() << path;
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), HasSubstr(path));
    }
}

TEST(MerlFormat, MutatedFilesGiveATableOrAnError) {
  const auto whole = encode_merl(random_table(3, 4, 5));
  int tables = 0, errors = 0;
  for (int n = 0; n < 20000; ++n) {
    auto bytes = whole;
    auto random = [&, d = 0](std::size_t below) mutable { return hash(42, n, d++) % below; };
    for (std::size_t edits = 1 + random(4); edits > 0; --edits)
      switch (random(5)) {
      case 0:
        bytes.resize(random(bytes.size() + 1));
        break;
      case 1:
        bytes.resize(bytes.size() + random(64), 0xff);
        break;
      case 2: // often in the header
        if (!bytes.empty()) bytes[random(std::min<std::size_t>(bytes.size(), 16))] = random(256);
        break;
      case 3:
        if (!bytes.empty()) bytes[random(bytes.size())] ^= 1u << random(8);
        break;
      default:
        if (!bytes.empty()) bytes.erase(bytes.begin() + random(bytes.size()));
      }
    try {
      const MerlTable table = parse_merl(bytes, "mutant");
      ++tables;
      for (const auto& cell : table.cells())
        for (const float x : cell)
          ASSERT_TRUE(x >= 0 && std::isfinite(x)) << "mutant " << n;
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(tables, 500); // both ways are taken
  EXPECT_GT(errors, 500);
}

} // namespace
} // namespace nacre
