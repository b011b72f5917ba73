#pragma once
// Damaged copies of a file: cut, lengthened, bits flipped, bytes lost, numbers and lines exchanged.

#include "core/error.h"
#include "core/random.h"
#include "measured/measured_bsdf.h"

#include <cmath>
#include <gtest/gtest.h>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

using Bytes = std::vector<std::uint8_t>;

inline Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

/// Copy number `n` of a file: one to four random edits, half of them within the first `header` bytes.
inline Bytes mutated(const Bytes& whole, std::uint64_t seed, std::size_t n, std::size_t header) {
  static const std::string_view tokens[] = {"nan",        "-1", "1e999", "inf", "0", "99999999999999999999",
                                            ",",          "\n", "360",   "",    "#", "-0.0",
                                            "4294967296", "TIS"};
  Bytes bytes = whole;
  auto random = [&, d = 0](std::size_t below) mutable { return hash(seed, n, d++) % below; };
  for (std::size_t edits = 1 + random(4); edits > 0 && !bytes.empty(); --edits) {
    const std::size_t within = random(2) == 0 ? std::min(bytes.size(), header) : bytes.size();
    const std::size_t at = random(within);
    switch (random(6)) {
    case 0:
      bytes.resize(at);
      break;
    case 1:
      bytes.resize(bytes.size() + random(64), 0xff);
      break;
    case 2:
      bytes[at] = std::uint8_t(random(256));
      break;
    case 3:
      bytes[at] ^= 1u << random(8);
      break;
    case 4: {
      const std::string_view token = tokens[random(std::size(tokens))];
      bytes.insert(bytes.begin() + std::ptrdiff_t(at), token.begin(), token.end());
      break;
    }
    default:
      bytes.erase(bytes.begin() + std::ptrdiff_t(at),
                  bytes.begin() +
                      std::ptrdiff_t(at + 1 + random(std::min<std::size_t>(bytes.size() - at, 9))));
    }
  }
  return bytes;
}

/// Copy number `n` of an HDF5 file, most of which is empty: one to three edits of what is not 0, structure
/// rather than padding; mostly numbers that are too large, rarely a cut.
inline Bytes mutated_hdf5(const Bytes& whole, std::uint64_t seed, std::size_t n) {
  Bytes bytes = whole;
  auto random = [&, d = 0](std::size_t below) mutable { return hash(seed, n, d++) % below; };
  for (std::size_t edits = 1 + random(3); edits > 0; --edits) {
    std::size_t at = random(bytes.size());
    for (int t = 0; t < 64 && bytes[at] == 0; ++t)
      at = random(bytes.size());
    switch (random(5)) {
    case 0:
      if (random(4) == 0) bytes.resize(at + 1);
      break;
    case 1:
      bytes[at] = std::uint8_t(random(256));
      break;
    case 2:
      bytes[at] = 0xff;
      break;
    case 3:
      for (std::size_t i = at; i < std::min(at + 8, bytes.size()); ++i)
        bytes[i] = random(2) ? std::uint8_t(0xff) : std::uint8_t(random(256));
      break;
    default:
      bytes[at] ^= std::uint8_t(1u << random(8));
    }
  }
  return bytes;
}

/// Every damaged copy is an error with a place, or a measurement whose values are finite.
template <class Parse>
void expect_measurement_or_error(const Bytes& whole, Parse parse, std::size_t copies, std::size_t header) {
  std::size_t read = 0, errors = 0;
  for (std::size_t n = 0; n < copies; ++n) {
    const Bytes bytes = mutated(whole, 7, n, header);
    try {
      const std::shared_ptr<const MeasuredBsdf> measured = parse(bytes);
      ++read;
      std::vector<float> f(std::size_t(measured->channels().count()));
      for (std::uint64_t k = 0; k < 4; ++k) {
        const auto direction = [&](std::uint64_t d) {
          const double z = 2 * unit_double(hash(n, k, d)) - 1, phi = 2 * pi * unit_double(hash(n, k, d + 1));
          const double r = std::sqrt(1 - z * z);
          return Vec3d{r * std::cos(phi), r * std::sin(phi), z};
        };
        measured->evaluate(direction(0), direction(2), f);
        for (const float x : f)
          ASSERT_TRUE(std::isfinite(x)) << "copy " << n;
      }
      for (const float x : measured->samples().f)
        ASSERT_TRUE(std::isfinite(x)) << "copy " << n;
    } catch (const Error& e) {
      ++errors;
      ASSERT_EQ(std::string_view(e.what()).substr(0, 6), "mutant") << e.what();
    }
  }
  EXPECT_GT(read, copies / 100); // both ways are taken
  EXPECT_GT(errors, copies / 100);
}

/// What a reader says of bytes, or "no error".
template <class Parse>
std::string message_of(Parse parse, const Bytes& bytes) {
  try {
    parse(bytes, "x");
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

} // namespace nacre
