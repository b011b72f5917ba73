#pragma once
// A partition of the sphere of directions learnt from samples, and integrals over it. A lobe of any sharpness
// falls into cells over which it varies little.

#include "core/vec.h"

#include <array>
#include <functional>
#include <span>
#include <vector>

namespace nacre {

/// A rectangle in cylindrical coordinates: z = cos theta in [z0, z1], phi in [phi0, phi1]; its solid angle is
/// the rectangle's area.
struct DirectionCell {
  double z0, z1, phi0, phi1;
  int group = 0; ///< cells of a group together hold enough samples to count
};

/// Several functions of direction integrated together: they cost one evaluation of the model.
using Values = std::array<double, 4>;
using DirectionFunction = std::function<Values(const Vec3d&)>;

struct Integral {
  Values value{};
  Values error{}; ///< estimates of the absolute errors
};

class SpherePartition {
public:
  /// @param samples  unit vectors; the cells hold at most 16 of them each, or as many as coincide
  /// @param depth    2^depth groups of about equally many samples
  SpherePartition(std::vector<Vec3d> samples, int depth);

  std::span<const DirectionCell> cells() const { return cells_; }
  int group_count() const { return group_count_; }
  /// The cell a unit vector falls into.
  const DirectionCell& find(const Vec3d& w) const;
  /// Integral over one cell with respect to solid angle, by Gauss-Legendre rules on adaptively quartered
  /// rectangles.
  /// @param tolerance  absolute, for each value that is judged
  /// @param judged     the first so many values steer the quartering; others may be noise
  static Integral integrate(const DirectionCell& cell, const DirectionFunction& f, double tolerance,
                            std::size_t judged = 4);

private:
  struct Node {
    bool split_z;
    double at;
    int below, above; ///< a node if >= 0, else cell ~index
  };
  int build(std::span<Vec3d> samples, const DirectionCell& cell, int depth);
  int split(std::span<Vec3d> samples, const DirectionCell& cell, bool split_z, double at, int depth);

  std::vector<DirectionCell> cells_;
  std::vector<Node> nodes_;
  int group_count_ = 0;
};

} // namespace nacre
