#pragma once
// What can be seen of any measurement from outside: where it has values, their range, how reciprocal it is.

#include "measured/measured_bsdf.h"

#include <string_view>

namespace nacre {

/// One of the four pairs of sides.
struct SidePair {
  std::string_view name; ///< "reflection, front"
  bool wo_front, wi_front;
};
/// Those that a measurement knows.
std::vector<SidePair> side_pairs(const MeasuredSides& sides);

/// Where a pair of sides has values: bins of 5 degrees, theta_o by theta_i from the normal of their side,
/// seen at the middle of the bin and at 36 differences of azimuth (of anisotropic data at 8 azimuths of wo
/// too).
struct CoverageMap {
  static constexpr int bins = 18;
  SidePair sides;
  std::array<std::array<double, bins>, bins> share{}; ///< [theta_o][theta_i], in [0, 1]
  double whole = 0; ///< mean of the shares, weighted by the pairs of directions that a bin holds
};
std::vector<CoverageMap> coverage(const MeasuredBsdf& measured);

/// Range of the samples of a channel.
struct ChannelRange {
  double lo = 0, hi = 0, mean = 0;
};
struct SampleStatistics {
  std::size_t count = 0;
  std::vector<ChannelRange> channels; ///< empty if there are no samples
};
SampleStatistics sample_statistics(const MeasuredBsdf& measured);

/// |f(wo, wi) - f(wi, wo)| over the mean of the two, f the mean of the channels, at random pairs of
/// directions uniform over solid angle where both are measured and not both 0; at most 2. Light that goes
/// through is taken to have the same medium on both sides.
struct ReciprocityError {
  std::size_t pairs = 0; ///< that could be compared
  double mean = 0, worst = 0;
  Vec3d wo, wi; ///< of the worst
};
ReciprocityError reciprocity_error(const MeasuredBsdf& measured, int pairs = 20000);

} // namespace nacre
