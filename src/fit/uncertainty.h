#pragma once
// Error bars of a least-squares fit from sums over its residuals and Jacobian at the optimum.

#include "fit/residuals.h"

#include <span>
#include <vector>

namespace nacre {

struct Uncertainty {
  /// Square roots of the diagonal of H^-1 M H^-1, H the sum of psi' g g^T, M that of psi^2 g g^T, g a row of
  /// the Jacobian (for squares psi = r, psi' = 1): the covariance that stays right where the noise is larger
  /// at some nodes than at others (White 1980, A Heteroskedasticity-Consistent Covariance Matrix Estimator,
  /// times n / (n - p)) and of robust losses (Huber 1967). NaN where there is none.
  std::vector<double> standard_error;
  /// That covariance, row-major, a row and column a parameter. NaN where there is none.
  std::vector<double> covariance;
  /// Square roots of the diagonal of sigma^2 (J^T J)^-1, sigma^2 = sum r^2 / (n - p): right only if every
  /// weighted residual has the same variance.
  std::vector<double> uniform_noise_error;
  /// How far noise may have shifted the estimate itself: the mean of a compressed noisy value is not the
  /// compressed mean. As large as it would be if all residuals were noise, plus the rounding of single
  /// precision. NaN where there is no error bar.
  std::vector<double> shift;
  /// False for a parameter that the data do not determine: nothing depends on it, or a change of it is undone
  /// by a change of others.
  std::vector<bool> identifiable;
  /// For each, the parameter that moves most with it: of an unidentifiable one the one it trades off against.
  /// -1: none.
  std::vector<int> partner;
  /// Correlation with the partner, in [-1, 1].
  std::vector<double> correlation;
};

/// @param held  parameters that stay where they are, because they sit at a bound: no error bar
Uncertainty estimate_uncertainty(const NoiseSums& sums, const std::vector<bool>& held);
/// The same from residuals and Jacobian themselves, of squares; without shifts.
/// @param jacobian  row-major, residuals.size() x held.size()
Uncertainty estimate_uncertainty(std::span<const double> residuals, std::span<const double> jacobian,
                                 const std::vector<bool>& held);

/// Half the width, in standard errors, of intervals that hold `count` normal numbers all at once with this
/// probability (Sidak 1967, Rectangular Confidence Regions).
double simultaneous_quantile(double confidence, int count);

} // namespace nacre
