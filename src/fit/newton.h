#pragma once
// The last steps of a fit: Newton's method inside bounds.
//
// Gauss and Newton's steps, which Ceres takes, leave out the curvature of the model. Where the model does not
// describe the material residuals stay large and that curvature counts: their steps then shrink by a tenth
// each instead of squaring, and zigzag along bounds. Here the Hessian is the differences of the exact
// gradient.
//
// Source: Bertsekas 1982, Projected Newton Methods for Optimization Problems with Simple Constraints,
// SIAM J. Control Optim. 20(2); negative curvature by its absolute value: Dauphin et al. 2014, Identifying
// and Attacking the Saddle Point Problem in High-Dimensional Non-Convex Optimization.

#include "fit/residuals.h"

namespace nacre {

struct NewtonResult {
  std::vector<double> coordinates;
  double cost = 0; ///< half the sum of squared residuals
  int iterations = 0;
  bool converged = false;
};

/// @param x                   where to begin, inside the bounds of the layout
/// @param relative_decrease   stop when a step promises to lower the cost by less than this share of it
NewtonResult newton_inside_bounds(const Residuals& residuals, std::vector<double> x, int max_iterations,
                                  double relative_decrease);

} // namespace nacre
