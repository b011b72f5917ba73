#include "core/error.h"
#include "core/random.h"
#include "measured/tensor_file.h"

#include <cstring>
#include <gmock/gmock.h>
#include <limits>
#include <vector>

namespace nacre {
namespace {

using testing::HasSubstr;

const std::vector<float> numbers{1, -2, 3.5f, 0, 1e-30f, 6};

std::vector<std::uint8_t> small_file() {
  const std::vector<Tensor> fields{tensor("description", "a test"), tensor("grid", {2, 3}, numbers),
                                   tensor("empty", {0, 9}, std::span<const float>())};
  return encode_tensor_file(fields);
}
std::string message_of(std::span<const std::uint8_t> bytes) {
  try {
    TensorFile::parse(bytes, "x.bsdf");
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}
template <class T>
std::vector<std::uint8_t> with(std::vector<std::uint8_t> bytes, std::size_t at, T x) {
  std::memcpy(&bytes.at(at), &x, sizeof x);
  return bytes;
}

TEST(TensorFile, IsLaidOutByteForByteAsItsPublicReadersExpect) {
  // One uint8 field 'ab' of shape 3: header 12 + 2 + 4, declaration 2 + 2 + 2 + 1 + 8 + 8 = 23, padded to 48.
  const std::vector<std::uint8_t> data{7, 8, 9};
  const std::vector<Tensor> fields{tensor("ab", {3}, std::span<const std::uint8_t>(data))};
  std::vector<std::uint8_t> expected{'t', 'e', 'n', 's', 'o', 'r', '_', 'f', 'i',
                                     'l', 'e', 0,   1,   0,   1,   0,   0,   0};
  for (const int b : {2, 0, int('a'), int('b'), 1, 0, 1, 48, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0})
    expected.push_back(std::uint8_t(b));
  expected.resize(48);
  expected.insert(expected.end(), data.begin(), data.end());
  EXPECT_EQ(encode_tensor_file(fields), expected);
}

TEST(TensorFile, WhatIsWrittenIsReadBack) {
  const auto bytes = small_file();
  const TensorFile file = TensorFile::parse(bytes, "x");
  EXPECT_EQ(file.fields().size(), 3u);
  EXPECT_EQ(file.floats("grid", 2), numbers);
  EXPECT_TRUE(file.floats("empty", 2).empty());
  const Tensor& text = file.field("description", TensorType::uint8, 1);
  EXPECT_EQ(std::string(text.bytes.begin(), text.bytes.end()), "a test");
  EXPECT_EQ(file.field("grid", TensorType::float32, 2).offset % 8, 0u);
}

TEST(TensorFile, AnUnfitFieldIsNamedWithWhatWasFound) {
  const auto bytes = small_file();
  const TensorFile file = TensorFile::parse(bytes, "x.bsdf");
  const auto message = [&](auto ask) -> std::string {
    try {
      ask();
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(message([&] { file.floats("gird", 2); }), HasSubstr("did you mean 'grid'"));
  EXPECT_THAT(message([&] { file.floats("grid", 3); }), HasSubstr("float32 of shape 2 x 3"));
  EXPECT_THAT(message([&] { file.floats("description", 1); }), HasSubstr("found uint8 of shape 6"));
  const std::size_t at = file.find("grid")->offset + 8;
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    const auto broken = with(bytes, at, bad);
    const TensorFile f = TensorFile::parse(broken, "x.bsdf");
    EXPECT_THAT(message([&] { f.floats("grid", 2); }), HasSubstr("byte " + std::to_string(at)));
    EXPECT_EQ(message([&] { f.floats("grid", 2, true); }) == "no error", std::isnan(bad));
  }
}

TEST(TensorFile, SizesThatOverflowOrReachPastTheEndAreErrorsWithTheirPlace) {
  const auto bytes = small_file();
  const TensorFile file = TensorFile::parse(bytes, "x");
  const std::size_t grid = file.find("grid")->header_offset;
  const std::size_t type = grid + 2 + 4 + 2, offset = type + 1, size = offset + 8;
  const std::string place = "byte " + std::to_string(grid);
  const auto huge = std::uint64_t(1) << 62;
  EXPECT_THAT(message_of(with(bytes, size, huge)),
              testing::AllOf(HasSubstr(place), HasSubstr("does not fit")));
  EXPECT_THAT(message_of(with(with(bytes, size, huge), size + 8, huge)), HasSubstr("does not fit"));
  // 2^32 x 2^30 x 4 bytes is 2^64, which is 0 if it wraps.
  EXPECT_THAT(message_of(with(with(bytes, size, std::uint64_t(1) << 32), size + 8, std::uint64_t(1) << 30)),
              HasSubstr("does not fit"));
  EXPECT_THAT(message_of(with(bytes, offset, ~std::uint64_t(0) - 7)), HasSubstr("does not fit"));
  EXPECT_THAT(message_of(with(bytes, offset, std::uint64_t(bytes.size() - 8))), HasSubstr("does not fit"));
  EXPECT_THAT(message_of(with(bytes, offset, std::uint64_t(4))), HasSubstr("lies in the header"));
  EXPECT_THAT(message_of(with(bytes, offset, file.find("description")->offset)), HasSubstr("overlaps"));
  EXPECT_THAT(message_of(with(bytes, type, std::uint8_t(0))), HasSubstr("type 0"));
  EXPECT_THAT(message_of(with(bytes, type, std::uint8_t(12))), HasSubstr("type 12"));
  EXPECT_THAT(message_of(with(bytes, type - 2, std::uint16_t(60000))), HasSubstr("60000 dimensions"));
  EXPECT_THAT(message_of(with(bytes, 14, ~std::uint32_t(0))), HasSubstr("byte 14"));
  EXPECT_THAT(message_of(with(bytes, 12, std::uint8_t(9))), HasSubstr("version 9.0"));
  EXPECT_THAT(message_of(with(bytes, 0, 'T')), HasSubstr("expected a tensor file"));
}

TEST(TensorFile, EveryTruncationIsAnErrorAndNoFlippedBitDoesHarm) {
  const auto bytes = small_file();
  // What is left out at the end is the data of the last array that has any.
  const std::size_t end = TensorFile::parse(bytes, "x").find("grid")->offset + numbers.size() * 4;
  for (std::size_t n = 0; n < end; ++n)
    EXPECT_THAT(message_of(std::span(bytes).first(n)), testing::StartsWith("x.bsdf: byte ")) << n;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    auto broken = bytes;
    broken[bit / 8] ^= std::uint8_t(1u << (bit % 8));
    const std::string message = message_of(broken);
    EXPECT_TRUE(message == "no error" || message.rfind("x.bsdf: byte ", 0) == 0) << message;
  }
  for (int i = 0; i < 20000; ++i) { // and several bytes at once, of the header mostly
    auto broken = bytes;
    for (int k = 0; k < 4; ++k)
      broken[12 + hash(5, i, 2 * k) % (bytes.size() - 12)] = std::uint8_t(hash(5, i, 2 * k + 1));
    message_of(broken);
  }
}

TEST(TensorFile, WritingRefusesWhatNoReaderWouldRead) {
  std::vector<Tensor> twice{tensor("a", {6}, numbers), tensor("a", {6}, numbers)};
  EXPECT_THROW(encode_tensor_file(twice), Error);
  std::vector<Tensor> wrong{tensor("a", {5}, numbers)};
  EXPECT_THROW(encode_tensor_file(wrong), Error);
}

} // namespace
} // namespace nacre
