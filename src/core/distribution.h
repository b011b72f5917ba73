#pragma once
// Sampling in proportion to tabulated values, on a line and on a lat-long image.

#include "core/vec.h"

#include <span>
#include <vector>

namespace nacre {

/// Piecewise-constant density over [0, 1) in n equal cells. The cumulative table holds multiples of 2^-24,
/// the grid of the samplers' numbers, and every cell of positive value has at least one of them: such a cell
/// can always be sampled, a cell of value 0 never is, and `pdf` is exactly the density of what `sample`
/// returns: value / integral
/// but for the rounding to that grid.
class Distribution1D {
public:
  struct Sample {
    float x;   ///< in [0, 1), within cell `index`
    float pdf; ///< density at x, > 0
    int index;
  };

  /// All values zero gives the uniform density.
  /// @throws Error if there are none or over 2^22 of them, or one is negative, NaN or infinite
  explicit Distribution1D(std::span<const float> values);
  explicit Distribution1D(std::span<const double> values);

  /// Inverse of the cumulative distribution. @param u in [0, 1]; 1 is taken as the largest float below
  Sample sample(float u) const;
  /// Density at x in [0, 1], 0 outside.
  float pdf(float x) const;
  /// Probability of a cell.
  float probability(int index) const { return cumulative_[index + 1] - cumulative_[index]; }
  int size() const { return static_cast<int>(cumulative_.size()) - 1; }
  /// Integral of the given values over [0, 1), their mean.
  double integral() const { return integral_; }

private:
  std::vector<float> cumulative_;
  double integral_ = 0;
};

/// Piecewise-constant density over the unit square in width x height equal cells: a row is chosen by its sum,
/// then a cell of that row. For a lat-long image multiply the values by sin(theta) of their row first, and
/// divide the density by 2 pi^2 sin(theta) to have it per solid angle.
class Distribution2D {
public:
  struct Sample {
    Vec2f uv;  ///< in [0, 1)^2; u along a row, v down the rows
    float pdf; ///< per unit area of the square, > 0
  };

  /// @param values row after row, row 0 at v = 0
  /// @throws Error if the sizes disagree or are not in [1, 2^22], or a value is negative, NaN or infinite
  Distribution2D(std::span<const float> values, int width, int height);

  Sample sample(Vec2f u) const;
  float pdf(Vec2f uv) const;
  int width() const { return width_; }
  int height() const { return rows_.size(); }
  /// Integral of the given values over the square, their mean.
  double integral() const { return rows_.integral(); }

private:
  struct Built;
  explicit Distribution2D(Built&& built);
  static Built build(std::span<const float> values, int width, int height);
  std::span<const float> row(int y) const;

  int width_;
  std::vector<float> cumulative_; ///< of each row, width + 1 numbers
  Distribution1D rows_;
};

} // namespace nacre
