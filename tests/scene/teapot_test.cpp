#include "scene/teapot.h"

#include "core/error.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace nacre {
namespace {

TEST(Teapot, HasNewellsMeasuresAndItsPlaneOfSymmetry) {
  const TriangleMesh pot = teapot_mesh(8);
  EXPECT_EQ(pot.triangles.size(), 32u * 8 * 8 * 2);
  Vec3f lo = pot.positions[0], hi = lo;
  for (const Vec3f& p : pot.positions) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    const bool mirrored = std::any_of(pot.positions.begin(), pot.positions.end(), [&](const Vec3f& q) {
      return length(q - Vec3f{p.x, p.y, -p.z}) < 1e-5f;
    });
    EXPECT_TRUE(mirrored) << p.x << " " << p.y << " " << p.z;
  }
  // The handle's and the spout's outermost points, the knob's top, the widest circle.
  EXPECT_NEAR(lo.x, -3, 0.01);
  EXPECT_NEAR(hi.x, 3.435, 0.01);
  EXPECT_NEAR(lo.y, 0, 1e-6);
  EXPECT_NEAR(hi.y, 3.15, 1e-6);
  EXPECT_NEAR(hi.z, 2, 0.02);
}

TEST(Teapot, NormalsAndFacesPointOutwards) {
  const TriangleMesh pot = teapot_mesh(12);
  double volume = 0;
  for (const auto& t : pot.triangles) {
    const Vec3f a = pot.positions[t[0]], b = pot.positions[t[1]], c = pot.positions[t[2]];
    const Vec3f face = cross(b - a, c - a);
    volume += double(dot(a, face)) / 6;
    if (length(face) < 1e-4f) continue;
    for (const std::uint32_t corner : t) {
      EXPECT_NEAR(length(pot.normals[corner]), 1, 1e-5);
      EXPECT_GT(dot(pot.normals[corner], normalize(face)), -0.1f) << "but at creases they are closer";
    }
  }
  // The body alone, a solid of revolution, has some 27; handle and spout add to it.
  EXPECT_GT(volume, 20);
  EXPECT_LT(volume, 40);
  EXPECT_THROW(teapot_mesh(0), Error);
}

} // namespace
} // namespace nacre
