#pragma once
// Bilinear tables over the unit square, and the warp of uniform numbers to the density such a table is: first
// a row by the marginal distribution, then the place in the row. A table may have many slices, one a node of
// up to two parameters; between nodes densities, not warps, are blended. Source: Dupuy and Jakob 2018, An
// Adaptive Parameterization for Efficient Material Acquisition and Rendering, section 5.

#include "core/vec.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace nacre {

/// The cell of a grid of width x height nodes, the first and last on the edges, that a point of the unit
/// square lies in: its lower corner and the fractions of the way to the upper one. Outside points count as on
/// the edge.
struct BilinearCell {
  std::size_t x, y;
  double fx, fy;

  BilinearCell(const Vec2d& at, std::size_t width, std::size_t height) {
    fx = std::min(std::max(0.0, at.x), 1.0) * double(width - 1);
    fy = std::min(std::max(0.0, at.y), 1.0) * double(height - 1);
    x = std::min(std::size_t(fx), width - 2);
    y = std::min(std::size_t(fy), height - 2);
    fx -= double(x);
    fy -= double(y);
  }
};

/// One table of numbers, row after row, at least 2 x 2.
struct BilinearTable {
  std::size_t width = 0, height = 0;
  std::vector<float> values;

  double at(const Vec2d& p) const {
    const BilinearCell c(p, width, height);
    const float* v = &values[c.y * width + c.x];
    return (1 - c.fy) * ((1 - c.fx) * double(v[0]) + c.fx * double(v[1])) +
           c.fy * ((1 - c.fx) * double(v[width]) + c.fx * double(v[width + 1]));
  }
};

/// Slices of a table and their weights, which sum to 1.
struct SliceBlend {
  std::size_t count = 1;
  std::array<std::size_t, 4> slice{};
  std::array<double, 4> weight{1, 0, 0, 0};
};
/// Linear between the nodes of two parameters, each ascending, constant beyond them; slice = index of a times
/// the nodes of b, plus index of b. Slices of weight 0 are left out.
SliceBlend blend_slices(std::span<const float> a_nodes, double a, std::span<const float> b_nodes, double b);

class MarginalWarp {
public:
  struct Point {
    Vec2d at;   ///< in [0, 1]^2
    double pdf; ///< per unit area of the square, of the blended density
  };

  MarginalWarp() = default;
  /// A slice whose values are all 0 is the uniform density.
  /// @param values  slice after slice, row after row; finite and not negative. At least 2 x 2 a slice
  MarginalWarp(std::size_t width, std::size_t height, std::span<const float> values);

  std::size_t width() const { return width_; }
  std::size_t height() const { return height_; }
  /// Densities at the nodes: what was given, scaled so that each slice integrates to 1.
  std::span<const float> densities() const { return density_; }

  /// Where uniform numbers go, x along a row.
  Point sample(const Vec2d& u, const SliceBlend& blend) const;
  /// The inverse: the uniform numbers in `at` that go to this point, and the density there. Continuous; where
  /// the density is 0 all points of a stretch have the same uniform numbers.
  Point invert(const Vec2d& at, const SliceBlend& blend) const;
  double pdf(const Vec2d& at, const SliceBlend& blend) const;

private:
  template <class T>
  double blended(const std::vector<T>& table, std::size_t stride, std::size_t i, const SliceBlend& b) const {
    double sum = 0;
    for (std::size_t k = 0; k < b.count; ++k)
      sum += b.weight[k] * double(table[b.slice[k] * stride + i]);
    return sum;
  }

  std::size_t width_ = 0, height_ = 0;
  std::vector<float> density_;
  std::vector<double> conditional_; ///< integral of a row's density up to each node
  std::vector<double> marginal_;    ///< integral of the rows' integrals up to each row
};

} // namespace nacre
