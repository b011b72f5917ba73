#include "measured/measured_source.h"

#include "core/error.h"
#include "core/file.h"
#include "core/random.h"
#include "measured/formats.h"

#include <algorithm>
#include <cstring>

namespace nacre {

std::uint64_t MeasuredSource::fingerprint_of(std::span<const std::uint8_t> bytes) {
  std::uint64_t state = bytes.size();
  for (std::size_t at = 0; at < bytes.size(); at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, std::min<std::size_t>(8, bytes.size() - at));
    state = hash_step(state, word);
  }
  return state;
}

std::vector<std::uint8_t> MeasuredSource::read_again() const {
  std::vector<std::uint8_t> bytes;
  for (const MeasuredFormat& f : measured_formats())
    if (f.name == format) bytes = f.read ? f.read(path) : read_file(path);
  if (bytes.size() != size || fingerprint_of(bytes) != fingerprint)
    throw Error::in_file(path, "has changed since it was read");
  return bytes;
}

} // namespace nacre
