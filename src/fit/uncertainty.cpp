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

Uncertainty estimate_uncertainty(const NoiseSums& sums, const std::vector<bool>& held) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> none(held.size(), nan);
  Uncertainty u{none,
                std::vector<double>(held.size() * held.size(), nan),
                none,
                none,
                std::vector<bool>(held.size(), true),
                std::vector<int>(held.size(), -1),
                std::vector<double>(held.size(), 0.0)};
  std::vector<Eigen::Index> columns; // those that move and matter
  for (std::size_t k = 0; k < held.size(); ++k) {
    if (held[k]) continue;
    const auto i = Eigen::Index(k);
    if (sums.bread(i, i) > 0)
      columns.push_back(i);
    else
      u.identifiable[k] = false;
  }
  const auto n = Eigen::Index(columns.size());
  if (n == 0 || Eigen::Index(sums.rows) <= n) return u;

  Eigen::VectorXd norm(n), noise(n), rounding(n);
  Eigen::MatrixXd H(n, n), M(n, n);
  for (Eigen::Index a = 0; a < n; ++a) {
    const Eigen::Index i = columns[std::size_t(a)];
    norm[a] = std::sqrt(sums.bread(i, i));
    noise[a] = sums.noise[i] / norm[a];
    rounding[a] = sums.rounding[i] / norm[a];
  }
  for (Eigen::Index a = 0; a < n; ++a)
    for (Eigen::Index b = 0; b < n; ++b) {
      H(a, b) = sums.bread(columns[std::size_t(a)], columns[std::size_t(b)]) / (norm[a] * norm[b]);
      M(a, b) = sums.meat(columns[std::size_t(a)], columns[std::size_t(b)]) / (norm[a] * norm[b]);
    }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(H);
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
  const double scale = 1.0 / double(Eigen::Index(sums.rows) - n), sigma2 = sums.squares * scale;
  const Eigen::MatrixXd robust = inverse * M * inverse * (double(sums.rows) * scale);
  const Eigen::VectorXd of_noise = inverse * noise, of_rounding = inverse * rounding;
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
    for (Eigen::Index j = 0; j < n; ++j)
      if (lost[j] < 0.01)
        u.covariance[out * held.size() + std::size_t(columns[std::size_t(j)])] =
            robust(k, j) / (norm[k] * norm[j]);
    u.uniform_noise_error[out] = std::sqrt(sigma2 * inverse(k, k)) / norm[k];
    u.shift[out] = (std::abs(of_noise[k]) + std::abs(of_rounding[k])) / norm[k];
  }
  return u;
}

Uncertainty estimate_uncertainty(std::span<const double> residuals, std::span<const double> jacobian,
                                 const std::vector<bool>& held) {
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto rows = Eigen::Index(residuals.size()), width = Eigen::Index(held.size());
  const Eigen::Map<const Matrix> J(jacobian.data(), rows, width);
  const Eigen::Map<const Eigen::VectorXd> r(residuals.data(), rows);
  const Eigen::MatrixXd weighted = J.array().colwise() * r.array();
  return estimate_uncertainty({J.transpose() * J, weighted.transpose() * weighted,
                               Eigen::VectorXd::Zero(width), Eigen::VectorXd::Zero(width), r.squaredNorm(),
                               residuals.size()},
                              held);
}

double simultaneous_quantile(double confidence, int count) {
  // Two-sided: P(|z| < q) = confidence^(1/count), by bisection of erf.
  const double each = std::pow(confidence, 1.0 / std::max(count, 1));
  double lo = 0, hi = 40;
  for (int i = 0; i < 80; ++i) {
    const double q = 0.5 * (lo + hi);
    (std::erf(q / std::sqrt(2.0)) < each ? lo : hi) = q;
  }
  return 0.5 * (lo + hi);
}

} // namespace nacre
