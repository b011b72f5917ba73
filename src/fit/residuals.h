#pragma once
// The cost function of a fit: residuals and their exact Jacobian, filled by dual numbers over packs.

#include "fit/layout.h"
#include "fit/metric.h"
#include "fit/observations.h"

#include <ceres/cost_function.h>
#include <optional>

namespace nacre {

/// Residual (channel c, node n), at c count + n:
///   r = sqrt(w_n / (3 sum w)) (y(f_c cos theta_i) - y(f_measured,c cos theta_i)),
/// so that E of fit/metric.h over these nodes is sqrt(sum r^2). One parameter block: the layout's
/// coordinates.
class Residuals final : public ceres::CostFunction {
public:
  /// All three outlive the function.
  Residuals(const Observations& observations, Metric metric, const ParameterLayout& layout);

  /// @param jacobians  null, or one row-major matrix (or null), as Ceres asks
  /// @return false where a residual is not finite
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

  const ParameterLayout& layout() const { return layout_; }
  /// A lobe that is 0 with all its derivatives at every node: a mirror, of which no table can tell anything.
  std::optional<int> invisible_lobe(const std::vector<double>& coordinates) const;

private:
  void evaluate_block(const MaterialSpec& material, const double* coordinates, int channel, std::size_t begin,
                      std::size_t n, double* residuals, double* jacobian) const;

  const Observations& at_;
  const Metric metric_;
  const ParameterLayout& layout_;
  std::vector<double> root_weight_;
  std::array<std::vector<double>, 3> compressed_; ///< y(f_measured cos theta_i)
};

} // namespace nacre
