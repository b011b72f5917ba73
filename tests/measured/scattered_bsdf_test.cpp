#include "measured/scattered_bsdf.h"

#include "analytic.h"
#include "core/error.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace nacre {
namespace {

Vec3f single(const Vec3d& w) { return {float(w.x), float(w.y), float(w.z)}; }
Vec3d wide(const Vec3f& w) { return {double(w.x), double(w.y), double(w.z)}; }

template <class F>
void add(MeasuredSamples& s, const Vec3d& wo, const Vec3d& wi, F f) {
  s.wo.push_back(single(wo));
  s.wi.push_back(single(wi));
  s.f.push_back(float(f({wo.x, wo.y, std::abs(wo.z)}, {wi.x, wi.y, std::abs(wi.z)})));
}

/// What a goniophotometer scans: few incidences at one azimuth, theta_o finely, phi_o coarsely.
template <class F>
MeasuredSamples isotropic_scan(F f, double phi_i = 0, int last_azimuth = 180, int finer = 1) {
  MeasuredSamples s;
  for (double theta_i = 0; theta_i <= 75; theta_i += 15.0 / finer)
    for (double phi = 0; phi <= last_azimuth; phi += 10.0 / finer)
      for (double theta_o = 0; theta_o < 88; theta_o += 2.0 / finer)
        add(s, at_degrees(theta_o, phi_i + phi), at_degrees(theta_i, phi_i), f);
  return s;
}
template <class F>
MeasuredSamples anisotropic_scan(F f) {
  MeasuredSamples s;
  for (int theta_i = 0; theta_i <= 60; theta_i += 15)
    for (int phi_i = 0; phi_i < 360; phi_i += 30)
      for (int phi = 0; phi < 360; phi += 15)
        for (int theta_o = 0; theta_o < 88; theta_o += 4)
          add(s, at_degrees(theta_o, phi), at_degrees(theta_i, phi_i), f);
  return s;
}
template <class F>
MeasuredSamples cloud(F f, std::uint64_t n) {
  MeasuredSamples s;
  for (std::uint64_t i = 0; i < n; ++i)
    add(s, random_direction(2 * i + 100000, 88), random_direction(2 * i + 100001, 88), f);
  return s;
}
using Symmetry = ScatteredBsdf::Symmetry;
ScatteredBsdf measured(MeasuredSamples s, Symmetry symmetry = Symmetry::found) {
  return ScatteredBsdf(std::move(s), Channels::grey(), symmetry, "test");
}
double lambert(const Vec3d&, const Vec3d&) { return 0.25; }

TEST(ScatteredBsdf, SamplesAreReproduced) {
  for (const auto& m : {measured(isotropic_scan(Glossy{})), measured(isotropic_scan(Glossy{}, 77, 350)),
                        measured(anisotropic_scan(Glossy{0.2, 0.4})), measured(cloud(Glossy{}, 3000))}) {
    const MeasuredSamples s = m.samples();
    for (std::size_t n = 0; n < s.size(); ++n)
      EXPECT_NEAR(grey(m, wide(s.wo[n]), wide(s.wi[n])), s.f[n], 1e-3 * s.f[n]) << "sample " << n;
  }
}

TEST(ScatteredBsdf, LambertIsReproducedWhereCovered) {
  for (const auto& m :
       {measured(isotropic_scan(lambert)), measured(anisotropic_scan(lambert)),
        measured(cloud(lambert, 3000)), measured(cloud(lambert, 3000), Symmetry::isotropic)}) {
    int covered = 0;
    for (std::uint64_t n = 0; n < 3000; ++n) {
      const double f = grey(m, random_direction(2 * n, 80), random_direction(2 * n + 1, 55));
      covered += f != -1;
      if (f != -1) {
        EXPECT_NEAR(f, 0.25, 1e-6);
      }
    }
    EXPECT_GT(covered, 2900);
  }
}

TEST(ScatteredBsdf, HighlightsAreNotSmearedBetweenIncidences) {
  // Incidences 15 degrees apart, a highlight 10 degrees wide: half-way between them the peak keeps its
  // height.
  const Glossy f{0.1, 0.1, 0.05};
  const auto m = measured(isotropic_scan(f));
  for (const double theta : {7.5, 22.5, 37.5, 52.5}) {
    const Vec3d wo = at_degrees(theta, 180), wi = at_degrees(theta, 0);
    // What remains is the curvature of 1 / (cos theta_i cos theta_o): a ninth between 45 and 60 degrees.
    EXPECT_NEAR(grey(m, wo, wi), f(wo, wi), (theta < 50 ? 0.06 : 0.12) * f(wo, wi)) << theta;
    const Vec3d aside = at_degrees(theta + 8, 180);
    EXPECT_NEAR(grey(m, aside, wi), f(aside, wi), (theta < 50 ? 0.1 : 0.16) * f(aside, wi)) << theta;
  }
}

TEST(ScatteredBsdf, ErrorForGgxIsBoundedAndFallsWithTheSteps) {
  const auto error = [](const ScatteredBsdf& m, const Glossy& f, double theta_o, double theta_i) {
    double sum = 0, norm = 0;
    int covered = 0;
    for (std::uint64_t n = 0; n < 3000; ++n) {
      const Vec3d wo = random_direction(2 * n, theta_o), wi = random_direction(2 * n + 1, theta_i);
      const double value = grey(m, wo, wi);
      if (value == -1) continue;
      ++covered;
      sum += sqr(value - f(wo, wi));
      norm += sqr(f(wo, wi));
    }
    EXPECT_GT(covered, 2900);
    return std::sqrt(sum / norm);
  };
  const double coarse = error(measured(isotropic_scan(Glossy{})), Glossy{}, 70, 60);
  EXPECT_LT(coarse, 0.06);
  EXPECT_NEAR(coarse / error(measured(isotropic_scan(Glossy{}, 0, 180, 2)), Glossy{}, 70, 60), 4, 1);
  EXPECT_LT(error(measured(anisotropic_scan(Glossy{0.2, 0.4})), Glossy{0.2, 0.4}, 70, 55), 0.12);
  // A cloud of that many isotropic samples has a step of some 3 degrees; without symmetry one of 10.
  EXPECT_LT(error(measured(cloud(Glossy{}, 20000), Symmetry::isotropic), Glossy{}, 70, 70), 0.12);
  EXPECT_LT(error(measured(cloud(Glossy{}, 20000)), Glossy{}, 70, 70), 0.25);
}

TEST(ScatteredBsdf, ValuesAreContinuousAlongArcs) {
  for (const auto& m : {measured(isotropic_scan(Glossy{})), measured(anisotropic_scan(Glossy{0.2, 0.4})),
                        measured(cloud(Glossy{}, 3000), Symmetry::isotropic)}) {
    for (std::uint64_t arc = 0; arc < 20; ++arc) {
      const Vec3d wi = random_direction(2 * arc, 50), from = random_direction(2 * arc + 1, 60);
      double before = grey(m, from, wi);
      constexpr int steps = 5000;
      for (int n = 1; n <= steps; ++n) {
        // Both move: wo by up to 40, wi by up to 5 degrees.
        const double t = double(n) / steps;
        const Vec3d wo = normalize(from + Vec3d{0.6 * t, -0.2 * t, 0}),
                    w = normalize(wi + Vec3d{0, 0.08 * t, 0});
        const double value = grey(m, wo, w);
        if (value != -1 && before != -1) {
          ASSERT_LT(std::abs(value - before), 0.02) << "arc " << arc << " step " << n;
        }
        before = value;
      }
    }
  }
}

TEST(ScatteredBsdf, OneAzimuthOfIncidenceMeansIsotropic) {
  EXPECT_TRUE(measured(isotropic_scan(Glossy{})).is_isotropic());
  EXPECT_TRUE(measured(isotropic_scan(Glossy{}, -123)).is_isotropic());
  EXPECT_FALSE(measured(anisotropic_scan(Glossy{})).is_isotropic());
  EXPECT_FALSE(measured(isotropic_scan(Glossy{}), Symmetry::none).is_isotropic());
  const auto half = measured(isotropic_scan(Glossy{}, 40)),
             full = measured(isotropic_scan(Glossy{}, 40, 350));
  const Glossy f;
  for (std::uint64_t n = 0; n < 500; ++n) {
    // Samples on one side stand for both.
    const Vec3d wo = random_direction(2 * n, 70), wi = random_direction(2 * n + 1, 60);
    EXPECT_NEAR(grey(half, wo, wi), grey(full, wo, wi), 0.1 * f(wo, wi));
    const auto turned = [](const Vec3d& w) { return Vec3d{-w.y, w.x, w.z}; };
    EXPECT_NEAR(grey(full, wo, wi), grey(full, turned(wo), turned(wi)), 1e-5);
  }
}

TEST(ScatteredBsdf, WhatWasNotMeasuredIsAHole) {
  // A scan in the plane of incidence knows nothing beside it, nor of other incidences.
  MeasuredSamples plane;
  for (const int theta_i : {20, 40})
    for (int theta_o = -80; theta_o <= 60; ++theta_o)
      add(plane, at_degrees(theta_o, 180), at_degrees(theta_i, 0), Glossy{});
  const auto m = measured(plane);
  EXPECT_GT(grey(m, at_degrees(30.5, 180), at_degrees(30, 0)), 0);
  EXPECT_GT(grey(m, at_degrees(30.5, 0), at_degrees(30, 180)), 0);
  EXPECT_EQ(grey(m, at_degrees(30, 150), at_degrees(30, 0)), -1);
  EXPECT_EQ(grey(m, at_degrees(30, 180), at_degrees(50, 0)), -1);
  EXPECT_EQ(grey(m, at_degrees(30, 180), at_degrees(10, 0)), -1);
  EXPECT_EQ(grey(m, at_degrees(85, 180), at_degrees(20, 0)), -1);
  EXPECT_EQ(grey(m, at_degrees(120, 180), at_degrees(20, 0)), -1); // no transmission
  // A cloud ends where its samples do.
  const auto c = measured(cloud(Glossy{}, 5000));
  MeasuredSamples near_normal;
  for (std::uint64_t i = 0; i < 3000; ++i)
    add(near_normal, random_direction(2 * i, 30), random_direction(2 * i + 1, 30), Glossy{});
  EXPECT_EQ(grey(measured(near_normal), at_degrees(60, 180), at_degrees(20, 0)), -1);
  EXPECT_EQ(grey(measured(near_normal), at_degrees(60, 180), at_degrees(60, 0)), -1);
  EXPECT_GT(grey(measured(near_normal), at_degrees(15, 180), at_degrees(20, 0)), 0);
}

TEST(ScatteredBsdf, BetweenScansFarApartIsAHole) {
  // Two scans that cross: near the middle they surround what lies between, far out they do not.
  MeasuredSamples cross;
  for (const int phi : {0, 90, 180, 270})
    for (int theta_o = 0; theta_o <= 80; theta_o += 2)
      for (const int theta_i : {10, 11})
        add(cross, at_degrees(theta_o, phi), at_degrees(theta_i, 0), Glossy{});
  const auto m = measured(cross);
  EXPECT_GT(grey(m, at_degrees(20, 45), at_degrees(10, 0)), 0);
  EXPECT_EQ(grey(m, at_degrees(50, 45), at_degrees(10, 0)), -1);
  EXPECT_GT(grey(m, at_degrees(76, 90), at_degrees(10, 0)), 0);
}

TEST(ScatteredBsdf, MirroredSamplesSurroundThePlaneOfIncidence) {
  MeasuredSamples beside;
  for (int phi = 10; phi <= 170; phi += 10)
    for (int theta_o = 0; theta_o <= 80; theta_o += 5)
      for (const int theta_i : {20, 40})
        add(beside, at_degrees(theta_o, phi), at_degrees(theta_i, 0), Glossy{});
  const Vec3d wo = at_degrees(32, 180), wi = at_degrees(30, 0);
  EXPECT_NEAR(grey(measured(beside), wo, wi), Glossy{}(wo, wi), 0.1 * Glossy{}(wo, wi));
}

TEST(ScatteredBsdf, EverySideHasItsOwnSamples) {
  MeasuredSamples s;
  const double sides[4][2] = {{1, 1}, {-1, 1}, {1, -1}, {-1, -1}};
  for (int side = 0; side < 4; ++side)
    for (int theta_i = 0; theta_i <= 60; theta_i += 20)
      for (int phi = 0; phi < 360; phi += 30)
        for (int theta_o = 0; theta_o <= 80; theta_o += 10) {
          Vec3d wo = at_degrees(theta_o, phi), wi = at_degrees(theta_i, 0);
          wo.z *= sides[side][0];
          wi.z *= sides[side][1];
          add(s, wo, wi, [&](const Vec3d&, const Vec3d&) { return side + 1.0; });
        }
  const auto m = measured(s);
  EXPECT_TRUE(m.sides().reflects_front && m.sides().reflects_back && m.sides().transmits_to_front &&
              m.sides().transmits_to_back);
  for (int side = 0; side < 4; ++side) {
    Vec3d wo = at_degrees(33, 100), wi = at_degrees(10, 17);
    wo.z *= sides[side][0];
    wi.z *= sides[side][1];
    EXPECT_NEAR(grey(m, wo, wi), side + 1, 1e-6);
  }
}

TEST(ScatteredBsdf, SamplesWithTheSameDirectionsAreAveraged) {
  MeasuredSamples s = isotropic_scan(lambert);
  const std::size_t n = s.size();
  for (std::size_t i = 0; i < n; ++i)
    add(s, wide(s.wo[i]), wide(s.wi[i]), [](const Vec3d&, const Vec3d&) { return 0.75; });
  const auto m = measured(s);
  EXPECT_EQ(m.samples().size(), 2 * n);
  EXPECT_NEAR(grey(m, at_degrees(20, 30), at_degrees(20, 0)), 0.5, 1e-6);
  MeasuredSamples two = cloud(lambert, 200);
  const MeasuredSamples again = two;
  for (std::size_t i = 0; i < again.size(); ++i)
    add(two, wide(again.wo[i]), wide(again.wi[i]), [](const Vec3d&, const Vec3d&) { return 0.75; });
  EXPECT_NEAR(grey(measured(two), wide(again.wo[0]), wide(again.wi[0])), 0.5, 1e-6);
}

TEST(ScatteredBsdf, FewSamplesAreTakenAsTheyAre) {
  MeasuredSamples s;
  add(s, at_degrees(30, 180), at_degrees(30, 0), [](const Vec3d&, const Vec3d&) { return 2.0; });
  EXPECT_NEAR(grey(measured(s), at_degrees(30, 180), at_degrees(30, 0)), 2, 1e-6);
  EXPECT_EQ(grey(measured(s), at_degrees(40, 180), at_degrees(30, 0)), -1);
  add(s, at_degrees(40, 180), at_degrees(30, 0), [](const Vec3d&, const Vec3d&) { return 4.0; });
  EXPECT_NEAR(grey(measured(s), at_degrees(30, 180), at_degrees(30, 0)), 2, 1e-5);
}

TEST(ScatteredBsdf, SamplesThatAreNoneAreErrors) {
  EXPECT_THROW(measured(MeasuredSamples{}), Error);
  MeasuredSamples s = isotropic_scan(lambert);
  s.f[3] = std::nanf("");
  EXPECT_THROW(measured(s), Error);
  s.f[3] = 1;
  s.wo[5] = {1, 0, 0};
  EXPECT_THROW(measured(s), Error);
  s.wo.pop_back();
  EXPECT_THROW(measured(s), Error);
}

} // namespace
} // namespace nacre
