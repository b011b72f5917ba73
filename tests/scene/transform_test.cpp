#include "core/error.h"
#include "scene/transform.h"

#include <random>

#include <gtest/gtest.h>

namespace nacre {
namespace {

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Transform, RotationIsCounterClockwiseAboutItsAxis) {
  expect_near(Transform::rotate({0, 0, 3}, 90).point({1, 0, 0}), {0, 1, 0});
  expect_near(Transform::rotate({1, 0, 0}, 90).point({0, 1, 0}), {0, 0, 1});
  expect_near(Transform::rotate({0, 1, 0}, 90).point({0, 0, 1}), {1, 0, 0});
}

TEST(Transform, RotationKeepsItsAxisAndLengths) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 100; ++i) {
    const Vec3d axis{normal(random), normal(random), normal(random)}, v{normal(random), normal(random), 1};
    const Transform t = Transform::rotate(axis, 360 * normal(random));
    expect_near(t.vector(axis), axis, 1e-12);
    EXPECT_NEAR(length(t.vector(v)), length(v), 1e-12);
    EXPECT_NEAR(t.determinant3(), 1, 1e-12);
  }
}

TEST(Transform, ProductAppliesTheRightFactorFirst) {
  const Transform t = Transform::translate({1, 2, 3}) * Transform::scale({2, 2, 2});
  expect_near(t.point({1, 1, 1}), {3, 4, 5});
  expect_near(t.vector({1, 1, 1}), {2, 2, 2});
}

TEST(Transform, InverseUndoes) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> number(-2, 2);
  for (int i = 0; i < 100; ++i) {
    Transform t;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c)
        t.m[r][c] = number(random);
    if (std::abs(t.determinant3()) < 0.01) continue;
    const Vec3d p{number(random), number(random), number(random)};
    expect_near(t.inverse().point(t.point(p)), p, 1e-10); // condition below 1e4
  }
}

TEST(Transform, SingularHasNoInverse) {
  EXPECT_THROW(Transform::scale({1, 0, 1}).inverse(), Error);
  EXPECT_THROW(Transform::rotate({0, 0, 0}, 10), Error);
}

TEST(Transform, NormalStaysPerpendicularUnderShear) {
  Transform t;
  t.m[0][1] = 3;
  t.m[2][0] = -1;
  const Vec3d tangent{1, 2, -1}, n{1, 0, 1}; // perpendicular
  EXPECT_NEAR(dot(t.vector(tangent), Transform::normal(t.inverse(), n)), 0, 1e-12);
}

TEST(Transform, LookAtHasMitsubasAxes) {
  const Transform t = Transform::look_at({1, 2, 3}, {1, 2, 8}, {0, 5, 1});
  expect_near(t.point({0, 0, 0}), {1, 2, 3});
  expect_near(t.vector({0, 0, 1}), {0, 0, 1}); // forward
  expect_near(t.vector({0, 1, 0}), {0, 1, 0}); // up
  expect_near(t.vector({1, 0, 0}), {1, 0, 0}); // left
  EXPECT_NEAR(t.determinant3(), 1, 1e-12);
  EXPECT_THROW(Transform::look_at({0, 0, 0}, {0, 0, 0}, {0, 1, 0}), Error);
  EXPECT_THROW(Transform::look_at({0, 0, 0}, {0, 2, 0}, {0, 1, 0}), Error);
}

} // namespace
} // namespace nacre
