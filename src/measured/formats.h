#pragma once
// The closed list of measured formats that Nacre reads and writes. Adding one is a pair of files in
// measured/formats and one entry in formats.cpp.

#include "measured/measured_bsdf.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace nacre {

struct MeasuredFormat {
  std::string_view name;                 ///< "merl"
  std::string_view description;          ///< "isotropic RGB table (Matusik et al. 2003)"
  std::vector<std::string_view> endings; ///< lower case with the dot, the one to write first
  /// Whether the bytes look like this format; asked where several formats share an ending. Reads no further
  /// than the bytes there are.
  bool (*recognises)(std::span<const std::uint8_t> bytes);
  /// @param name  of the file, for messages. @throws Error with the place. Null: not read.
  std::shared_ptr<const MeasuredBsdf> (*parse)(std::span<const std::uint8_t> bytes, std::string_view name);
  /// The bytes of a file of this format; what it cannot hold is resampled by `evaluate` and said in the docs.
  /// @throws Error where the format cannot hold such data at all. Null: not written.
  std::vector<std::uint8_t> (*encode)(const MeasuredBsdf& measured);
  /// The bytes to parse where a measurement may lie in several files beside each other; null: read_file.
  std::vector<std::uint8_t> (*read)(const std::string& path) = nullptr;
};

const std::vector<MeasuredFormat>& measured_formats();

} // namespace nacre
