#pragma once
// Error bars of a least-squares fit from its residuals and Jacobian at the optimum.

#include <span>
#include <vector>

namespace nacre {

struct Uncertainty {
  /// Square roots of the diagonal of (J^T J)^-1 (sum of r^2 g g^T) (J^T J)^-1, g a row of J: the covariance
  /// that stays right where the noise is larger at some nodes than at others (White 1980, A
  /// Heteroskedasticity- Consistent Covariance Matrix Estimator, times n / (n - p)). NaN where there is none.
  std::vector<double> standard_error;
  /// Square roots of the diagonal of sigma^2 (J^T J)^-1, sigma^2 = sum r^2 / (n - p): right only if every
  /// weighted residual has the same variance.
  std::vector<double> uniform_noise_error;
  /// False for a parameter that the data do not determine: nothing depends on it, or a change of it is undone
  /// by a change of others.
  std::vector<bool> identifiable;
  /// For each, the parameter that moves most with it: of an unidentifiable one the one it trades off against.
  /// -1: none.
  std::vector<int> partner;
  /// Correlation with the partner, in [-1, 1].
  std::vector<double> correlation;
};

/// @param jacobian  row-major, residuals.size() x held.size()
/// @param held      parameters that stay where they are, because they sit at a bound: no error bar
Uncertainty estimate_uncertainty(std::span<const double> residuals, std::span<const double> jacobian,
                                 const std::vector<bool>& held);

} // namespace nacre
