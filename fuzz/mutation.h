#pragma once
// Inputs that are nearly right: a few changes to a file that is.

#include <cstdint>
#include <random>
#include <vector>

namespace nacre {

using Bytes = std::vector<std::uint8_t>;

/// One to four changes: bytes and bits, pieces removed, repeated and moved, numbers that overflow or are
/// none, the end cut off. Half of them fall into the first 256 bytes, where headers are.
Bytes mutated(Bytes bytes, std::mt19937& random);

} // namespace nacre
