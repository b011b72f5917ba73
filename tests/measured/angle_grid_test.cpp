#include "measured/angle_grid.h"

#include "analytic.h"
#include "core/error.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

namespace nacre {
namespace {

constexpr float hole = std::numeric_limits<float>::quiet_NaN();
constexpr double degree = pi / 180;

std::vector<double> steps(double from_deg, double to_deg, int n) {
  std::vector<double> nodes;
  for (int i = 0; i < n; ++i)
    nodes.push_back((from_deg + (to_deg - from_deg) * i / std::max(1, n - 1)) * degree);
  return nodes;
}

/// The function at every node, in `channels` multiples 1, 2, ...
template <class F>
AngleGrid tabulated(const AngleGrid::Nodes& nodes, F f, int channels = 1) {
  const std::size_t cells =
      nodes.theta_i.size() * nodes.phi_i.size() * nodes.theta_o.size() * nodes.phi_o.size();
  const AngleGrid frame(nodes, Channels::grey(), std::vector<float>(cells), "");
  std::vector<float> values;
  for (std::size_t i = 0; i < nodes.theta_i.size(); ++i)
    for (std::size_t j = 0; j < nodes.phi_i.size(); ++j)
      for (const double theta_o : nodes.theta_o)
        for (const double phi_o : nodes.phi_o) {
          auto [wo, wi] = frame.directions(i, j, theta_o, phi_o);
          if (nodes.transmits) wo.z = -wo.z;
          for (int c = 1; c <= channels; ++c)
            values.push_back(float(
                c * f(Vec3d{wo.x, wo.y, std::max(wo.z, 1e-3)}, Vec3d{wi.x, wi.y, std::max(wi.z, 1e-3)})));
        }
  return AngleGrid(nodes, channels == 3 ? Channels::rgb() : Channels::grey(), values, "test");
}

AngleGrid::Nodes isotropic_nodes(AngleGrid::Axis axis, bool mirrored) {
  AngleGrid::Nodes n;
  n.theta_i = steps(0, 90, 10);
  n.phi_i = {0};
  n.axis = axis;
  n.theta_o = axis == AngleGrid::Axis::normal
                  ? steps(0, 90, 19)
                  : std::vector<double>{0,           1 * degree,  3 * degree,   8 * degree,  20 * degree,
                                        45 * degree, 80 * degree, 110 * degree, 180 * degree};
  n.phi_o = mirrored ? steps(0, 180, 13) : steps(0, 345, 24);
  if (mirrored) n.mirror = AngleGrid::Mirror::plane_of_incidence;
  return n;
}
AngleGrid::Nodes anisotropic_nodes() {
  AngleGrid::Nodes n;
  n.theta_i = steps(0, 75, 6);
  n.phi_i = steps(0, 345, 24);
  n.theta_o = steps(0, 75, 6);
  n.phi_o = steps(0, 345, 24);
  n.holds_beyond_ends = true;
  return n;
}
std::vector<AngleGrid::Nodes> all_nodes() {
  std::vector<AngleGrid::Nodes> all{anisotropic_nodes()};
  for (const auto axis : {AngleGrid::Axis::normal, AngleGrid::Axis::specular})
    for (const bool mirrored : {false, true})
      all.push_back(isotropic_nodes(axis, mirrored));
  all.push_back(isotropic_nodes(AngleGrid::Axis::specular, true));
  all.back().transmits = true;
  all.back().theta_specular = all.back().theta_i;
  for (double& t : all.back().theta_specular)
    t = std::asin(std::sin(t) / 1.5);
  return all;
}
Vec3d scattered(const AngleGrid& grid, Vec3d wo) {
  if (grid.nodes().transmits) wo.z = -wo.z;
  return wo;
}

TEST(AngleGrid, LambertIsReproducedEverywhereInAllChannels) {
  for (const auto& nodes : all_nodes()) {
    const AngleGrid grid = tabulated(
        nodes, [](const Vec3d&, const Vec3d&) { return 0.25; }, 3);
    for (std::uint64_t n = 0; n < 2000; ++n) {
      std::array<float, 3> f;
      const Vec3d wo = scattered(grid, random_direction(2 * n, 89.9)), wi = random_direction(2 * n + 1, 89.9);
      ASSERT_TRUE(grid.evaluate(wo, wi, f)) << wo.x << ' ' << wo.y << ' ' << wo.z;
      EXPECT_FLOAT_EQ(f[0], 0.25f);
      EXPECT_FLOAT_EQ(f[1], 0.5f);
      EXPECT_FLOAT_EQ(f[2], 0.75f);
    }
  }
}

TEST(AngleGrid, NodesAreReproduced) {
  for (const auto& nodes : all_nodes()) {
    // Different at every node; poles are one value, as they are one direction.
    const AngleGrid grid = tabulated(nodes, Glossy{nodes.phi_i.size() > 1 ? 0.2 : 0.3, 0.3});
    const MeasuredSamples s = grid.samples();
    ASSERT_GT(s.size(), 100u);
    for (std::size_t n = 0; n < s.size(); ++n) {
      const auto wide = [](const Vec3f& w) { return Vec3d{double(w.x), double(w.y), double(w.z)}; };
      EXPECT_NEAR(grey(grid, wide(s.wo[n]), wide(s.wi[n])), s.f[n],
                  2e-3 * s.f[n]) // float directions at peaks
          << "sample " << n << " of " << grid.facts()[0].second;
    }
  }
}

TEST(AngleGrid, ErrorForGgxIsThatOfLinearInterpolation) {
  // Halving all steps divides the error by four; about the specular direction coarse incidences suffice.
  const auto error = [](AngleGrid::Axis axis, int n_i, int n_o, int n_p) {
    AngleGrid::Nodes nodes = isotropic_nodes(axis, true);
    nodes.theta_i = steps(0, 80, n_i);
    nodes.theta_o = steps(0, axis == AngleGrid::Axis::normal ? 80 : 170, n_o);
    nodes.phi_o = steps(0, 180, n_p);
    const Glossy f;
    const AngleGrid grid = tabulated(nodes, f);
    double sum = 0, norm = 0;
    for (std::uint64_t n = 0; n < 3000; ++n) {
      const Vec3d wo = random_direction(2 * n, 60), wi = random_direction(2 * n + 1, 60);
      sum += sqr(grey(grid, wo, wi) - f(wo, wi));
      norm += sqr(f(wo, wi));
    }
    return std::sqrt(sum / norm);
  };
  const double coarse = error(AngleGrid::Axis::normal, 17, 17, 19),
               fine = error(AngleGrid::Axis::normal, 33, 33, 37);
  EXPECT_LT(coarse, 0.04);
  EXPECT_NEAR(coarse / fine, 4, 0.8);
  EXPECT_LT(error(AngleGrid::Axis::specular, 9, 86, 19), 0.02);
  // The same incidences about the normal smear the highlight.
  EXPECT_GT(error(AngleGrid::Axis::normal, 9, 41, 19), 2 * error(AngleGrid::Axis::specular, 9, 86, 19));
}

TEST(AngleGrid, ValuesAreContinuousAcrossThePoleTheSeamAndTheMirror) {
  for (const auto& nodes : all_nodes()) {
    const AngleGrid grid = tabulated(nodes, Glossy{});
    const auto jump = [&](const Vec3d& o1, const Vec3d& o2, const Vec3d& wi) {
      const double a = grey(grid, scattered(grid, o1), wi), b = grey(grid, scattered(grid, o2), wi);
      return std::abs(a - b) / std::max(a, b);
    };
    for (int phi = 0; phi < 360; phi += 17) {
      const Vec3d wi = at_degrees(33, phi);
      for (int around = 0; around < 360; around += 40)
        EXPECT_LT(jump(at_degrees(1e-4, around), at_degrees(1e-4, around + 133), wi), 1e-3);
      for (const double azimuth : {0.0, 180.0})
        EXPECT_LT(jump(at_degrees(50, phi + azimuth - 1e-4), at_degrees(50, phi + azimuth + 1e-4), wi), 1e-3);
      EXPECT_LT(jump(at_degrees(33, phi + 180 - 1e-4), at_degrees(33.0001, phi + 180), wi), 1e-3); // specular
    }
    for (int phi = 0; grid.is_isotropic() && phi < 360; phi += 45)
      EXPECT_NEAR(grey(grid, scattered(grid, at_degrees(40, 10)), at_degrees(1e-4, phi)),
                  grey(grid, scattered(grid, at_degrees(40, 10)), {0, 0, 1}), 1e-4);
  }
}

TEST(AngleGrid, IsotropicGridsDoNotChangeWhenTurned) {
  for (const bool mirrored : {false, true}) {
    AngleGrid::Nodes nodes = isotropic_nodes(AngleGrid::Axis::normal, mirrored);
    const AngleGrid grid =
        tabulated(nodes, [](const Vec3d& wo, const Vec3d& wi) { return 1 + dot(wo, wi) + 0.1 * wo.y; });
    for (std::uint64_t n = 0; n < 300; ++n) {
      const Vec3d wo = random_direction(2 * n, 89), wi = random_direction(2 * n + 1, 89);
      const auto turned = [](const Vec3d& w) { return Vec3d{-w.y, w.x, w.z}; };
      EXPECT_NEAR(grey(grid, wo, wi), grey(grid, turned(wo), turned(wi)), 1e-5);
      const auto flipped = [](const Vec3d& w) { return Vec3d{w.x, -w.y, w.z}; };
      if (mirrored) {
        EXPECT_NEAR(grey(grid, wo, wi), grey(grid, flipped(wo), flipped(wi)), 1e-5);
      }
    }
  }
}

TEST(AngleGrid, AnotherAzimuthOfTheSampleIsAnotherValue) {
  const AngleGrid grid = tabulated(anisotropic_nodes(), Glossy{0.1, 0.5});
  EXPECT_FALSE(grid.is_isotropic());
  const Glossy f{0.1, 0.5};
  for (const double phi : {0.0, 90.0, 30.0}) {
    const Vec3d wo = at_degrees(45, phi + 180), wi = at_degrees(30, phi);
    EXPECT_NEAR(grey(grid, wo, wi), f(wo, wi), 1e-3 * f(wo, wi));
  }
}

TEST(AngleGrid, MirroredSamplesAreLookedUpAtTheMirroredAzimuth) {
  AngleGrid::Nodes nodes = anisotropic_nodes();
  nodes.phi_o = steps(0, 180, 13);
  nodes.mirror = AngleGrid::Mirror::sample;
  const AngleGrid grid = tabulated(nodes, Glossy{0.1, 0.5});
  const Vec3d wi = at_degrees(30, 30), wo = at_degrees(45, 60);
  const auto flipped = [](const Vec3d& w) { return Vec3d{w.x, -w.y, w.z}; };
  EXPECT_NEAR(grey(grid, wo, wi), grey(grid, flipped(wo), flipped(wi)), 1e-6);
  EXPECT_GT(std::abs(grey(grid, at_degrees(45, 0), wi) - grey(grid, wo, wi)), 1e-4);
}

TEST(AngleGrid, HolesTakeNoPartAndStayWhereNothingElseIs) {
  AngleGrid::Nodes nodes;
  nodes.theta_i = steps(0, 80, 2);
  nodes.phi_i = {0};
  nodes.theta_o = steps(10, 70, 4); // 10, 30, 50, 70
  nodes.phi_o = steps(0, 270, 4);
  std::vector<float> values(2 * 4 * 4, 2.0f);
  for (int i = 0; i < 2; ++i)
    for (int l = 0; l < 4; ++l) {
      values[i * 16 + 1 * 4 + l] = hole;
      values[i * 16 + 2 * 4 + l] = hole;
    }
  const AngleGrid grid(nodes, Channels::grey(), values, "test");
  EXPECT_EQ(grid.hole_count(), 16u);
  EXPECT_EQ(grid.samples().size(), 16u);
  EXPECT_EQ(grey(grid, at_degrees(20, 5), at_degrees(20, 0)), 2);
  EXPECT_EQ(grey(grid, at_degrees(40, 5), at_degrees(20, 0)), -1);
  EXPECT_EQ(grey(grid, at_degrees(60, 5), at_degrees(20, 0)), 2);
  // Beyond the nodes nothing is known.
  EXPECT_EQ(grey(grid, at_degrees(75, 5), at_degrees(20, 0)), -1);
  EXPECT_EQ(grey(grid, at_degrees(5, 5), at_degrees(20, 0)), -1);
  EXPECT_EQ(grey(grid, at_degrees(20, 5), at_degrees(85, 0)), -1);
}

TEST(AngleGrid, AWideGapBetweenAzimuthsIsAHole) {
  AngleGrid::Nodes nodes = isotropic_nodes(AngleGrid::Axis::normal, false);
  nodes.phi_o = steps(150, 210, 7);
  const AngleGrid grid = tabulated(nodes, Glossy{});
  EXPECT_GT(grey(grid, at_degrees(30, 195), at_degrees(30, 0)), 0);
  EXPECT_GT(grey(grid, at_degrees(30, 210), at_degrees(30, 0)), 0);
  EXPECT_EQ(grey(grid, at_degrees(30, 90), at_degrees(30, 0)), -1);
  EXPECT_EQ(grey(grid, at_degrees(30, 215), at_degrees(30, 0)), -1);
}

TEST(AngleGrid, BothEndsOfATurnAreOneNode) {
  AngleGrid::Nodes nodes;
  nodes.theta_i = {0.5};
  nodes.phi_i = {0};
  nodes.theta_o = {0.5};
  nodes.phi_o = steps(0, 360, 5);
  const AngleGrid grid(nodes, Channels::grey(), {1, 2, 3, 4, hole}, "test");
  EXPECT_EQ(grid.nodes().phi_o.size(), 4u);
  const double deg = 0.5 / degree;
  EXPECT_FLOAT_EQ(float(grey(grid, at_degrees(deg, 0), at_degrees(deg, 0))), 1);
  EXPECT_FLOAT_EQ(float(grey(grid, at_degrees(deg, 315), at_degrees(deg, 0))), 2.5f);
  const AngleGrid both(nodes, Channels::grey(), {1, 2, 3, 4, 3}, "test");
  EXPECT_FLOAT_EQ(float(grey(both, at_degrees(deg, 0), at_degrees(deg, 0))), 2);
}

TEST(AngleGrid, AlbedoOfLambertIsItsReflectance) {
  for (auto nodes : all_nodes()) {
    if (nodes.theta_i.back() > 89 * degree) nodes.theta_i.pop_back();
    if (!nodes.theta_specular.empty()) nodes.theta_specular.resize(nodes.theta_i.size());
    const AngleGrid grid = tabulated(nodes, [](const Vec3d&, const Vec3d&) { return 0.5 * inv_pi; });
    for (std::size_t i = 0; i < nodes.theta_i.size(); i += 3)
      EXPECT_NEAR(grid.albedo(i, 0)[0], 0.5, 0.01) << grid.facts()[0].second;
  }
}

TEST(AngleGrid, NodesThatMakeNoGridAreErrors) {
  const auto fails = [](auto change, std::size_t values = 1) {
    AngleGrid::Nodes nodes{{0.1}, {0}, {0.2}, {0}};
    change(nodes);
    EXPECT_THROW(AngleGrid(nodes, Channels::grey(), std::vector<float>(values, 1.0f), ""), Error);
  };
  EXPECT_NO_THROW(AngleGrid({{0.1}, {0}, {0.2}, {0}}, Channels::grey(), {1.0f}, ""));
  fails([](auto& n) { n.theta_i = {}; }, 0);
  fails([](auto& n) { n.theta_i = {0.2, 0.1}; }, 2);
  fails([](auto& n) { n.theta_i = {1.7}; });
  fails([](auto& n) { n.theta_o = {std::nan("")}; });
  fails([](auto& n) { n.phi_o = {0, 6.5}; }, 2);
  fails([](auto& n) { n.theta_specular = {0.1, 0.2}; });
  fails([](auto&) {}, 2);
  EXPECT_THROW(
      AngleGrid({{0.1}, {0}, {0.2}, {0}}, Channels::grey(), {std::numeric_limits<float>::infinity()}, ""),
      Error);
}

} // namespace
} // namespace nacre
