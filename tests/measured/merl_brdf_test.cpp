#include "measured/merl_brdf.h"

#include "core/random.h"
#include "core/warp.h"
#include "measured/synthetic_tables.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

static_assert(ScatteringModel<MerlBrdf<float, 1>> && ScatteringModel<MerlBrdf<float, 3>> &&
              ScatteringModel<MerlBrdf<float, 4>> && ScatteringModel<MerlBrdf<double, 3>> &&
              ScatteringModel<MerlBrdf<Pack, 3>> && ScatteringModel<MerlBrdf<Pack, 4>>);

double random(int i, int d) { return unit_double(hash(11, i, d)); }
Vec3d random_direction(int i, int d) {
  return square_to_hemisphere(Vec2<double>{random(i, d), random(i, d + 1)});
}

TEST(MerlInterpolation, ReturnsEveryNodesValueAtItsNode) {
  const MerlTable table =
      MerlTable::tabulate(9, 8, 10, [](double h, double d, double p) -> std::array<double, 3> {
        return {1 + std::sin(40 * h), 1 + std::sin(30 * d), 1 + std::sin(50 * p)};
      });
  for (int i = 0; i < 9; ++i)
    for (int j = 0; j < 8; ++j)
      for (int k = 0; k < 10; ++k)
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(table.interpolate(table.node(i, j, k))[c], table.cell(i, j, k)[c], 1e-13);
}

TEST(MerlInterpolation, IsExactForFunctionsMultilinearInTheTablesCoordinates) {
  const auto f = [](double h, double d, double p) -> std::array<double, 3> {
    const double x = std::sqrt(h);
    return {2 + x - d + 0.2 * p, 1 + 3 * x * d, 1 + x * d * p};
  };
  const MerlTable table = MerlTable::tabulate(9, 8, 10, f);
  for (int i = 0; i < 3000; ++i) {
    const HalfDifference<double> a{table.theta_h(8) * random(i, 0), table.theta_d(7) * random(i, 1),
                                   table.phi_d(9) * random(i, 2)};
    const auto expected = f(a.theta_h, a.theta_d, a.phi_d);
    const auto found = table.interpolate(a);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(found[c], expected[c], 1e-6 * expected[c]); // entries are floats: 2^-24
  }
}

TEST(MerlInterpolation, IsPeriodicAndContinuousInPhiD) {
  const MerlTable half = glossy_table(0.3, 9, 10);
  for (int i = 0; i < 500; ++i) {
    HalfDifference<double> a{1.5 * random(i, 0), 1.5 * random(i, 1), 20 * random(i, 2) - 10}, b = a;
    b.phi_d += pi;
    EXPECT_NEAR(half.interpolate(a)[0], half.interpolate(b)[0], 1e-12);
    a.phi_d = -1e-12, b.phi_d = 1e-12;
    EXPECT_NEAR(half.interpolate(a)[0], half.interpolate(b)[0], 1e-9);
  }
  const MerlTable full =
      MerlTable::tabulate(2, 2, 360, [](double, double, double p) -> std::array<double, 3> {
        return {1 + std::cos(p), 0, 0};
      });
  EXPECT_NEAR(full.interpolate(HalfDifference<double>{0.1, 0.1, pi})[0], 0, 1e-6);
  EXPECT_NEAR(full.interpolate(HalfDifference<double>{0.1, 0.1, -pi / 2})[0], 1, 1e-6);
}

TEST(MerlInterpolation, LastNodeHoldsBeyondItself) {
  const MerlTable table = glossy_table(0.8, 6, 8);
  EXPECT_EQ(table.interpolate(HalfDifference<double>{pi / 2, pi / 2, 0})[0], double(table.cell(5, 5, 0)[0]));
  const MerlTable one = MerlTable::tabulate(1, 1, 1, [](double, double, double) -> std::array<double, 3> {
    return {1, 2, 3};
  });
  EXPECT_EQ(one.interpolate(HalfDifference<double>{1, 1, 3})[2], 3);
}

