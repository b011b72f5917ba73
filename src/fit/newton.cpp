#include "fit/newton.h"

#include <Eigen/Dense>
#include <limits>

namespace nacre {
namespace {

using Vector = Eigen::VectorXd;

/// Cost and gradient, with room to compute them in.
class Slope {
public:
  explicit Slope(const Residuals& residuals)
      : residuals_(residuals), width_(residuals.layout().size()), r_(residuals.num_residuals()),
        jacobian_(residuals.num_residuals(), width_) {}

  /// @return false where a residual is not finite
  bool cost(const Vector& x, double& cost) {
    const double* parameters = x.data();
    if (!residuals_.Evaluate(&parameters, r_.data(), nullptr)) return false;
    cost = 0.5 * r_.squaredNorm();
    return std::isfinite(cost);
  }
  bool gradient(const Vector& x, double& cost, Vector& gradient) {
    const double* parameters = x.data();
    double* jacobian = jacobian_.data();
    if (!residuals_.Evaluate(&parameters, r_.data(), &jacobian)) return false;
    cost = 0.5 * r_.squaredNorm();
    gradient.noalias() = jacobian_.transpose() * r_;
    return std::isfinite(cost) && gradient.allFinite();
  }
  /// Lengths of the columns of the last Jacobian: how strongly each coordinate moves the residuals.
  Vector strength() const { return jacobian_.colwise().norm(); }

private:
  const Residuals& residuals_;
  int width_;
  Vector r_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian_;
};

/// Hessian over the coordinates in `free`, by forward differences that stay inside the bounds.
/// @param step  length of the difference, per coordinate
bool hessian(Slope& slope, const Vector& x, const Vector& g, const std::vector<int>& free, const Vector& step,
             const Vector& hi, Eigen::MatrixXd& H) {
  H.resize(Eigen::Index(free.size()), Eigen::Index(free.size()));
  Vector moved(x.size());
  for (std::size_t k = 0; k < free.size(); ++k) {
    Vector y = x;
    const int i = free[k];
    y[i] += x[i] + step[i] <= hi[i] ? step[i] : -step[i];
    double cost;
    if (!slope.gradient(y, cost, moved)) return false;
    for (std::size_t j = 0; j < free.size(); ++j)
      H(Eigen::Index(j), Eigen::Index(k)) = (moved[free[j]] - g[free[j]]) / (y[i] - x[i]);
  }
  H = (0.5 * (H + H.transpose())).eval();
  return true;
}

} // namespace

NewtonResult newton_inside_bounds(const Residuals& residuals, std::vector<double> start, int max_iterations,
                                  double relative_decrease) {
  constexpr double cost_rounding = 1e-7; // residuals are single precision
  const ParameterLayout& layout = residuals.layout();
  const int width = layout.size();
  Vector x = Eigen::Map<Vector>(start.data(), width), lo(width), hi(width), g(width);
  for (int i = 0; i < width; ++i) {
    lo[i] = layout[i].coordinate_lo();
    hi[i] = layout[i].coordinate_hi();
  }
  Slope slope(residuals);
  NewtonResult result{std::move(start), std::numeric_limits<double>::infinity(), 0, false};
  double cost;
  if (!slope.gradient(x, cost, g)) return result;
  for (; result.iterations < max_iterations; ++result.iterations) {
    const Vector strength = slope.strength();
    std::vector<int> free; // coordinates that are not pressed against a bound
    for (int i = 0; i < width; ++i)
      if (strength[i] > 0 && !(x[i] <= lo[i] && g[i] >= 0) && !(x[i] >= hi[i] && g[i] <= 0))
        free.push_back(i);
    result.converged = free.empty() || cost == 0;
    if (result.converged) break;

    // Differences that move the residuals by some thousandth of their size, where single precision still has
    // four digits.
    Vector step(width);
    for (int i = 0; i < width; ++i)
      step[i] = std::min(3e-3 * std::sqrt(2 * cost) / std::max(strength[i], 1e-300), 0.01 * (hi[i] - lo[i]));
    Eigen::MatrixXd H;
    if (!hessian(slope, x, g, free, step, hi, H)) break;
    const Eigen::Index n = Eigen::Index(free.size());
    Vector scale(n), g_free(n);
    for (Eigen::Index k = 0; k < n; ++k) {
      scale[k] = 1 / strength[free[std::size_t(k)]];
      g_free[k] = g[free[std::size_t(k)]] * scale[k];
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * H * scale.asDiagonal());
    const Vector curvature = eigen.eigenvalues().cwiseAbs().cwiseMax(1e-5);
    const Vector along = eigen.eigenvectors().transpose() * g_free;
    const Vector move = scale.asDiagonal() * (eigen.eigenvectors() * along.cwiseQuotient(curvature));
    const double promised = 0.5 * along.cwiseAbs2().cwiseQuotient(curvature).sum();

    const auto moved_by = [&](double t) {
      Vector y = x;
      for (Eigen::Index k = 0; k < n; ++k) {
        const int i = free[std::size_t(k)];
        const double most = 0.2 * (hi[i] - lo[i]);
        y[i] = std::clamp(x[i] - std::clamp(t * move[k], -most, most), lo[i], hi[i]);
      }
      return y;
    };
    if (promised < std::max(relative_decrease, 1e-12) * cost) {
      result.converged = true;
      break;
    }
    double next = 0, t = 1;
    Vector y = moved_by(t);
    // A step that promises less than the rounding of the cost cannot be judged by the cost: it is taken.
    const bool judged = promised > cost_rounding * cost;
    while (!(slope.cost(y, next) && (!judged || next < cost)) && t > 1e-3)
      y = moved_by(t *= 0.5);
    if (judged && !(next < cost)) break;
    x = y;
    if (!slope.gradient(x, cost, g)) break;
  }
  Eigen::Map<Vector>(result.coordinates.data(), width) = x;
  result.cost = cost;
  return result;
}

} // namespace nacre
