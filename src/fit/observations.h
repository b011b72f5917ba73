#pragma once
// The nodes of a measured table as the fitter sees them: directions, values, weights.

#include "bsdf/model_functions.h"
#include "measured/merl_table.h"

#include <array>
#include <vector>

namespace nacre {

/// Which nodes of a table to look at.
struct NodeSelection {
  int theta_h_step = 1, theta_d_step = 1, phi_d_step = 1; ///< every n-th node of each angle, from the first
  double max_theta_deg = 80; ///< nodes with theta_i or theta_o beyond are left out
  /// Turn each pair of directions about the normal by another angle. The table does not see it; a model with
  /// a tangent does.
  bool turned = false;
};

/// Structure of arrays, padded with copies of the last node to whole packs.
struct Observations {
  std::size_t count = 0; ///< without the padding
  std::array<std::vector<float>, 3> wo, wi;
  std::array<std::vector<float>, 3> f; ///< measured, per channel
  std::vector<double> weight;          ///< as in fit/metric.h; not normalised

  DirectionArrays from(std::size_t i) const {
    return {{wo[0].data() + i, wo[1].data() + i, wo[2].data() + i},
            {wi[0].data() + i, wi[1].data() + i, wi[2].data() + i}};
  }
};

/// @throws Error for steps below 1 or a cut outside (0, 90]
Observations observe(const MerlTable& table, const NodeSelection& selection);
/// The nodes with one index in theta_h, a multiple of the step, alone.
Observations observe_slice(const MerlTable& table, const NodeSelection& selection, int theta_h_index);

} // namespace nacre
