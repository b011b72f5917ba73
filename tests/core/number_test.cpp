#include "core/dual.h"

#include "core/random.h"

#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

namespace nacre {
namespace {

using D = Dual<double, 2>;
using P = Dual<Pack, 2>;

// Every function of dual.h of one and of two arguments, in one text for every number type.
struct OfOne {
  std::string name;
  double lo, hi; // where it is smooth
  double (*at_double)(double);
  D (*at_dual)(D);
  P (*at_pack)(P);
};
struct OfTwo {
  std::string name;
  double lo, hi;
  double (*at_double)(double, double);
  D (*at_dual)(D, D);
  P (*at_pack)(P, P);
};
#define ONE(name, lo, hi, expression)                                                                        \
  OfOne {                                                                                                    \
    name, lo, hi, [](double x) -> double { return expression; }, [](D x) -> D { return expression; },        \
        [](P x) -> P { return expression; }                                                                  \
  }
#define TWO(name, lo, hi, expression)                                                                        \
  OfTwo {                                                                                                    \
    name, lo, hi, [](double x, double y) -> double { return expression; },                                   \
        [](D x, D y) -> D { return expression; }, [](P x, P y) -> P { return expression; }                   \
  }

std::vector<OfOne> functions_of_one() {
  return {ONE("-x", -2, 2, -x),
          ONE("x + c", -2, 2, x + 0.5f),
          ONE("c + x", -2, 2, 2 + x),
          ONE("x - c", -2, 2, x - 0.5f),
          ONE("c - x", -2, 2, 2 - x),
          ONE("x * c", -2, 2, x * 3),
          ONE("c * x", -2, 2, 0.25f * x),
          ONE("x / c", -2, 2, x / 4),
          ONE("c / x", 0.3, 2, 2 / x),
          ONE("sqr", -2, 2, sqr(x)),
          ONE("abs below 0", -2, -0.1, abs(x)),
          ONE("abs above 0", 0.1, 2, abs(x)),
          ONE("floor", 1.1, 1.9, floor(x)),
          ONE("sqrt", 0.1, 4, sqrt(x)),
          ONE("safe_sqrt", 0.1, 4, safe_sqrt(x)),
          ONE("exp", -3, 3, exp(x)),
          ONE("log", 0.1, 5, log(x)),
          ONE("sin", -6, 6, sin(x)),
          ONE("cos", -6, 6, cos(x)),
          ONE("tan", -1.2, 1.2, tan(x)),
          ONE("asin", -0.9, 0.9, asin(x)),
          ONE("acos", -0.9, 0.9, acos(x)),
          ONE("atan", -3, 3, atan(x)),
          ONE("sinh", -2, 2, sinh(x)),
          ONE("cosh", -2, 2, cosh(x)),
          ONE("erf", -2, 2, erf(x)),
          ONE("pow to a constant", 0.2, 3, pow(x, 2.5f)),
          ONE("clamp inside", 0.1, 0.9, clamp(x, 0.0f, 1.0f)),
          ONE("clamp outside", 1.1, 2, clamp(x, 0.0f, 1.0f)),
          ONE("select on a comparison", 0.1, 2, select(x > 0.05f, x * x, x))};
}
std::vector<OfTwo> functions_of_two() {
  return {TWO("x + y", -2, 2, x + y),
          TWO("x - y", -2, 2, x - y),
          TWO("x * y", -2, 2, x * y),
          TWO("x / y", 0.3, 2, x / y),
          TWO("x += y and its kin", 0.3, 2, ([&] {
                auto z = x;
                z += y;
                z *= x;
                z -= y;
                z /= y;
                z += 1;
                z *= 2;
                return z;
              }())),
          TWO("min", 0.3, 2, min(x, y)),
          TWO("max", 0.3, 2, max(x, y)),
          TWO("atan2", 0.2, 2, atan2(x, y)),
          TWO("atan2 of the left half-plane", 0.2, 2, atan2(x, -y)),
          TWO("pow", 0.3, 2, pow(x, y)),
          TWO("a composition", 0.3, 2, exp(-sqr(x / y)) / (1 + sqrt(x * y)) + sin(x) * log(y))};
}
#undef ONE
#undef TWO

constexpr int points = 40;
double point(double lo, double hi, int i, int axis) { return lo + (hi - lo) * unit_double(hash(i, axis)); }

// A central difference with step 1e-5 is good to about 1e-10 times the third derivative, and 1e-11 of
// rounding.
constexpr double step = 1e-5, difference_tolerance = 1e-7;

TEST(Dual, DerivativesOfOneArgumentMatchDifferences) {
  for (const OfOne& f : functions_of_one())
    for (int i = 0; i < points; ++i) {
      const double x = point(f.lo, f.hi, i, 0);
      const double slope = (f.at_double(x + step) - f.at_double(x - step)) / (2 * step);
      // x itself depends on the two parameters with slopes 1 and -3: the chain rule carries both.
      D argument(x);
      argument.d = {1, -3};
      const D y = f.at_dual(argument);
      ASSERT_NEAR(y.v, f.at_double(x), 1e-14 * (1 + std::abs(y.v))) << f.name << " at " << x;
      ASSERT_NEAR(y.d[0], slope, difference_tolerance * (1 + std::abs(slope))) << f.name << " at " << x;
      ASSERT_DOUBLE_EQ(y.d[1], -3 * y.d[0]) << f.name << " at " << x;
    }
}

TEST(Dual, DerivativesOfTwoArgumentsMatchDifferences) {
  for (const OfTwo& f : functions_of_two())
    for (int i = 0; i < points; ++i) {
      const double x = point(f.lo, f.hi, i, 0), y = point(f.lo, f.hi, i, 1);
      const double dx = (f.at_double(x + step, y) - f.at_double(x - step, y)) / (2 * step);
      const double dy = (f.at_double(x, y + step) - f.at_double(x, y - step)) / (2 * step);
      const D z = f.at_dual(D::variable(x, 0), D::variable(y, 1));
      ASSERT_NEAR(z.v, f.at_double(x, y), 1e-14 * (1 + std::abs(z.v))) << f.name << " at " << x << ", " << y;
      ASSERT_NEAR(z.d[0], dx, difference_tolerance * (1 + std::abs(dx)))
          << f.name << " at " << x << ", " << y;
      ASSERT_NEAR(z.d[1], dy, difference_tolerance * (1 + std::abs(dy)))
          << f.name << " at " << x << ", " << y;
    }
}

// Single precision against double: 24 bits, some operations deep.
constexpr double single_tolerance = 4e-6;

TEST(Dual, PacksAgreeWithDoublesLaneByLane) {
  const auto expect_lane = [](const P& pack, std::size_t i, const D& reference, const std::string& what) {
    EXPECT_NEAR(lane(pack.v, i), reference.v, single_tolerance * (1 + std::abs(reference.v))) << what;
    for (int k = 0; k < 2; ++k)
      EXPECT_NEAR(lane(pack.d[k], i), reference.d[k], single_tolerance * (1 + std::abs(reference.d[k])))
          << what << " derivative " << k;
  };
  float x[pack_width], y[pack_width];
  const auto fill = [&](double lo, double hi, int round) {
    for (std::size_t i = 0; i < pack_width; ++i) {
      x[i] = static_cast<float>(point(lo, hi, static_cast<int>(i) + 100 * round, 0));
      y[i] = static_cast<float>(point(lo, hi, static_cast<int>(i) + 100 * round, 1));
    }
  };
  for (int round = 0; round < 5; ++round) {
    for (const OfOne& f : functions_of_one()) {
      fill(f.lo, f.hi, round);
      const P z = f.at_pack(P::variable(load(x), 1));
      for (std::size_t i = 0; i < pack_width; ++i)
        expect_lane(z, i, f.at_dual(D::variable(x[i], 1)), f.name + " at " + std::to_string(x[i]));
    }
    for (const OfTwo& f : functions_of_two()) {
      fill(f.lo, f.hi, round);
      const P z = f.at_pack(P::variable(load(x), 0), P::variable(load(y), 1));
      for (std::size_t i = 0; i < pack_width; ++i)
        expect_lane(z, i, f.at_dual(D::variable(x[i], 0), D::variable(y[i], 1)), f.name);
    }
  }
}

// The guard every model uses: make the argument harmless where its branch is discarded.
template <class R>
R guarded(const R& x) {
  const auto inside = x > R(0);
  const R safe = select(inside, x, R(1));
  return select(inside, log(safe) + R(1) / safe + sqrt(safe), x * R(2));
}

TEST(Select, DiscardedBranchMakesNoNaNDerivative) {
  for (const double x : {-1.0, 0.0, 0.5}) {
    const D y = guarded(D::variable(x, 0));
    EXPECT_TRUE(isfinite(y));
    EXPECT_DOUBLE_EQ(y.d[0], x > 0 ? 1 / x - 1 / (x * x) + 0.5 / std::sqrt(x) : 2);
    EXPECT_EQ(y.d[1], 0);
  }
  float lanes[pack_width];
  for (std::size_t i = 0; i < pack_width; ++i)
    lanes[i] = static_cast<float>(i % 3) - 1; // -1, 0, 1
  const P y = guarded(P::variable(load(lanes), 0));
  EXPECT_TRUE(all(isfinite(y)));
  for (std::size_t i = 0; i < pack_width; ++i)
    EXPECT_FLOAT_EQ(lane(y.d[0], i), i % 3 == 2 ? 0.5f : 2.0f);
}

TEST(Select, TakesTheArmOfEachLane) {
  float lanes[pack_width];
  for (std::size_t i = 0; i < pack_width; ++i)
    lanes[i] = static_cast<float>(i);
  const Pack x = load(lanes), y = select(x < Pack(3.0f), x, -x);
  for (std::size_t i = 0; i < pack_width; ++i)
    EXPECT_EQ(lane(y, i), i < 3 ? lanes[i] : -lanes[i]);
  EXPECT_TRUE(any(x < Pack(1.0f)));
  EXPECT_FALSE(all(x < Pack(1.0f)));
  EXPECT_EQ(select(true, 1.0f, 2), 1.0f);
  EXPECT_EQ(select(false, 1.0, 2), 2.0);
}

TEST(SafeSqrt, IsZeroWithZeroSlopeAtAndBelowZero) {
  EXPECT_EQ(safe_sqrt(-1.0f), 0);
  EXPECT_EQ(safe_sqrt(0.0), 0);
  EXPECT_EQ(safe_sqrt(4.0), 2);
  EXPECT_EQ(safe_sqrt(std::numeric_limits<double>::quiet_NaN()), 0);
  for (const double x : {-3.0, -1e-300, 0.0}) {
    const D y = safe_sqrt(D::variable(x, 0));
    EXPECT_EQ(y.v, 0);
    EXPECT_EQ(y.d[0], 0);
  }
  const P y = safe_sqrt(P::variable(Pack(-1.0f), 0));
  EXPECT_TRUE(all(isfinite(y)));
}

TEST(Constant, KeepsTheFullPrecisionOfItsType) {
  EXPECT_EQ(constant<double>(pi), pi);
  EXPECT_EQ((constant<Dual<double, 3>>(pi).v), pi);
  EXPECT_EQ(constant<float>(pi), static_cast<float>(pi));
  EXPECT_EQ(lane(constant<Pack>(pi), 0), static_cast<float>(pi));
  EXPECT_EQ(lane(constant<P>(pi).v, 0), static_cast<float>(pi));
}

TEST(Dual, ComparesValuesAlone) {
  const D a = D::variable(1.0, 0), b = D::variable(2.0, 1);
  EXPECT_TRUE(a < b && b > a && a <= b && b >= a && a != b && a == D(1.0));
  EXPECT_TRUE(a < 2 && 0.5 < a && a == 1.0f && a >= 1 && !(a > 1));
  EXPECT_EQ(value(a), 1.0);
}

TEST(Dual, IsFiniteLooksAtDerivativesToo) {
  D x = D::variable(1.0, 0);
  EXPECT_TRUE(isfinite(x));
  x.d[1] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(isfinite(x));
  EXPECT_FALSE(isfinite(D(std::numeric_limits<double>::quiet_NaN())));
}

TEST(Dual, MixesWithPlainNumbersInMinAndMax) {
  const D x = D::variable(0.5, 0);
  EXPECT_EQ(max(x, 0).d[0], 1);
  EXPECT_EQ(max(x, 1.0).d[0], 0);
  EXPECT_EQ(min(x, 1.0f).d[0], 1);
  EXPECT_EQ(min(x, 0.25).v, 0.25);
}

TEST(Dual, StartsAtZeroInPacks) {
  const P x;
  for (std::size_t i = 0; i < pack_width; ++i) {
    EXPECT_EQ(lane(x.v, i), 0);
    EXPECT_EQ(lane(x.d[1], i), 0);
  }
  const P three(3);
  EXPECT_EQ(lane(three.v, pack_width - 1), 3) << "every lane, not the first alone";
}

TEST(Gather, ReadsTheTableAtEachLane) {
  float table[64], index[pack_width];
  for (int i = 0; i < 64; ++i)
    table[i] = static_cast<float>(i * i);
  for (std::size_t i = 0; i < pack_width; ++i)
    index[i] = static_cast<float>((i * 29 + 5) % 64);
  const Pack got = gather(table, load(index));
  for (std::size_t i = 0; i < pack_width; ++i)
    EXPECT_EQ(lane(got, i), index[i] * index[i]);
  EXPECT_EQ(gather(table, 7.0f), 49);
  EXPECT_EQ(gather(table, 7.0), 49);
  float out[pack_width];
  store(out, got);
  EXPECT_EQ(out[1], lane(got, 1));
}

} // namespace
} // namespace nacre
