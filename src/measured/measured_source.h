#pragma once
// The file that a measurement was read from: kept with it, so that Nacre's container can hold the file
// itself.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace nacre {

struct MeasuredSource {
  std::string path;
  std::string format;                      ///< a name of measured/formats.h
  std::uint64_t size = 0, fingerprint = 0; ///< of the bytes that were read

  static std::uint64_t fingerprint_of(std::span<const std::uint8_t> bytes);
  /// The bytes again. @throws Error if the file is gone or is another now
  std::vector<std::uint8_t> read_again() const;
};

} // namespace nacre
