#pragma once
// A partition of the sphere of directions into cells of about equal probability, learnt from samples, and
// integrals over it. A lobe of any sharpness falls into cells over which it varies little.

#include "core/vec.h"

#include <functional>
#include <span>
#include <vector>

namespace nacre {

/// A rectangle in cylindrical coordinates: z = cos theta in [z0, z1], phi in [phi0, phi1]; its solid angle is
/// the rectangle's area.
struct DirectionCell {
  double z0, z1, phi0, phi1;
};

struct Integral {
  double value = 0;
  double error = 0; ///< estimate of the absolute error
};

class SpherePartition {
public:
  /// @param samples  unit vectors; the cells hold about the same number of them each
  /// @param depth    2^depth cells, fewer where samples coincide
  SpherePartition(std::vector<Vec3d> samples, int depth);

  std::span<const DirectionCell> cells() const { return cells_; }
  /// Index of the cell a unit vector falls into.
  std::size_t find(const Vec3d& w) const;
  /// Integral of f over one cell or the sphere, with respect to solid angle, by Gauss-Legendre rules on
  /// adaptively halved rectangles.
  /// @param tolerance  absolute, for the cell
  static Integral integrate(const DirectionCell& cell, const std::function<double(const Vec3d&)>& f,
                            double tolerance);
  Integral integrate(const std::function<double(const Vec3d&)>& f, double tolerance_per_cell) const;

private:
  struct Node {
    bool split_z;
    double at;
    int below, above; ///< a node if >= 0, else cell ~index
  };
  int build(std::span<Vec3d> samples, const DirectionCell& cell, int depth);

  std::vector<DirectionCell> cells_;
  std::vector<Node> nodes_;
  int root_;
};

} // namespace nacre
