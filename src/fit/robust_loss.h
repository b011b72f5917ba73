#pragma once
// Losses that let outliers pull less than their square: rho(s) of s = (residual / scale)^2, with rho(s) = s
// for small s; the cost of a residual is scale^2 rho(s) / 2. Source: Huber 1964, Robust Estimation of a
// Location Parameter; Triggs et al. 1999, Bundle Adjustment: A Modern Synthesis, section 3; the forms are
// those of Ceres.

#include <cmath>
#include <string_view>

namespace nacre {

enum class LossKind { squares, huber, soft_l1, cauchy };

std::string_view loss_name(LossKind kind);
/// @throws Error that suggests the nearest name
LossKind parse_loss(std::string_view name);

struct RobustLoss {
  LossKind kind = LossKind::squares;
  /// Residual of a node in the metric's unit, before weighting, from which on it counts less. 0: thrice the
  /// median of the absolute residuals of the squares' optimum.
  double scale = 0;

  /// rho and its first two derivatives by s.
  struct Value {
    double rho, slope, curvature;
  };
  Value at(double s) const {
    switch (kind) {
    case LossKind::huber: {
      if (s <= 1) return {s, 1, 0};
      const double root = std::sqrt(s);
      return {2 * root - 1, 1 / root, -0.5 / (s * root)};
    }
    case LossKind::soft_l1: {
      const double root = std::sqrt(1 + s);
      return {2 * (root - 1), 1 / root, -0.5 / ((1 + s) * root)};
    }
    case LossKind::cauchy:
      return {std::log1p(s), 1 / (1 + s), -1 / ((1 + s) * (1 + s))};
    case LossKind::squares:
      break;
    }
    return {s, 1, 0};
  }
};

} // namespace nacre
