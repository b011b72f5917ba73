#include "measured/rusinkiewicz.h"

#include "core/pack.h"
#include "core/random.h"
#include "core/warp.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

double random(int i, int d) { return unit_double(hash(7, i, d)); }
/// Distance on the circle.
double angle_between(double a, double b) { return std::abs(std::remainder(a - b, 2 * pi)); }

TEST(Rusinkiewicz, AnglesSurviveTheRoundTripThroughDirections) {
  for (int i = 0; i < 20000; ++i) {
    // Every other theta_h and theta_d within 1e-9 .. 1 of its end, where arc cosines would fail.
    const double end = i % 2 ? 1 : std::pow(10.0, -9 * random(i, 3));
    const HalfDifference<double> a{1.5 * random(i, 0) * end, 1.5 * random(i, 1) * end,
                                   (random(i, 2) * 2 - 1) * pi};
    const auto [wo, wi] = directions(a);
    EXPECT_NEAR(length(wo), 1, 1e-14);
    EXPECT_NEAR(length(wi), 1, 1e-14);
    const auto b = half_difference(wo, wi);
    EXPECT_NEAR(b.theta_h, a.theta_h, 1e-14);
    EXPECT_NEAR(b.theta_d, a.theta_d, 1e-14);
    // A direction carries 1e-16; seen from the half vector that is an angle of 1e-16 over its own size.
    EXPECT_LT(angle_between(b.phi_d, a.phi_d), 1e-15 / (std::sin(a.theta_d) * std::sin(a.theta_h)) + 1e-14)
        << a.theta_h << ' ' << a.theta_d << ' ' << a.phi_d;
  }
}

TEST(Rusinkiewicz, ExchangeTurnsPhiDByHalfATurnAndMirroringNegatesIt) {
  for (int i = 0; i < 5000; ++i) {
    const Vec3d wo = square_to_hemisphere(Vec2<double>{random(i, 0), random(i, 1)});
    const Vec3d wi = square_to_hemisphere(Vec2<double>{random(i, 2), random(i, 3)});
    const auto a = half_difference(wo, wi), exchanged = half_difference(wi, wo);
    const auto mirrored = half_difference(Vec3d{wo.x, -wo.y, wo.z}, Vec3d{wi.x, -wi.y, wi.z});
    EXPECT_DOUBLE_EQ(a.theta_h, exchanged.theta_h);
    EXPECT_DOUBLE_EQ(a.theta_d, exchanged.theta_d);
    EXPECT_LT(angle_between(a.phi_d + pi, exchanged.phi_d), 1e-12);
    EXPECT_LT(angle_between(-a.phi_d, mirrored.phi_d), 1e-12);
  }
}

TEST(Rusinkiewicz, DifferenceOfTurnedDirectionsIsTheSame) {
  for (int i = 0; i < 2000; ++i) {
    const Vec3d wo = square_to_hemisphere(Vec2<double>{random(i, 0), random(i, 1)});
    const Vec3d wi = square_to_hemisphere(Vec2<double>{random(i, 2), random(i, 3)});
    const double c = std::cos(i), s = std::sin(i);
    const auto turn = [&](const Vec3d& w) { return Vec3d{c * w.x - s * w.y, s * w.x + c * w.y, w.z}; };
    const auto a = half_difference(wo, wi), b = half_difference(turn(wo), turn(wi));
    EXPECT_NEAR(a.theta_h, b.theta_h, 1e-13);
    EXPECT_NEAR(a.theta_d, b.theta_d, 1e-13);
    EXPECT_LT(angle_between(a.phi_d, b.phi_d), 1e-10);
  }
}

TEST(Rusinkiewicz, AnglesAreFiniteAtTheEndsOfEveryRange) {
  const Vec3d up{0, 0, 1}, x{1, 0, 0}, y{0, 1, 0};
  const Vec3d grazing = normalize(Vec3d{1, 0, 1e-12}), opposite = normalize(Vec3d{-1, 0, 1e-12});
  const std::vector<Vec3d> all{up, x, y, -x, grazing, opposite, normalize(Vec3d{1e-9, 1e-12, 1})};
  for (const Vec3d& wo : all)
    for (const Vec3d& wi : all) {
      const auto a = half_difference(wo, wi);
      EXPECT_TRUE(a.theta_h >= 0 && a.theta_h <= pi / 2 + 1e-15) << a.theta_h;
      EXPECT_TRUE(a.theta_d >= 0 && a.theta_d <= pi / 2 + 1e-15) << a.theta_d;
      EXPECT_TRUE(std::abs(a.phi_d) <= pi) << a.phi_d;
      const auto in_floats = half_difference(vec3<float>(wo), vec3<float>(wi));
      const auto in_packs = half_difference(vec3<Pack>(wo), vec3<Pack>(wi));
      for (const float angle :
           {in_floats.theta_h, in_floats.theta_d, in_floats.phi_d, lane(in_packs.theta_h, 0),
            lane(in_packs.theta_d, 0), lane(in_packs.phi_d, 0)})
        EXPECT_TRUE(std::isfinite(angle));
    }
}

TEST(Rusinkiewicz, FloatsKeepTheHalfAngleNearTheMirrorDirection) {
  for (int i = 0; i < 2000; ++i) {
    const double theta_h = std::pow(10.0, -1 - 4 * random(i, 0));
    const auto [wo, wi] = directions(HalfDifference<double>{theta_h, 0.2 + random(i, 1), 3 * random(i, 2)});
    const double found = half_difference(vec3<float>(wo), vec3<float>(wi)).theta_h;
    // Each of the four horizontal components is rounded by at most 2^-25; the half vector is their mean.
    EXPECT_NEAR(found, theta_h, 2e-7 + 2e-7 * theta_h);
  }
}

TEST(Rusinkiewicz, AngleOfFloatsIsTheArcTangent) {
  for (int i = 0; i < 100000; ++i) {
    const auto coordinate = [&](int d) {
      return static_cast<float>((random(i, d) - 0.5) * std::pow(10.0, -8 * random(i, d + 1)));
    };
    const float y = coordinate(0), x = coordinate(2);
    const double expected = std::atan2(static_cast<double>(y), static_cast<double>(x));
    EXPECT_NEAR(angle_of(y, x), expected, 2.5e-7 * std::abs(expected)) << y << ' ' << x;
  }
  EXPECT_EQ(angle_of(0.0f, 2.0f), 0.0f);
  EXPECT_FLOAT_EQ(angle_of(0.0f, -2.0f), static_cast<float>(pi));
  EXPECT_FLOAT_EQ(angle_of(-3.0f, 0.0f), static_cast<float>(-pi / 2));
}

TEST(Rusinkiewicz, HorizonIsWhereADirectionsHeightIsZero) {
  for (int i = 0; i < 20000; ++i) {
    const HalfDifference<double> a{pi / 2 * random(i, 0), pi / 2 * random(i, 1), 2 * pi * random(i, 2)};
    const auto [wo, wi] = directions(a);
    const double lowest = std::min(wo.z, wi.z);
    if (std::abs(lowest) > 1e-12) {
      EXPECT_EQ(above_horizon(a), lowest > 0);
    }
  }
}

} // namespace
} // namespace nacre
