#pragma once
// What was measured as the fitter sees it: directions, values, weights.

#include "bsdf/model_functions.h"
#include "measured/measured_bsdf.h"

#include <array>
#include <vector>

namespace nacre {

/// Which nodes of a table, or which samples of another measurement, to look at.
struct NodeSelection {
  int theta_h_step = 1, theta_d_step = 1, phi_d_step = 1; ///< every n-th node of each angle, from the first
  int sample_step = 1;       ///< of what is not a MERL table: every n-th of its samples
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

/// Reflection on the front in linear RGB. @throws Error for steps below 1 or a cut outside (0, 90]
Observations observe(const MeasuredBsdf& measured, const NodeSelection& selection);
} // namespace nacre
