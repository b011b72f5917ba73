#pragma once
// Points scattered in a plane, joined to triangles: which points lie about a position, and with what weights
// a linear interpolation takes them. Points of one line are joined along it, a single point stands alone.
// Source: Delaunay triangulation by insertion (Bowyer 1981; Watson 1981) with triangles to a vertex at
// infinity around the hull.

#include "core/vec.h"

#include <array>
#include <cstdint>
#include <vector>

namespace nacre {

class PlaneMesh {
public:
  struct Place {
    std::array<std::uint32_t, 3> point{};
    std::array<double, 3> weight{}; ///< of those points, none negative, sum 1
    double outside = 0; ///< distance from the position to the nearest place within the points' hull
    double edge = 0;    ///< the longest side of the triangle, or length of the segment, used
    double nearest = 0; ///< distance to the nearest of those points
  };

  /// @param points  finite, at least one, no two nearer than a 10^-7th of their extent: they are moved by
  /// 10^-9
  ///                of it, so that no four lie on a circle. @throws Error
  explicit PlaneMesh(const std::vector<Vec2d>& points);

  std::size_t size() const { return points_.size(); }
  /// The triangle around a position or, outside, what the nearest place of the hull takes.
  Place locate(const Vec2d& p) const;

private:
  /// Counter-clockwise; neighbour k lies across the side opposite vertex k.
  struct Triangle {
    std::array<std::int32_t, 3> vertex, neighbour;
  };
  static constexpr std::int32_t infinity = -1;

  void sort_line(const Vec2d& a, const Vec2d& b);
  void triangulate(double extent);
  void insert(std::int32_t vertex, std::int32_t& hint);
  void make_starts();
  bool conflicts(const Triangle& t, const Vec2d& p) const;
  std::int32_t walk(const Vec2d& p, std::int32_t from) const;
  Place on_segment(std::uint32_t a, std::uint32_t b, const Vec2d& p) const;
  Place in_triangle(std::int32_t triangle, const Vec2d& p) const;
  Place on_hull(std::int32_t ghost, const Vec2d& p) const;
  std::size_t cell_of(const Vec2d& p) const;

  std::vector<Vec2d> points_;
  std::vector<std::uint32_t> line_; ///< the points' order where they lie on a line
  Vec2d line_direction_;
  std::vector<Triangle> triangles_;
  /// A triangle near each cell of a square grid over the points, to begin walks from.
  std::vector<std::int32_t> starts_;
  std::size_t cells_ = 1;
  Vec2d low_, high_;
};

} // namespace nacre
