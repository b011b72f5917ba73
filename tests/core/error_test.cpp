#include "core/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

using testing::HasSubstr;

const std::vector<std::string> models = {"lambert", "oren_nayar", "rough_conductor", "rough_dielectric",
                                         "ward"};

TEST(Error, SaysFileLineAndColumn) {
  EXPECT_STREQ(Error::in_text("a.json", 3, 14, "expected ','").what(), "a.json:3:14: expected ','");
}

TEST(Error, LeavesOutAnUnknownLineOrColumn) {
  EXPECT_STREQ(Error::in_text("a.json", 3, 0, "expected ','").what(), "a.json:3: expected ','");
  EXPECT_STREQ(Error::in_text("a.json", 0, 0, "is empty").what(), "a.json: is empty");
}

TEST(Error, SaysByteOffsetOfABinaryFile) {
  EXPECT_STREQ(Error::in_binary("a.binary", 5000000000u, "ends").what(), "a.binary: byte 5000000000: ends");
}

TEST(Error, AWrongCommandLineIsAnErrorToo) { EXPECT_THROW(throw UsageError("no such command"), Error); }

TEST(NearestName, FindsOneSlipOfTheFinger) {
  EXPECT_EQ(nearest_name("lambret", models), "lambert") << "two letters swapped";
  EXPECT_EQ(nearest_name("lamber", models), "lambert") << "a letter left out";
  EXPECT_EQ(nearest_name("lambertt", models), "lambert") << "a letter doubled";
  EXPECT_EQ(nearest_name("rough_conducter", models), "rough_conductor") << "a letter replaced";
  EXPECT_EQ(nearest_name("Oren_Nayar", models), "oren_nayar") << "other letter case";
}

TEST(NearestName, PrefersTheSmallestDistance) {
  const std::vector<std::string> known = {"alpha_x", "alpha_y", "alpha"};
  EXPECT_EQ(nearest_name("alpa", known), "alpha");
  EXPECT_EQ(nearest_name("alph_y", known), "alpha_y");
}

TEST(NearestName, StaysSilentWhereNothingIsNear) {
  EXPECT_EQ(nearest_name("velvet", models), "");
  EXPECT_EQ(nearest_name("", models), "");
  EXPECT_EQ(nearest_name("lambert", {}), "");
  const std::vector<std::string> letters = {"x", "y"};
  EXPECT_EQ(nearest_name("q", letters), "") << "any letter is one step from any other: no reason to suggest";
}

TEST(NearestName, AHugeNameIsComparedInNoTime) {
  EXPECT_EQ(nearest_name(std::string(100'000'000, 'a'), models), "");
}

TEST(Suggestion, NamesTheNearestOrAll) {
  EXPECT_EQ(suggestion("wrad", models), " (did you mean 'ward'?)");
  const std::vector<std::string> known = {"a1", "b2"};
  EXPECT_EQ(suggestion("something", known), " (known: a1, b2)");
  EXPECT_EQ(suggestion("something", {}), "");
}

TEST(Suggestion, DoesNotListHundreds) {
  const std::vector<std::string> known(500, "material");
  EXPECT_THAT(suggestion("zzz", known), HasSubstr("and 460 more"));
}

} // namespace
} // namespace nacre
