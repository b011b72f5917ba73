#include "fit/uncertainty.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace nacre {
namespace {

/// Eigenvalues of the Gram matrix of unit columns below this mean that columns are the same but for the
/// rounding of single precision, in which derivatives are computed.
constexpr double singular = 1e-7;

} // namespace

Uncertainty estimate_uncertainty(std::span<const double> residuals, std::span<const double> jacobian,
                                 const std::vector<bool>& held) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Index rows = Eigen::Index(residuals.size()), width = Eigen::Index(held.size());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Uncertainty u{std::vector<double>(held.size(), nan), std::vector<double>(held.size(), nan),
                std::vector<bool>(held.size(), true), std::vector<int>(held.size(), -1),
                std::vector<double>(held.size(), 0.0)};
  const Eigen::Map<const Matrix> full(jacobian.data(), rows, width);
  const Eigen::Map<const Eigen::VectorXd> r(residuals.data(), rows);

  std::vector<Eigen::Index> columns; // those that move and matter
  for (Eigen::Index k = 0; k < width; ++k) {
    if (held[std::size_t(k)]) continue;
    if (full.col(k).norm() > 0)
      columns.push_back(k);
    else
      u.identifiable[std::size_t(k)] = false;
  }
  const Eigen::Index n = Eigen::Index(columns.size());
  if (n == 0 || rows <= n) return u;

  Eigen::MatrixXd J(rows, n);
  Eigen::VectorXd norm(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    norm[k] = full.col(columns[std::size_t(k)]).norm();
    J.col(k) = full.col(columns[std::size_t(k)]) / norm[k];
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(J.transpose() * J);
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd lost =
      Eigen::VectorXd::Zero(n); // share of each parameter in directions that are undetermined
  Eigen::MatrixXd trade = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::VectorXd v = eigen.eigenvectors().col(k);
    if (eigen.eigenvalues()[k] > singular) {
      inverse += v * v.transpose() / eigen.eigenvalues()[k];
    } else {
      lost += v.cwiseAbs2();
      trade += v * v.transpose();
    }
  }
  const double scale = 1.0 / double(rows - n), sigma2 = r.squaredNorm() * scale;
  const Eigen::MatrixXd weighted = J.array().colwise() * r.array();
  const Eigen::MatrixXd robust =
      inverse * (weighted.transpose() * weighted) * inverse * (double(rows) * scale);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::size_t out = std::size_t(columns[std::size_t(k)]);
    // An eigenvector of a pair that trades off holds half of each; 0.01 is one part in ten of a direction.
    u.identifiable[out] = lost[k] < 0.01;
    Eigen::Index best = -1;
    double most = 0;
    for (Eigen::Index j = 0; j < n; ++j) {
      const Eigen::MatrixXd& moves = u.identifiable[out] ? inverse : trade;
      const double size = std::sqrt(moves(k, k) * moves(j, j));
      const double correlation = j == k || !(size > 0) ? 0 : moves(k, j) / size;
      // Among parameters lost together all correlations are 1: the one with the larger share counts.
      const double rank = u.identifiable[out] ? std::abs(correlation) : std::abs(moves(k, j)) * (j != k);
      if (rank > most) {
        most = rank;
        best = j;
        u.correlation[out] = correlation;
      }
    }
    if (best >= 0) u.partner[out] = int(columns[std::size_t(best)]);
    if (!u.identifiable[out]) continue;
    u.standard_error[out] = std::sqrt(robust(k, k)) / norm[k];
    u.uniform_noise_error[out] = std::sqrt(sigma2 * inverse(k, k)) / norm[k];
  }
  return u;
}

} // namespace nacre
