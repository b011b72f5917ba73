#pragma once
// Descent to an optimum inside bounds, from sums over the residuals alone.
//
// First Levenberg and Marquardt's method: steps of Gauss and Newton's matrix, damped; coordinates that a step
// would take out of their range stop at its end and the others take the step that is then best. Gauss and
// Newton's steps leave out the curvature of the model. Where the model does not describe the material
// residuals stay large and that curvature counts: their steps then shrink by a tenth each instead of
// squaring, and zigzag along bounds. So Newton's method takes the last steps, with a Hessian from differences
// of the exact gradient. Channels do not mix, so one difference serves a parameter of all three channels.
//
// Source: Marquardt 1963, An Algorithm for Least-Squares Estimation of Nonlinear Parameters; damping after
// Nielsen 1999, Damping Parameter in Marquardt's Method; bounds: Bertsekas 1982, Projected Newton Methods for
// Optimization Problems with Simple Constraints; negative curvature by its absolute value: Dauphin et al.
// 2014, Identifying and Attacking the Saddle Point Problem in High-Dimensional Non-Convex Optimization.

#include "fit/residuals.h"

#include <functional>

namespace nacre {

struct Minimum {
  std::vector<double> coordinates;
  double cost = 0; ///< infinite if the start had no finite value
  int iterations = 0;
  bool converged = false;
};

/// Told of each step that was taken: coordinates and cost. False ends the descent there.
using OnStep = std::function<bool(std::span<const double> x, double cost)>;

/// @param x                   where to begin, inside the bounds of the layout
/// @param relative_decrease   stop when a step lowers the cost by less than this share of it
Minimum levenberg_marquardt(const Residuals& residuals, std::vector<double> x, int max_iterations,
                            double relative_decrease, const OnStep& on_step = {});

/// @param curvature           gives the Hessian: the residuals, or the same over fewer nodes
/// @param relative_decrease   stop when a step promises to lower the cost by less than this share of it
Minimum newton(const Residuals& residuals, std::vector<double> x, int max_iterations,
               double relative_decrease, const Residuals& curvature, const OnStep& on_step = {});

/// Within a millionth of its range of an end of it.
bool at_bound(const FreeParameter& parameter, double coordinate);

} // namespace nacre
