#pragma once
// From one format of measurements to another, and what is lost on the way.

#include "measured/formats.h"

#include <string>
#include <vector>

namespace nacre {

/// The format to write to `path`: the one named, or the first that is written with that ending.
/// @throws UsageError naming what is written
const MeasuredFormat& format_to_write(const std::string& path, const std::string& name = "");

/// What differs between a measurement and what it became.
struct ConversionLoss {
  std::vector<std::string> changes; ///< in words: channels, isotropy, sides
  std::size_t pairs = 0;            ///< of directions, that both have a value for
  std::size_t lost = 0;             ///< pairs that are a hole now
  std::size_t gained = 0;           ///< pairs that have a value only now
  /// Sum over channels of |after - before| over half the sum of both: 0 the same, 2 nothing in common. In
  /// linear RGB unless both have the same channels.
  double mean = 0, worst = 0;
  Vec3d wo, wi; ///< of the worst
};

/// At random pairs of directions on the sides that `before` knows: half of them uniform over solid angle,
/// half over half and difference angles, with half vectors as dense about the normal as those of a MERL
/// table.
ConversionLoss conversion_loss(const MeasuredBsdf& before, const MeasuredBsdf& after, int pairs = 10000);

} // namespace nacre
