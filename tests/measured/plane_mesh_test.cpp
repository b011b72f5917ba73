#include "measured/plane_mesh.h"

#include "core/error.h"
#include "core/random.h"
#include "measured/point_tree.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace nacre {
namespace {

std::vector<Vec2d> random_points(std::size_t n, std::uint64_t seed) {
  std::vector<Vec2d> points;
  for (std::size_t i = 0; i < n; ++i)
    points.push_back({unit_double(hash(seed, i, 0)), unit_double(hash(seed, i, 1))});
  return points;
}
/// Rings about the origin, as goniometers scan: many points on one circle, lines through the middle.
std::vector<Vec2d> rings() {
  std::vector<Vec2d> points{{0, 0}};
  for (int r = 1; r <= 17; ++r)
    for (int p = 0; p < 36; ++p)
      points.push_back(
          {std::sin(r * pi / 36) * std::cos(p * pi / 18), std::sin(r * pi / 36) * std::sin(p * pi / 18)});
  return points;
}
std::vector<Vec2d> lattice() {
  std::vector<Vec2d> points;
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 30; ++x)
      points.push_back({x * 0.1, y * 0.1});
  return points;
}
double linear(const Vec2d& p) { return 1 + 2 * p.x - 3 * p.y; }
double interpolated(const std::vector<Vec2d>& points, const PlaneMesh::Place& place) {
  double sum = 0;
  for (int k = 0; k < 3; ++k)
    sum += place.weight[k] * linear(points[place.point[k]]);
  return sum;
}

TEST(PlaneMesh, LinearFunctionsAreReproducedWithinTheHull) {
  for (const auto& points :
       {random_points(3, 1), random_points(500, 2), random_points(20000, 3), rings(), lattice()}) {
    const PlaneMesh mesh(points);
    int inside = 0;
    for (std::uint64_t n = 0; n < 2000; ++n) {
      const Vec2d p{2.4 * unit_double(hash(9, n, 0)) - 0.2, 2.4 * unit_double(hash(9, n, 1)) - 0.2};
      const auto place = mesh.locate(p);
      EXPECT_NEAR(place.weight[0] + place.weight[1] + place.weight[2], 1, 1e-12);
      for (const double w : place.weight)
        EXPECT_GE(w, 0);
      if (place.outside > 0) continue;
      ++inside;
      EXPECT_NEAR(interpolated(points, place), linear(p), 1e-7); // points are moved by 1e-9
    }
    EXPECT_GT(inside, 0);
  }
}

TEST(PlaneMesh, PointsTakeThemselves) {
  for (const auto& points : {random_points(500, 2), rings(), lattice(), std::vector<Vec2d>{{1, 2}}}) {
    const PlaneMesh mesh(points);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const auto place = mesh.locate(points[i]);
      EXPECT_LT(place.outside, 1e-8);
      double own = 0;
      for (int k = 0; k < 3; ++k)
        if (place.point[k] == i) own += place.weight[k];
      EXPECT_NEAR(own, 1, 1e-6);
    }
  }
}

TEST(PlaneMesh, CirclesOfTrianglesHoldNoOtherPoint) {
  // The law of Delaunay, seen from outside: of a random position's triangle, no point lies within the circle.
  const auto points = random_points(400, 5);
  const PlaneMesh mesh(points);
  for (std::uint64_t n = 0; n < 300; ++n) {
    const Vec2d p{unit_double(hash(8, n, 0)), unit_double(hash(8, n, 1))};
    const auto place = mesh.locate(p);
    if (place.outside > 0) continue;
    const Vec2d a = points[place.point[0]], b = points[place.point[1]], c = points[place.point[2]];
    const double d = 2 * (a.x * (b.y - c.y) + b.x * (c.y - a.y) + c.x * (a.y - b.y));
    const auto s = [](const Vec2d& v) { return v.x * v.x + v.y * v.y; };
    const Vec2d center{(s(a) * (b.y - c.y) + s(b) * (c.y - a.y) + s(c) * (a.y - b.y)) / d,
                       (s(a) * (c.x - b.x) + s(b) * (a.x - c.x) + s(c) * (b.x - a.x)) / d};
    const double radius = std::hypot(a.x - center.x, a.y - center.y);
    for (const Vec2d& q : points)
      EXPECT_GT(std::hypot(q.x - center.x, q.y - center.y), radius - 1e-6);
  }
}

TEST(PlaneMesh, OutsideTheNearestPlaceOfTheHullIsTaken) {
  const PlaneMesh mesh({{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0.5}});
  const auto side = mesh.locate({0.25, -2});
  EXPECT_NEAR(side.outside, 2, 1e-8);
  EXPECT_NEAR(side.edge, 1, 1e-8);
  const auto corner = mesh.locate({4, 5});
  EXPECT_NEAR(corner.outside, 5, 1e-8);
  EXPECT_NEAR(std::max({corner.weight[0], corner.weight[1], corner.weight[2]}), 1, 1e-8);
  EXPECT_NEAR(mesh.locate({0.3, 0.4}).outside, 0, 0);
}

TEST(PlaneMesh, PointsOfALineAreJoinedAlongIt) {
  std::vector<Vec2d> points;
  for (const int i : {5, 0, 3, 1, 9})
    points.push_back({0.1 * i, 0.2 * i});
  const PlaneMesh mesh(points);
  const auto place = mesh.locate({0.2, 0.4}); // half-way between 1 and 3
  EXPECT_NEAR(interpolated(points, place), linear({0.2, 0.4}), 1e-12);
  EXPECT_NEAR(place.outside, 0, 1e-12);
  EXPECT_NEAR(mesh.locate({0.2 - 0.2, 0.4 + 0.1}).outside, std::sqrt(0.05), 1e-9);
  EXPECT_NEAR(mesh.locate({-0.3, -0.6}).outside, std::sqrt(0.45), 1e-9);
}

TEST(PlaneMesh, PointsThatMakeNoMeshAreErrors) {
  EXPECT_THROW(PlaneMesh(std::vector<Vec2d>{}), Error);
  EXPECT_THROW(PlaneMesh({{0, 0}, {0, 0}}), Error);
  EXPECT_THROW(PlaneMesh({{0, 0}, {0, std::nan("")}}), Error);
}

TEST(PointTree, NearestPointsAreThoseOfASearchThroughAll) {
  std::vector<PointTree<4>::Point> points;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    PointTree<4>::Point p;
    for (std::uint64_t d = 0; d < 4; ++d)
      p[d] = std::floor(20 * uniform(4, i, d, 0)) / 20; // many equal coordinates
    points.push_back(p);
  }
  const PointTree<4> tree(points);
  std::vector<PointTree<4>::Near> found;
  for (std::uint64_t n = 0; n < 200; ++n) {
    PointTree<4>::Point p;
    for (std::uint64_t d = 0; d < 4; ++d)
      p[d] = uniform(5, n, d, 0) * 1.4f - 0.2f;
    std::vector<PointTree<4>::Near> all;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      double squared = 0;
      for (int d = 0; d < 4; ++d)
        squared += sqr(double(points[i][d]) - double(p[d]));
      all.push_back({squared, i});
    }
    std::sort(all.begin(), all.end());
    tree.nearest(p, 13, found);
    ASSERT_EQ(found.size(), 13u);
    for (std::size_t k = 0; k < 13; ++k)
      EXPECT_EQ(found[k].point, all[k].point);
  }
  tree.nearest(points[0], 5000, found);
  EXPECT_EQ(found.size(), points.size());
}

} // namespace
} // namespace nacre
