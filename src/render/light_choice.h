#pragma once
// Which light to ask at a point.

#include "core/distribution.h"
#include "core/vec.h"

#include <optional>
#include <vector>

namespace nacre {

/// What the choice knows of a light.
struct LightSummary {
  double power = 0; ///< an estimate, finite
  bool is_far = false;
  Vec3f center{0, 0, 0}; ///< of a sphere about a light that is not far
  float radius = 0;
};

/// Chooses one of several lights. Far lights have a fixed probability, the mean of their share of the power
/// and of the number of lights. What is left is for the near ones, half of it in equal parts, half in
/// proportion to power / (distance^2 + radius^2), so that a lamp that lights a corner is asked in that
/// corner. With more than 64 near lights distance no longer counts, as the sum over them would cost more than
/// it saves.
class LightChoice {
public:
  LightChoice() = default; ///< of no light
  /// @throws Error if the power is not finite
  explicit LightChoice(std::vector<LightSummary> lights);
  bool empty() const { return lights_.empty(); }
  /// Index of the light for the point `p`; u in [0, 1).
  int sample(const Vec3f& p, float u) const;
  /// With which `sample` chooses that light at `p`.
  float probability(int light, const Vec3f& p) const;
  /// The same for a far light, for which no point matters.
  float far_probability(int light) const;

private:
  float nearness(const LightSummary& light, const Vec3f& p) const;

  std::vector<LightSummary> lights_;    ///< with their share of the power
  std::optional<Distribution1D> fixed_; ///< the choice when distance does not count
  std::vector<int> near_;               ///< indices, if distance counts
  float near_share_ = 0;                ///< probability of all of them
};

} // namespace nacre
