#pragma once
// The cost function of a fit: residuals with their exact Jacobian, filled by dual numbers over packs, and the
// sums over them that an optimiser asks for, which need no memory for the Jacobian.

#include "fit/layout.h"
#include "fit/metric.h"
#include "fit/observations.h"
#include "fit/robust_loss.h"

#include <Eigen/Core>
#include <ceres/cost_function.h>
#include <optional>

namespace nacre {

/// Cost, half the sum of rho of squared residuals, with its gradient g and Gauss and Newton's matrix, J^T W J
/// with W the slope of rho.
struct CostSlope {
  double cost = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd gauss_newton;
};

/// What error bars are made of, all per coordinate.
struct NoiseSums {
  Eigen::MatrixXd bread; ///< sum of psi' g g^T, g a row of the Jacobian; psi' = 1 for squares
  Eigen::MatrixXd meat;  ///< sum of psi^2 g g^T, psi = r for squares
  Eigen::VectorXd noise; ///< J^T b, b the mean of the residuals if all of them were noise of the measurement
  Eigen::VectorXd rounding; ///< J^T b, b the change of residuals when f grows by 1e-6
  double squares = 0;       ///< sum of r^2
  std::size_t rows = 0;
};

/// Residual (channel c, node n), at c count + n:
///   r = sqrt(w_n / (C sum w)) s (y(f_c cos theta_i) - y(f_measured,c cos theta_i)),
/// so that E of fit/metric.h over these nodes is sqrt(sum r^2). C is 3, or 1 if one channel is fitted alone:
/// then the others have no residuals. One parameter block: the layout's coordinates.
class Residuals final : public ceres::CostFunction {
public:
  /// Observations and layout outlive the function.
  /// @param channel  -1: all
  Residuals(const Observations& observations, Metric metric, const ParameterLayout& layout,
            RobustLoss loss = {}, int channel = -1);

  /// The residuals as they are, without the loss.
  /// @param jacobians  null, or one row-major matrix (or null), as Ceres asks
  /// @return false where a residual is not finite
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

  /// Half the sum of rho; infinite where a residual is not finite.
  double cost(std::span<const double> coordinates) const;
  /// @return false where a number is not finite
  bool slope(std::span<const double> coordinates, CostSlope& out) const;
  NoiseSums noise_sums(std::span<const double> coordinates) const;
  /// The cost that the rounding of single precision alone makes: below it nothing is left to gain.
  double rounding_cost() const { return rounding_cost_; }
  /// Median of the residuals' absolute values, without weights, in the metric's unit.
  double median_residual(std::span<const double> coordinates) const;

  const ParameterLayout& layout() const { return layout_; }
  const Observations& observations() const { return at_; }
  Metric metric() const { return metric_; }
  const RobustLoss& loss() const { return loss_; }
  void set_loss(const RobustLoss& loss) { loss_ = loss; }
  /// The channels that are fitted.
  std::span<const int> channels() const { return channels_; }
  /// sqrt(w_n / (C sum w)).
  std::span<const float> root_weight() const { return root_weight_; }
  /// A lobe that is 0 with all its derivatives at every node: a mirror, of which no table can tell anything.
  std::optional<int> invisible_lobe(const std::vector<double>& coordinates) const;

private:
  struct ChannelPlan;
  struct Block;
  ChannelPlan plan(const MaterialSpec& material, std::span<const double> coordinates, int channel) const;
  void fill(const ChannelPlan& plan, std::size_t begin, std::size_t n, bool with_jacobian,
            Block& block) const;
  /// Calls f(part, plan, block) for blocks of the channels, in parallel, and g(part) where parts are added up
  /// in order.
  template <class Partial, class F, class G>
  void sum_over_blocks(std::span<const double> coordinates, bool with_jacobian, F add, G gather) const;

  const Observations& at_;
  const Metric metric_;
  const ParameterLayout& layout_;
  RobustLoss loss_;
  std::vector<int> channels_;
  std::vector<float> root_weight_;
  double rounding_cost_ = 0;
};

} // namespace nacre
