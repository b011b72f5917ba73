#include "core/error.h"
#include "explorer/protocol.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace nacre {
namespace {

std::string error_of(std::string_view text) {
  try {
    decode_request(text);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(ExplorerProtocol, RequestHasIdTypeAndSlot) {
  const Request r = decode_request(R"({"id": 7, "type": "curves", "slot": "a", "points": 3})");
  EXPECT_EQ(r.id, 7);
  EXPECT_EQ(r.type, "curves");
  EXPECT_EQ(r.slot, "a");
  EXPECT_EQ(r.body["points"], 3);
}

TEST(ExplorerProtocol, MalformedRequestsAreErrorsThatSayWhatIsWrong) {
  EXPECT_NE(error_of("").find("JSON"), std::string::npos);
  EXPECT_NE(error_of(R"({"id": 1, "type": )").find("byte 19"), std::string::npos)
      << error_of(R"({"id": 1, "type": )");
  EXPECT_NE(error_of("[1]").find("object"), std::string::npos);
  EXPECT_NE(error_of(R"({"type": "hello"})").find("\"id\""), std::string::npos);
  EXPECT_NE(error_of(R"({"id": -1, "type": "hello"})").find("\"id\""), std::string::npos);
  EXPECT_NE(error_of(R"({"id": 1.5, "type": "hello"})").find("\"id\""), std::string::npos);
  EXPECT_NE(error_of(R"({"id": 1, "type": 2})").find("\"type\""), std::string::npos);
  EXPECT_NE(error_of(R"({"id": 1, "type": "a", "slot": 2})").find("\"slot\""), std::string::npos);
  EXPECT_NE(error_of("\xff\xfe{}").find("JSON"), std::string::npos);
}

TEST(ExplorerProtocol, DeepNestingIsRefusedBeforeItReachesTheParser) {
  const std::string deep = R"({"id": 1, "type": )" + std::string(10'000'000, '[');
  EXPECT_NE(error_of(deep).find("nested"), std::string::npos);
  EXPECT_EQ(id_of_malformed(deep), -1);
  // Brackets inside a text are no nesting.
  EXPECT_EQ(
      error_of(
          R"({"id": 1, "type": "x", "text": "\"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[["})"),
      "");
}

TEST(ExplorerProtocol, IdOfAMalformedRequestIsGivenBackWhereThereIsOne) {
  EXPECT_EQ(id_of_malformed(R"({"id": 12, "type": 5})"), 12);
  EXPECT_EQ(id_of_malformed(R"({"id": 12)"), -1);
}

TEST(ExplorerProtocol, ArraysComeBackBitForBit) {
  Answer answer;
  answer.header["name"] = "ä"; // lengths are of bytes
  const float nan = std::numeric_limits<float>::quiet_NaN();
  answer.add("x", {3}, {1, nan, -0.0f});
  answer.add("y", {2, 1, 2}, {4, 5, 6, std::numeric_limits<float>::infinity()});
  answer.add("none", {0, 3}, {});
  const Message m = encode(9, answer);
  ASSERT_TRUE(m.is_binary);
  EXPECT_EQ(m.bytes.size() % 4, 0u);
  const DecodedAnswer d = decode_answer(m);
  EXPECT_EQ(d.header["id"], 9);
  EXPECT_EQ(d.header["ok"], true);
  EXPECT_EQ(d.header["name"], "ä");
  ASSERT_EQ(d.arrays.size(), 3u);
  EXPECT_EQ(d.arrays[0].data[0], 1);
  EXPECT_TRUE(std::isnan(d.arrays[0].data[1]));
  EXPECT_TRUE(std::signbit(d.arrays[0].data[2]));
  EXPECT_EQ(d.arrays[1].shape, (std::vector<std::size_t>{2, 1, 2}));
  EXPECT_EQ(d.arrays[1].data, answer.arrays[1].data);
  EXPECT_TRUE(d.arrays[2].data.empty());
}

TEST(ExplorerProtocol, AnswersWithoutArraysAreText) {
  const Message m = encode(3, {});
  EXPECT_FALSE(m.is_binary);
  EXPECT_EQ(decode_answer(m).header, nlohmann::json({{"id", 3}, {"ok", true}}));
}

TEST(ExplorerProtocol, TruncatedBinaryAnswersAreErrors) {
  Answer answer;
  answer.add("x", {3}, {1, 2, 3});
  const Message whole = encode(1, answer);
  for (std::size_t n = 0; n < whole.bytes.size(); ++n)
    EXPECT_ANY_THROW(decode_answer({true, whole.bytes.substr(0, n)})) << n;
}

TEST(ExplorerProtocol, PlacesInErrorsAreFieldsOfTheirOwn) {
  const auto error = [](const char* text) {
    return nlohmann::json::parse(encode_error(4, text).bytes)["error"];
  };
  EXPECT_EQ(error("a.brdf:12:3: no ';'"),
            nlohmann::json({{"message", "a.brdf:12:3: no ';'"}, {"line", 12}, {"column", 3}}));
  EXPECT_EQ(error("a.brdf:12: no ';'")["line"], 12);
  EXPECT_FALSE(error("a.brdf:12: no ';'").contains("column"));
  EXPECT_FALSE(error("lambert: no parameter 'x'").contains("line"));
  EXPECT_FALSE(nlohmann::json::parse(encode_error(-1, "x").bytes).contains("id"));
  // What is cut loses neither its place nor its end.
  const std::string long_name(100000, 'n');
  const auto cut = error((long_name + ".brdf:12:3: no 'x'\x1b").c_str());
  EXPECT_EQ(cut["line"], 12);
  EXPECT_LT(cut["message"].get<std::string>().size(), 160u);
  EXPECT_TRUE(cut["message"].get<std::string>().ends_with(".brdf:12:3: no 'x'\\x1B")) << cut;
  std::string words;
  for (int i = 0; i < 10000; ++i)
    words += "word ";
  EXPECT_LT(error(words.c_str())["message"].get<std::string>().size(), 2100u);
}

} // namespace
} // namespace nacre