TEST(MerlInterpolation, HolesTakeNoPartAndGiveZeroWhereNothingElseIs) {
  // A constant stays that constant whatever is missing, as the weights are scaled to sum to 1.
  const MerlTable holes =
      MerlTable::tabulate(8, 8, 8, [](double h, double d, double p) -> std::array<double, 3> {
        const bool missing = std::fmod(1e4 * h + 7e3 * d + 3e3 * p, 2.0) < 1 || h > 1.0;
        return missing ? std::array<double, 3>{-1, 5, 5} : std::array<double, 3>{0.7, 0.7, 0.7};
      });
  ASSERT_GT(holes.hole_count(), 100u);
  int zero = 0, constant_found = 0;
  for (int i = 0; i < 5000; ++i) {
    const HalfDifference<double> a{pi / 2 * random(i, 0), pi / 2 * random(i, 1), pi * random(i, 2)};
    const double f = holes.interpolate(a)[1];
    if (f == 0)
      ++zero;
    else {
      ++constant_found;
      EXPECT_NEAR(f, 0.7f, 1e-12);
    }
  }
  EXPECT_GT(zero, 50);
  EXPECT_GT(constant_found, 1000);
  EXPECT_EQ(holes.interpolate(HalfDifference<double>{1.5, 0.3, 0.3})[0], 0);
}

TEST(MerlInterpolation, WeightsOfACellWithOneHoleAreRenormalised) {
  // Two nodes along theta_d of one cell; the point lies a quarter of the way to the hole.
  const MerlTable table(1, 2, 1, {{4, 4, 4, 1}, {0, 0, 0, 0}});
  EXPECT_NEAR(table.interpolate(HalfDifference<double>{0, pi / 16, 0})[0], 4, 1e-14);
  const MerlTable plain(1, 2, 1, {{4, 4, 4, 1}, {8, 8, 8, 1}});
  EXPECT_NEAR(plain.interpolate(HalfDifference<double>{0, pi / 16, 0})[0], 5, 1e-14);
}

TEST(MerlBrdf, IsReciprocal) {
  const MerlBrdf<double, 3> model(&published_table("alum-bronze"));
  for (int i = 0; i < 5000; ++i) {
    const Vec3d wo = random_direction(i, 0), wi = random_direction(i, 2);
    const auto f = model.eval(wo, wi), exchanged = model.eval(wi, wo);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(f[c], exchanged[c], 1e-10 * f[c] + 1e-14);
  }
}

TEST(MerlBrdf, IsZeroBelowTheSurface) {
  const MerlTable table = diffuse_table();
  const MerlBrdf<float, 3> model(&table);
  const Vec3f up = normalize(Vec3f{0.2f, 0.1f, 1}), down{up.x, up.y, -up.z};
  EXPECT_GT(model.eval(up, up)[0], 0);
  EXPECT_EQ(model.eval(up, down)[0], 0);
  EXPECT_EQ(model.eval(down, up)[0], 0);
  EXPECT_EQ(model.pdf(up, down), 0);
  EXPECT_EQ(model.pdf(down, up), 0);
  EXPECT_EQ(model.sample(down, 0.5f, {0.5f, 0.5f}).pdf, 0);
  EXPECT_EQ(model.sample(down, 0.01f, {0.5f, 0.5f}).pdf, 0);
}

TEST(MerlBrdf, DirectionsThatAreNoNumbersReadNothingOutsideTheTable) {
  const MerlTable table = glossy_table(0.3, 5, 6);
  const MerlBrdf<float, 3> model(&table);
  const MerlBrdf<double, 3> reference(&table);
  const MerlBrdf<Pack, 3> wide(&table);
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e30, 0.0})
    for (int c = 0; c < 3; ++c) {
      Vec3d wo{0.6, 0, 0.8};
      (c == 0 ? wo.x : c == 1 ? wo.y : wo.z) = bad;
      const Vec3d wi{0, 0.6, 0.8};
      model.eval(vec3<float>(wo), vec3<float>(wi));
      model.pdf(vec3<float>(wo), vec3<float>(wi));
      model.sample(vec3<float>(wo), 0.95f, {0.3f, 0.7f});
      reference.eval(wo, wi);
      reference.pdf(wo, wi);
      reference.sample(wo, 0.95, {0.3, 0.7});
      wide.eval(vec3<Pack>(wo), vec3<Pack>(wi));
      wide.pdf(vec3<Pack>(wo),
               vec3<Pack>(wi)); // the test is that the sanitizer build, or a crash, says nothing
    }
}

