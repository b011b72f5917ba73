#pragma once
// Checks of the numbers of a command line.

#include <CLI/CLI.hpp>

#include <cstdint>
#include <limits>

namespace nacre {

/// An option's value must be a finite number in [lo, hi]. (CLI::Range lets NaN pass.)
CLI::Validator number_in(double lo, double hi);

/// An option's value must be a whole number in [lo, hi], in decimal digits alone: CLI11 would read 010 as 8
/// and a negative seed as a huge one.
CLI::Validator whole_number_in(std::uint64_t lo, std::uint64_t hi);

/// What a seed may be.
inline CLI::Validator any_whole_number() {
  return whole_number_in(0, std::numeric_limits<std::uint64_t>::max());
}

} // namespace nacre
