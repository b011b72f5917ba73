#include "core/warp.h"

#include "core/dual.h"
#include "core/quadrature.h"
#include "core/sobol.h"
#include "core/statistics.h"

#include <gtest/gtest.h>
#include <vector>

namespace nacre {
namespace {

using Vec2d = Vec2<double>;

constexpr double cone_cos = 0.7;

template <class R>
struct Warp {
  const char* name;
  Vec3<R> (*warp)(const Vec2<R>&);
  R (*pdf)(const Vec3<R>&);
  double z_min, z_max; // the zone of the sphere it covers
};
template <class R>
std::vector<Warp<R>> direction_warps() {
  return {{"cosine hemisphere", square_to_cosine_hemisphere<R>, square_to_cosine_hemisphere_pdf<R>, 0, 1},
          {"hemisphere", square_to_hemisphere<R>, square_to_hemisphere_pdf<R>, 0, 1},
          {"sphere", square_to_sphere<R>, square_to_sphere_pdf<R>, -1, 1},
          {"cone", [](const Vec2<R>& u) { return square_to_cone(u, R(constant<R>(cone_cos))); },
           [](const Vec3<R>& w) { return square_to_cone_pdf(w, R(constant<R>(cone_cos))); }, cone_cos, 1}};
}

// Squares' inner points, away from the diagonals where the disk and triangle maps have creases.
std::vector<Vec2d> inner_points() {
  std::vector<Vec2d> u;
  for (std::uint64_t i = 0; u.size() < 500; ++i) {
    const Vec2d p{unit_double(hash(i, 0)), unit_double(hash(i, 1))};
    const auto inside = [](double x) { return x > 0.01 && x < 0.99; };
    if (inside(p.x) && inside(p.y) && std::abs(p.x - p.y) > 0.01 && std::abs(p.x + p.y - 1) > 0.01)
      u.push_back(p);
  }
  return u;
}

TEST(DirectionWarps, DensityIsTheInverseOfTheStretch) {
  // pdf |dw/du x dw/dv| = 1 where the warp is smooth; central differences are good to about 1e-8.
  const double h = 1e-5;
  for (const auto& warp : direction_warps<double>())
    for (const Vec2d& u : inner_points()) {
      const Vec3d du = (warp.warp({u.x + h, u.y}) - warp.warp({u.x - h, u.y})) / (2 * h);
      const Vec3d dv = (warp.warp({u.x, u.y + h}) - warp.warp({u.x, u.y - h})) / (2 * h);
      ASSERT_NEAR(warp.pdf(warp.warp(u)) * length(cross(du, dv)), 1, 1e-5)
          << warp.name << " " << u.x << " " << u.y;
    }
}

TEST(PlaneWarps, DensityIsTheInverseOfTheStretch) {
  const double h = 1e-5;
  const auto check = [&](auto warp, auto pdf) {
    for (const Vec2d& u : inner_points()) {
      const Vec2d p = warp({u.x + h, u.y}), q = warp({u.x - h, u.y}), r = warp({u.x, u.y + h}),
                  s = warp({u.x, u.y - h});
      const double area = std::abs((p.x - q.x) * (r.y - s.y) - (p.y - q.y) * (r.x - s.x)) / (4 * h * h);
      ASSERT_NEAR(pdf(warp(u)) * area, 1, 1e-5) << u.x << " " << u.y;
    }
  };
  check([](Vec2d u) { return square_to_disk(u); }, [](Vec2d p) { return square_to_disk_pdf(p); });
  check([](Vec2d u) { return square_to_triangle(u); }, [](Vec2d p) { return square_to_triangle_pdf(p); });
}

TEST(DirectionWarps, HistogramMatchesTheIntegratedDensity) {
  constexpr int nz = 8, nphi = 16, n = 1 << 15;
  const auto warps = direction_warps<float>();
  const auto reference = direction_warps<double>();
  const double significance = sidak_significance(0.01, static_cast<int>(warps.size()));
  for (std::size_t k = 0; k < warps.size(); ++k) {
    const double lo = warps[k].z_min, dz = (warps[k].z_max - lo) / nz, dphi = 2 * pi / nphi;
    std::vector<double> observed(nz * nphi), expected(nz * nphi);
    for (std::uint32_t i = 0; i < n; ++i) {
      const Vec3f w = warps[k].warp(IndependentSampler(5, k, i).next_2d());
      const int z = std::clamp(static_cast<int>((w.z - lo) / dz), 0, nz - 1);
      const int phi = std::clamp(static_cast<int>((std::atan2(w.y, w.x) + pi) / dphi), 0, nphi - 1);
      ++observed[z * nphi + phi];
    }
    for (int z = 0; z < nz; ++z)
      for (int phi = 0; phi < nphi; ++phi) {
        const auto density = [&](double mu, double p) {
          const double s = std::sqrt(1 - mu * mu);
          return reference[k].pdf({s * std::cos(p), s * std::sin(p), mu});
        };
        const AdaptiveOptions options{.absolute = 1e-8, .relative = 1e-6};
        expected[z * nphi + phi] =
            n * integrate_adaptive_2d(density, {lo + z * dz, phi * dphi - pi},
                                      {lo + (z + 1) * dz, (phi + 1) * dphi - pi}, options)
                    .value;
      }
    const ChiSquareResult r = chi_square_test(observed, expected);
    EXPECT_GT(r.p, significance) << warps[k].name << ": statistic " << r.statistic;
    double total = 0;
    for (const double e : expected)
      total += e / n;
    EXPECT_NEAR(total, 1, 1e-6) << warps[k].name;
  }
}

// The corners and edges of the square, its centre and diagonals, and some points inside.
std::vector<Vec2f> awkward_points() {
  std::vector<Vec2f> u;
  const float grid[] = {0, 0x1p-24f, 0.25f, 0.5f - 0x1p-25f, 0.5f, 0.5f + 0x1p-24f, 0.75f, 1 - 0x1p-24f};
  for (const float x : grid)
    for (const float y : grid)
      u.push_back({x, y});
  for (std::uint32_t i = 0; i < 448; ++i)
    u.push_back(SobolSampler(1, 2, i).next_2d());
  return u;
}

TEST(DirectionWarps, GiveUnitVectorsInTheirDomainEverywhere) {
  for (const auto& warp : direction_warps<float>())
    for (const Vec2f& u : awkward_points()) {
      const Vec3f w = warp.warp(u);
      EXPECT_NEAR(length(w), 1, 3e-7) << warp.name << " " << u.x << " " << u.y;
      EXPECT_GE(w.z, static_cast<float>(warp.z_min)) << warp.name;
      if (w.z > 0) {
        EXPECT_GT(warp.pdf(w), 0) << warp.name << " " << u.x << " " << u.y;
      }
    }
}

TEST(PlaneWarps, StayInsideEverywhere) {
  for (const Vec2f& u : awkward_points()) {
    const Vec2f d = square_to_disk(u), b = square_to_triangle(u);
    EXPECT_LE(d.x * d.x + d.y * d.y, 1 + 3e-7f);
    EXPECT_GE(std::min({b.x, b.y, 1 - b.x - b.y}), -1e-7f);
  }
  const Vec2f centre = square_to_disk(Vec2f{0.5f, 0.5f});
  EXPECT_EQ(centre.x, 0);
  EXPECT_EQ(centre.y, 0);
}

TEST(Warps, DensitiesVanishOutsideTheirDomain) {
  EXPECT_EQ(square_to_disk_pdf(Vec2f{0.8f, 0.8f}), 0);
  EXPECT_EQ(square_to_triangle_pdf(Vec2f{0.6f, 0.6f}), 0);
  EXPECT_EQ(square_to_triangle_pdf(Vec2f{-0.1f, 0.6f}), 0);
  EXPECT_EQ(square_to_cosine_hemisphere_pdf(Vec3f{0, 0.6f, -0.8f}), 0);
  EXPECT_EQ(square_to_hemisphere_pdf(Vec3f{0, 0.6f, -0.8f}), 0);
  EXPECT_EQ(square_to_cone_pdf(Vec3f{0, 0.8f, 0.6f}, 0.7f), 0);
}

TEST(Warps, PacksAgreeWithFloatsLaneByLane) {
  const std::vector<Vec2f> u = awkward_points();
  const auto packs = direction_warps<Pack>();
  const auto floats = direction_warps<float>();
  for (std::size_t at = 0; at + pack_width <= u.size(); at += pack_width) {
    float x[pack_width], y[pack_width];
    for (std::size_t i = 0; i < pack_width; ++i) {
      x[i] = u[at + i].x;
      y[i] = u[at + i].y;
    }
    const Vec2<Pack> v{load(x), load(y)};
    const Vec2<Pack> triangle = square_to_triangle(v), disk = square_to_disk(v);
    for (std::size_t i = 0; i < pack_width; ++i) {
      EXPECT_FLOAT_EQ(lane(triangle.x, i), square_to_triangle(u[at + i]).x);
      EXPECT_NEAR(lane(disk.x, i), square_to_disk(u[at + i]).x, 1e-6);
      EXPECT_NEAR(lane(disk.y, i), square_to_disk(u[at + i]).y, 1e-6);
    }
    for (std::size_t k = 0; k < packs.size(); ++k) {
      const Vec3<Pack> w = packs[k].warp(v);
      const Pack pdf = packs[k].pdf(w);
      for (std::size_t i = 0; i < pack_width; ++i) {
        const Vec3f scalar = floats[k].warp(u[at + i]), in_lane{lane(w.x, i), lane(w.y, i), lane(w.z, i)};
        // Near the rim of the disk z is the root of a small difference: an error e in x gives sqrt(e) in z.
        EXPECT_LT(length(in_lane - scalar), 1e-3) << floats[k].name;
        EXPECT_NEAR(lane(pdf, i), floats[k].pdf(in_lane), 1e-6) << floats[k].name;
      }
    }
  }
}

} // namespace
} // namespace nacre
