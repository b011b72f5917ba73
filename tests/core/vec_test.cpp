#include "core/vec.h"

#include "core/dual.h"
#include "core/random.h"
#include "core/spectrum.h"

#include <gtest/gtest.h>
#include <limits>
#include <vector>

namespace nacre {
namespace {

std::vector<Vec3d> adversarial_normals() {
  std::vector<Vec3d> n = {{0, 0, 1},  {0, 0, -1},   {1, 0, 0},    {-1, 0, 0},     {0, 1, 0},
                          {0, -1, 0}, {1, 0, -0.0}, {0, 1, -0.0}, {1, 0, -1e-30}, {0.6, 0.8, 0}};
  for (double tilt = 1e-1; tilt > 1e-20; tilt *= 0.1)
    for (const double z : {1.0, -1.0}) {
      n.push_back(normalize(Vec3d{tilt, 0, z}));
      n.push_back(normalize(Vec3d{-tilt, tilt, z}));
      n.push_back(normalize(Vec3d{1, -1, z * tilt}));
    }
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const auto r = [&](int k) { return 2 * unit_double(hash(i, k)) - 1; };
    n.push_back(normalize(Vec3d{r(0), r(1), r(2)}));
  }
  return n;
}

template <class R>
void expect_orthonormal(const Frame<R>& f, double tolerance) {
  EXPECT_NEAR(length_squared(f.s), 1, tolerance);
  EXPECT_NEAR(length_squared(f.t), 1, tolerance);
  EXPECT_NEAR(dot(f.s, f.t), 0, tolerance);
  EXPECT_NEAR(dot(f.s, f.n), 0, tolerance);
  EXPECT_NEAR(dot(f.t, f.n), 0, tolerance);
  EXPECT_NEAR(dot(cross(f.s, f.t), f.n), 1, tolerance) << "right-handed";
}

TEST(Frame, AroundAnyNormalIsOrthonormal) {
  for (const Vec3d& n : adversarial_normals()) {
    SCOPED_TRACE(testing::Message() << n.x << " " << n.y << " " << n.z);
    expect_orthonormal(Frame<double>::around(n), 2e-15);
    expect_orthonormal(Frame<float>::around(normalize(vec3<float>(n))), 1e-6);
  }
}

TEST(Frame, WithTangentKeepsTheNormalAndThePlaneOfTheTangent) {
  const std::vector<Vec3d> normals = adversarial_normals();
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3d n = normals[i], tangent = normals[(i * 7 + 3) % normals.size()] * 5.0;
    const auto f = Frame<double>::with_tangent(n, tangent);
    // Made perpendicular: precision falls as the sine of the angle between them.
    expect_orthonormal(f, 2e-15 / std::max(1e-9, length(cross(n, tangent)) / 5));
    EXPECT_EQ(f.n.x, n.x);
    if (length(cross(n, tangent)) > 1e-3) {
      EXPECT_NEAR(dot(tangent, f.t), 0, 1e-11);
      EXPECT_GT(dot(tangent, f.s), 0);
    }
  }
}

TEST(Frame, WithAUselessTangentFallsBack) {
  for (const Vec3f n : {Vec3f{0, 0, 1}, Vec3f{0, 0, -1}, Vec3f{1, 0, 0}})
    for (const Vec3f tangent : {n, -n, Vec3f{0, 0, 0}, n * 1e-20f}) {
      expect_orthonormal(Frame<float>::with_tangent(n, tangent), 1e-6);
    }
}

TEST(Frame, WithTangentInPacksChoosesPerLane) {
  const Vec3<Pack> n{Pack(0.0f), Pack(0.0f), Pack(1.0f)};
  float x[pack_width], z[pack_width];
  for (std::size_t i = 0; i < pack_width; ++i) {
    x[i] = i % 2 ? 2.0f : 0.0f;
    z[i] = i % 2 ? 1.0f : 3.0f; // odd lanes slanted, even lanes parallel to n
  }
  const auto f = Frame<Pack>::with_tangent(n, {load(x), Pack(0.0f), load(z)});
  for (std::size_t i = 0; i < pack_width; ++i) {
    EXPECT_EQ(lane(f.s.x, i), 1);
    EXPECT_EQ(lane(f.t.y, i), 1);
    EXPECT_EQ(lane(f.s.z, i), 0);
  }
}

TEST(Frame, LocalAndWorldAreInverse) {
  const Vec3d w = normalize(Vec3d{0.3, -0.5, 0.2});
  for (const Vec3d& n : adversarial_normals()) {
    const auto f = Frame<double>::around(n);
    EXPECT_LT(length(f.to_world(f.to_local(w)) - w), 2e-15);
    EXPECT_NEAR(f.to_local(n).z, 1, 1e-15);
  }
}

TEST(Reflect, KeepsAngleAndPlaneAndUndoesItself) {
  const std::vector<Vec3d> v = adversarial_normals();
  for (std::size_t i = 0; i + 1 < v.size(); ++i) {
    const Vec3d n = v[i], w = v[i + 1], r = reflect(w, n);
    EXPECT_NEAR(dot(r, n), dot(w, n), 2e-15);
    EXPECT_NEAR(length(r), 1, 2e-15);
    EXPECT_NEAR(dot(cross(w, n), r), 0, 2e-15);
    EXPECT_LT(length(reflect(r, n) - w), 3e-15);
  }
}

TEST(Vec3, SphericalDirectionAndItsTrigonometryAgree) {
  const Vec3d w = spherical_direction(0.7, 2.1);
  EXPECT_NEAR(cos_theta(w), std::cos(0.7), 1e-15);
  EXPECT_NEAR(sin2_theta(w), std::pow(std::sin(0.7), 2), 1e-15);
  EXPECT_NEAR(tan2_theta(w), std::pow(std::tan(0.7), 2), 1e-14);
  EXPECT_NEAR(std::atan2(w.y, w.x), 2.1, 1e-15);
}

TEST(Vec3, CrossIsRightHanded) {
  const Vec3d z = cross(Vec3d{1, 0, 0}, Vec3d{0, 1, 0});
  EXPECT_EQ(z.z, 1);
  EXPECT_EQ(z.x, 0);
}

TEST(Spectrum, ArithmeticIsPerChannel) {
  using S = Spectrum<double, 3>;
  const S a(std::array<double, 3>{1, 2, 4}), b(std::array<double, 3>{2, 4, 16});
  EXPECT_EQ((a + b)[2], 20);
  EXPECT_EQ((b - a)[2], 12);
  EXPECT_EQ((a * b)[1], 8);
  EXPECT_EQ((b / a)[2], 4);
  EXPECT_EQ((2.0 * a / 4.0)[0], 0.5);
  EXPECT_EQ((-a)[1], -2);
  EXPECT_EQ(max_component(a), 4);
  EXPECT_EQ(select(false, a, b)[0], 2);
  EXPECT_EQ(a.map([](double x) { return x * x; })[2], 16);
}

TEST(Spectrum, AverageOfEqualChannelsIsTheChannelInDoublePrecision) {
  EXPECT_NEAR(average(Spectrum<double, 3>(0.7)), 0.7, 1e-15);
  EXPECT_NEAR(average(Spectrum<Dual<double, 1>, 3>(Dual<double, 1>(0.7))).v, 0.7, 1e-15);
}

} // namespace
} // namespace nacre