TEST(MerlBrdf, ChannelsAreTheBasisTimesTheTablesRgb) {
  const MerlTable table = glossy_table();
  const Vec3d wo = spherical_direction(0.5, 0.0), wi = spherical_direction(0.6, 2.5);
  const auto rgb = MerlBrdf<double, 3>(&table).eval(wo, wi);
  EXPECT_NEAR((MerlBrdf<double, 1>(&table).eval(wo, wi)[0]),
              0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2], 1e-12);
  MerlBrdf<double, 4> four(&table);
  for (int c = 0; c < 3; ++c)
    for (int w = 0; w < 4; ++w)
      four.basis[c][w] = 1 + c + 0.1 * w;
  for (int w = 0; w < 4; ++w)
    EXPECT_NEAR(four.eval(wo, wi)[w],
                (1 + 0.1 * w) * rgb[0] + (2 + 0.1 * w) * rgb[1] + (3 + 0.1 * w) * rgb[2], 1e-12);
}

TEST(MerlBrdf, NumberTypesAgree) {
  const MerlTable smooth = glossy_table(0.4);
  const MerlBrdf<double, 3> in_double(&smooth);
  const MerlBrdf<float, 3> in_float(&smooth);
  const MerlBrdf<Pack, 3> in_pack(&smooth);
  const int packs = 400;
  int pdf_differs = 0;
  for (int n = 0; n < packs; ++n) {
    float a[6][pack_width];
    std::vector<Vec3d> wo(pack_width), wi(pack_width);
    for (std::size_t l = 0; l < pack_width; ++l) {
      const int i = n * pack_width + l;
      wo[l] = random_direction(i, 0), wi[l] = random_direction(i, 2);
      if (i % 7 == 0) wi[l].z = -wi[l].z;
      if (i % 11 == 0) wi[l] = wo[l];
      if (i % 13 == 0) wo[l] = {0, 0, 1};
      if (i % 17 == 0) wi[l] = {-wo[l].x, -wo[l].y, wo[l].z};
      const double values[6] = {wo[l].x, wo[l].y, wo[l].z, wi[l].x, wi[l].y, wi[l].z};
      for (int c = 0; c < 6; ++c)
        a[c][l] = static_cast<float>(values[c]);
    }
    const Vec3<Pack> wo_pack{load(a[0]), load(a[1]), load(a[2])}, wi_pack{load(a[3]), load(a[4]), load(a[5])};
    const auto f_pack = in_pack.eval(wo_pack, wi_pack);
    const Pack pdf_pack = in_pack.pdf(wo_pack, wi_pack);
    for (std::size_t l = 0; l < pack_width; ++l) {
      const auto f = in_double.eval(wo[l], wi[l]);
      const auto f_float = in_float.eval(vec3<float>(wo[l]), vec3<float>(wi[l]));
      for (int c = 0; c < 3; ++c) {
        // Coordinates are good to about 1e-6 of a cell's width times its index; the slope of f does the rest.
        EXPECT_NEAR(f_float[c], f[c], 2e-4 * f[c]);
        EXPECT_NEAR(lane(f_pack[c], l), f[c], 2e-4 * f[c]);
      }
      // The density is constant a cell: directions on a boundary may fall to either side.
      const double p = in_double.pdf(wo[l], wi[l]);
      const double p_float = in_float.pdf(vec3<float>(wo[l]), vec3<float>(wi[l])), p_pack = lane(pdf_pack, l);
      EXPECT_EQ(p == 0, p_pack == 0);
      pdf_differs += std::abs(p_float - p) > 1e-3 * p || std::abs(p_pack - p) > 1e-3 * p;
    }
  }
  EXPECT_LT(pdf_differs, packs * static_cast<int>(pack_width) / 200);
}

} // namespace
} // namespace nacre
