#include "mutation.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <limits>
#include <string_view>

namespace nacre {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view tokens[] = {"-1"sv, "nan"sv, "1e999"sv, "-inf"sv, "99999999999"sv, "4294967295"sv,
                                       "0"sv,  "'"sv,   "\""sv,    "<"sv,    "/>"sv,          "</"sv,
                                       ","sv,  "\n"sv,  "#"sv,     "\0"sv,   "\xff\xfe"sv,    "1e-320"sv};

template <class T>
void overwrite(Bytes& bytes, std::size_t at, T value) {
  if (at + sizeof value <= bytes.size()) std::memcpy(&bytes[at], &value, sizeof value);
}

} // namespace

Bytes mutated(Bytes bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const std::size_t changes = 1 + below(4);
  for (std::size_t c = 0; c < changes && !bytes.empty(); ++c) {
    const std::size_t at = below(below(2) ? bytes.size() : std::min<std::size_t>(bytes.size(), 256));
    const auto here = bytes.begin() + std::ptrdiff_t(at);
    const std::size_t left = bytes.size() - at;
    switch (below(10)) {
    case 0:
      *here = std::uint8_t(below(256));
      break;
    case 1:
      *here = std::uint8_t(*here ^ (1u << below(8)));
      break;
    case 2:
      bytes.erase(here, here + std::ptrdiff_t(std::min(left, 1 + below(16))));
      break;
    case 3: { // a piece once more, or elsewhere
      const Bytes piece(here, here + std::ptrdiff_t(std::min(left, 1 + below(64))));
      const std::size_t to = below(2) ? at : below(bytes.size());
      bytes.insert(bytes.begin() + std::ptrdiff_t(to), piece.begin(), piece.end());
      break;
    }
    case 4: {
      const std::string_view token = tokens[below(std::size(tokens))];
      bytes.insert(here, token.begin(), token.end());
      break;
    }
    case 5: // the end is missing
      bytes.resize(at);
      break;
    case 6: {
      constexpr std::int32_t numbers[] = {0,
                                          1,
                                          -1,
                                          2,
                                          255,
                                          65536,
                                          1 << 24,
                                          1 << 30,
                                          std::numeric_limits<std::int32_t>::max(),
                                          std::numeric_limits<std::int32_t>::min()};
      overwrite(bytes, below(2) ? at / 4 * 4 : at, numbers[below(std::size(numbers))]);
      break;
    }
    case 7: {
      constexpr std::uint64_t numbers[] = {
          0, 1, 0xffffffffu, 0x100000000u, 1ull << 61, 1ull << 63, std::numeric_limits<std::uint64_t>::max()};
      overwrite(bytes, below(2) ? at / 8 * 8 : at, numbers[below(std::size(numbers))]);
      break;
    }
    case 8: {
      constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                       inf = std::numeric_limits<double>::infinity();
      constexpr double numbers[] = {nan, inf, -inf, -1, 1e308, 1e-320, 1e30};
      const double x = numbers[below(std::size(numbers))];
      if (below(2))
        overwrite(bytes, at, x);
      else
        overwrite(bytes, at / 4 * 4, float(x));
      break;
    }
    case 9: { // another number where one stands as text
      const auto digit = std::find_if(here, bytes.end(), [](std::uint8_t b) { return std::isdigit(b); });
      const auto end = std::find_if(digit, bytes.end(), [](std::uint8_t b) { return !std::isdigit(b); });
      if (digit == bytes.end()) break;
      const std::string_view token = tokens[below(7)];
      const auto gap = bytes.erase(digit, end);
      bytes.insert(gap, token.begin(), token.end());
      break;
    }
    }
  }
  return bytes;
}

} // namespace nacre
