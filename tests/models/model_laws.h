#pragma once
// What holds for every model of the list: the same value through every number type, exact and finite
// derivatives, finite values at the corners of domain and directions, and the laws that it claims. The build
// makes one source a header of bsdf/models that includes this and says NACRE_TEST_MODEL for its models.

#include "core/dual.h"
#include "core/random.h"
#include "validate/validate.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace nacre {

/// A model as a template, for a typed test.
template <template <class, int> class M>
struct Family {
  template <class R, int C>
  using Model = M<R, C>;
};

template <class F>
class ModelNumbers : public testing::Test {};
TYPED_TEST_SUITE_P(ModelNumbers);
template <class F>
class ModelLaws : public testing::Test {};
TYPED_TEST_SUITE_P(ModelLaws);
template <class F>
class LongModelLaws : public testing::Test {};
TYPED_TEST_SUITE_P(LongModelLaws);

namespace model_laws {

constexpr std::uint64_t seed = 7;
inline double random(int i, int d) { return unit_double(hash(seed, i, d)); }

/// One number a declared parameter, at share u(k) of its domain, evenly in the logarithm where that spans
/// more than a decade above 0; a float, inside the domain.
template <class M, class Share>
std::vector<double> at_share(Share u) {
  std::vector<double> values;
  for_each_parameter<M>([&](const auto& p) {
    const double t = u(int(values.size()));
    const double x =
        p.lo > 0 && p.hi > 10 * p.lo ? p.lo * std::pow(p.hi / p.lo, t) : p.lo + (p.hi - p.lo) * t;
    float y = float(std::clamp(x, p.lo, p.hi));
    if (double(y) < p.lo) y = std::nextafter(y, 1e30f);
    if (double(y) > p.hi) y = std::nextafter(y, -1e30f);
    values.push_back(p.fitted ? double(y) : p.initial);
  });
  return values;
}

/// The model of these values, the same in every channel.
template <class M>
M make(const std::vector<double>& values) {
  M model;
  std::size_t next = 0;
  for_each_parameter<M>([&](const auto& p) {
    using T = std::remove_reference_t<decltype(model.*p.member)>;
    model.*p.member = T(constant<typename M::Number>(values[next++]));
  });
  return model;
}
/// The same with parameter k as the variable of its dual numbers.
template <class M>
M make_dual(const std::vector<double>& values, int k) {
  using R = typename M::Number;
  M model;
  int next = 0;
  for_each_parameter<M>([&](const auto& p) {
    using T = std::remove_reference_t<decltype(model.*p.member)>;
    const auto x = constant<value_t<R>>(values[std::size_t(next)]);
    model.*p.member = T(next == k ? R::variable(x, 0) : R(x));
    ++next;
  });
  return model;
}

template <class M>
std::string describe(const std::vector<double>& values) {
  std::string text(M::name);
  std::size_t next = 0;
  for_each_parameter<M>([&](const auto& p) {
    text += fmt::format("{}{}={:.9g}", next == 0 ? ':' : ',', p.name, values[next]);
    ++next;
  });
  return text;
}

struct Pair {
  Vec3d wo, wi;
  std::string text() const {
    return fmt::format(" wo=({:.9g} {:.9g} {:.9g}) wi=({:.9g} {:.9g} {:.9g})", wo.x, wo.y, wo.z, wi.x, wi.y,
                       wi.z);
  }
};
inline Vec3d in_double(const Vec3f& w) { return {w.x, w.y, w.z}; }
/// 5 to 75 degrees from the normal; half near the mirror direction; for transmission some from below.
inline Pair random_pair(int i, bool transmits) {
  const auto angle = [&](int d) { return (5 + 70 * random(i, d)) * pi / 180; };
  Pair p{spherical_direction(angle(0), 2 * pi * random(i, 1)),
         spherical_direction(angle(2), 2 * pi * random(i, 3))};
  if (i % 2) p.wi = normalize(Vec3d{-p.wo.x, -p.wo.y, p.wo.z} + 0.2 * p.wi);
  if (transmits && i % 3 == 0) p.wi.z = -p.wi.z;
  if (transmits && i % 4 == 0) p.wo.z = -p.wo.z;
  // As floats, so that every number type is given the same directions.
  p.wo = in_double(vec3<float>(p.wo));
  p.wi = in_double(vec3<float>(p.wi));
  return p;
}
template <class M>
std::vector<double> random_parameters(int i) {
  return at_share<M>([&](int k) { return 0.1 + 0.8 * random(i, 100 + k); });
}

/// The corners of the domain: all numbers low, all high, each alone at an end, and the defaults.
template <class M>
std::vector<std::vector<double>> corners() {
  std::vector<std::vector<double>> all;
  std::vector<double> lo, hi, initial;
  for_each_parameter<M>(
      [&](const auto& p) { lo.push_back(p.lo), hi.push_back(p.hi), initial.push_back(p.initial); });
  all = {lo, hi, initial};
  for (std::size_t k = 0; k < initial.size(); ++k)
    for (const auto& end : {lo, hi}) {
      all.push_back(initial);
      all.back()[k] = end[k];
    }
  return all;
}

template <class M>
Scattering scattering(const M& m) {
  return {[m](const Vec3d& wo, const Vec3d& wi) { return m.eval(wo, wi); },
          [m](const Vec3d& wo, const Vec3d& wi) { return m.pdf(wo, wi); },
          [m](const Vec3d& wo, double u_lobe, Vec2<double> u) { return m.sample(wo, u_lobe, u); },
          M::laws.stochastic};
}

/// The laws, as the model claims them, with these parameters.
template <class M>
void expect_claims(const std::vector<double>& values, const ValidateOptions& options) {
  const std::string name = describe<M>(values);
  Sides sides{M::laws.transmits, 1};
  std::size_t next = 0;
  for_each_parameter<M>([&](const auto& p) {
    if (sides.transmits && !M::laws.thin && p.name == "eta") sides.eta = values[next];
    ++next;
  });
  const ValidationReport report = validate(scattering(make<M>(values)), name, sides, options);
  for (const LawResult& l : report.laws) {
    if (l.law == "reciprocity" && !M::laws.reciprocal) continue;
    if (l.law == "energy conservation" && M::laws.energy_gain > 0) {
      EXPECT_LE(l.worst - l.error, M::laws.energy_gain) << name << " at " << l.where;
      continue;
    }
    EXPECT_TRUE(l.verdict != Verdict::violated) << name << ": " << l.law << " " << l.worst << " +- "
                                                << l.error << " at " << l.where << "\n  " << l.command;
  }
}

/// Significance 1e-4: there are many models, and a random failure is no news of any. Estimates cost more.
template <class M>
ValidateOptions quick() {
  ValidateOptions options;
  options.samples = M::laws.stochastic ? 4000 : 20000;
  options.directions = M::laws.stochastic ? 1000 : 4000;
  options.significance = 1e-4;
  return options;
}

} // namespace model_laws

TYPED_TEST_P(ModelNumbers, FloatAgreesWithDouble) {
  using namespace model_laws;
  using M = typename TypeParam::template Model<double, 1>;
  if (M::laws.stochastic) GTEST_SKIP() << "a rounding sends a random walk another way";
  for (int i = 0; i < 200; ++i) {
    const auto values = random_parameters<M>(i);
    const Pair pair = random_pair(i, M::laws.transmits);
    const auto reference = make<M>(values);
    const auto model = make<typename TypeParam::template Model<float, 1>>(values);
    const double f = reference.eval(pair.wo, pair.wi)[0], p = reference.pdf(pair.wo, pair.wi);
    const auto wo = vec3<float>(pair.wo), wi = vec3<float>(pair.wi);
    // 2e-3: the float rounding of a half vector moves a narrow lobe by that much of its value
    ASSERT_NEAR(model.eval(wo, wi)[0], f, 2e-3 * std::abs(f) + 1e-6) << describe<M>(values) << pair.text();
    ASSERT_NEAR(model.pdf(wo, wi), p, 2e-3 * std::abs(p) + 1e-6) << describe<M>(values) << pair.text();
  }
}

TYPED_TEST_P(ModelNumbers, PackAgreesWithFloatInEveryLane) {
  using namespace model_laws;
  using M = typename TypeParam::template Model<float, 1>;
  if (M::laws.stochastic) GTEST_SKIP() << "a rounding sends a random walk another way";
  for (int i = 0; i < 50; ++i) {
    const auto values = random_parameters<M>(i);
    const auto scalar = make<M>(values);
    const auto packed = make<typename TypeParam::template Model<Pack, 1>>(values);
    std::array<std::array<float, pack_width>, 6> w;
    std::vector<Pair> pairs;
    for (std::size_t l = 0; l < pack_width; ++l) {
      pairs.push_back(random_pair(1000 + i * int(pack_width) + int(l), M::laws.transmits));
      const auto& [o, n] = pairs.back();
      const double xyz[] = {o.x, o.y, o.z, n.x, n.y, n.z};
      for (std::size_t k = 0; k < 6; ++k)
        w[k][l] = float(xyz[k]);
    }
    const Vec3<Pack> wo{load(w[0].data()), load(w[1].data()), load(w[2].data())};
    const Vec3<Pack> wi{load(w[3].data()), load(w[4].data()), load(w[5].data())};
    const Pack f = packed.eval(wo, wi)[0], p = packed.pdf(wo, wi);
    const float u_lobe = float(random(i, 50)), u = float(random(i, 51)), v = float(random(i, 52));
    const auto s = packed.sample(wo, Pack(u_lobe), Vec2<Pack>{Pack(u), Pack(v)});
    for (std::size_t l = 0; l < pack_width; ++l) {
      const auto o = vec3<float>(pairs[l].wo), n = vec3<float>(pairs[l].wi);
      const std::string where = describe<M>(values) + pairs[l].text();
      const float fs = scalar.eval(o, n)[0], ps = scalar.pdf(o, n);
      ASSERT_NEAR(lane(f, l), fs, 2e-3f * std::abs(fs) + 1e-6f) << where;
      ASSERT_NEAR(lane(p, l), ps, 2e-3f * std::abs(ps) + 1e-6f) << where;
      const auto one = scalar.sample(o, u_lobe, {u, v});
      // What inverting a distribution function in float allows.
      ASSERT_NEAR(lane(s.wi.x, l), one.wi.x, 2e-3f) << where;
      ASSERT_NEAR(lane(s.wi.z, l), one.wi.z, 2e-3f) << where;
      ASSERT_NEAR(lane(s.pdf, l), one.pdf, 2e-2f * std::abs(one.pdf) + 1e-6f) << where;
    }
  }
}

TYPED_TEST_P(ModelNumbers, DualsAreTheDerivatives) {
  using namespace model_laws;
  using M = typename TypeParam::template Model<double, 1>;
  using D = typename TypeParam::template Model<Dual<double, 1>, 1>;
  using P = typename TypeParam::template Model<Dual<Pack, 1>, 1>;
  if (M::laws.stochastic) GTEST_SKIP() << "derivatives are those of one estimate";
  for (int i = 0; i < 60; ++i) {
    const auto values = random_parameters<M>(i);
    const Pair pair = random_pair(i, M::laws.transmits);
    int k = -1;
    for_each_parameter<M>([&](const auto& p) {
      ++k;
      if (!p.fitted || testing::Test::HasFatalFailure()) return;
      const auto f =
          make_dual<D>(values, k).eval(vec3<Dual<double, 1>>(pair.wo), vec3<Dual<double, 1>>(pair.wi))[0];
      const auto fp =
          make_dual<P>(values, k).eval(vec3<Dual<Pack, 1>>(pair.wo), vec3<Dual<Pack, 1>>(pair.wi))[0];
      const auto slope_over = [&](double h) {
        auto low = values, high = values;
        low[std::size_t(k)] -= h, high[std::size_t(k)] += h;
        return (make<M>(high).eval(pair.wo, pair.wi)[0] - make<M>(low).eval(pair.wo, pair.wi)[0]) / (2 * h);
      };
      const double size = std::max(std::abs(values[std::size_t(k)]), 1e-2), h = 1e-6 * size;
      const double slope = slope_over(h), scale = std::abs(slope) + std::abs(f.v) / size;
      // Kinks, as of a table interpolated linearly, show as a slope that depends on the step.
      const double kink = 3 * std::abs(slope_over(3 * h) - slope);
      const std::string where = fmt::format("d {} of {}{}", p.name, describe<M>(values), pair.text());
      ASSERT_NEAR(f.v, make<M>(values).eval(pair.wo, pair.wi)[0], 1e-11 * std::abs(f.v) + 1e-15) << where;
      ASSERT_NEAR(f.d[0], slope, 1e-4 * scale + 1e-7 + kink) << where;
      ASSERT_NEAR(lane(fp.v, 0), f.v, 2e-3 * std::abs(f.v) + 1e-6) << where;
      ASSERT_NEAR(lane(fp.d[0], 0), f.d[0], 1e-2 * scale + 1e-5 + kink) << where;
    });
  }
}

TYPED_TEST_P(ModelNumbers, DerivativesAreFiniteAtCornersOfDomainAndDirections) {
  using namespace model_laws;
  using M = typename TypeParam::template Model<float, 1>;
  using P = typename TypeParam::template Model<Dual<Pack, 1>, 1>;
  std::vector<Vec3d> w{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}};
  for (const double z : {0.5, 1e-3, 1e-6, -1e-6, -0.5})
    for (const double phi : {0.0, 2.0, pi}) {
      const double s = std::sqrt(1 - z * z);
      w.push_back({s * std::cos(phi), s * std::sin(phi), z});
    }
  // All pairs, a pack at a time.
  std::array<std::vector<float>, 6> pairs;
  for (const Vec3d& o : w)
    for (const Vec3d& i : w) {
      const double xyz[] = {o.x, o.y, o.z, i.x, i.y, i.z};
      for (std::size_t k = 0; k < 6; ++k)
        pairs[k].push_back(float(xyz[k]));
    }
  for (auto& v : pairs)
    v.resize((v.size() + pack_width - 1) / pack_width * pack_width, v.back());
  using R = Dual<Pack, 1>;
  for (const auto& values : corners<M>()) {
    int k = -1;
    for_each_parameter<M>([&](const auto& p) {
      ++k;
      if (!p.fitted || testing::Test::HasFatalFailure()) return;
      const auto model = make_dual<P>(values, k);
      for (std::size_t i = 0; i < pairs[0].size(); i += pack_width) {
        const auto at = [&](std::size_t c) { return R(load(&pairs[c][i])); };
        const R f = model.eval({at(0), at(1), at(2)}, {at(3), at(4), at(5)})[0];
        for (std::size_t l = 0; l < pack_width; ++l)
          ASSERT_TRUE(std::isfinite(lane(f.v, l)) && std::isfinite(lane(f.d[0], l)))
              << lane(f.v, l) << ", d " << p.name << " " << lane(f.d[0], l) << " of " << describe<M>(values)
              << Pair{{pairs[0][i + l], pairs[1][i + l], pairs[2][i + l]},
                      {pairs[3][i + l], pairs[4][i + l], pairs[5][i + l]}}
                     .text();
      }
    });
  }
}

// wo + wi may be so short that its square is 0 in float: a facet that no one can tell is no facet.
TYPED_TEST_P(ModelNumbers, IsFiniteAtTheHorizonInFloat) {
  using namespace model_laws;
  using M = typename TypeParam::template Model<float, 1>;
  for (const auto& values : corners<M>()) {
    const M model = make<M>(values);
    for (const float zo : {1e-3f, 1e-8f, 1e-20f, 1e-30f, -1e-20f})
      for (const float zi : {1e-3f, 1e-8f, 1e-20f, 1e-30f, -1e-20f})
        for (const float x : {-1.0f, 1.0f}) {
          const Vec3f wo{1, 0, zo}, wi{x, 0, zi};
          const std::string where = describe<M>(values) + Pair{in_double(wo), in_double(wi)}.text();
          const float f = model.eval(wo, wi)[0], p = model.pdf(wo, wi);
          ASSERT_TRUE(std::isfinite(f) && f >= 0) << f << where;
          ASSERT_TRUE(std::isfinite(p) && p >= 0) << p << where;
          for (const float u : {0.0f, 0.3f, 0.99999994f}) {
            const auto s = model.sample(wo, u, {u, 0.99999994f - u});
            ASSERT_TRUE(std::isfinite(s.pdf) && s.pdf >= 0) << s.pdf << where;
            ASSERT_TRUE(s.pdf == 0 || std::isfinite(s.f[0])) << s.f[0] << where;
          }
        }
  }
}

TYPED_TEST_P(ModelLaws, AreKeptAsClaimed) {
  using namespace model_laws;
  using M = typename TypeParam::template Model<double, 3>;
  expect_claims<M>(corners<M>()[2], quick<M>());
  expect_claims<M>(at_share<M>([](int k) { return random(1, k); }), quick<M>());
}

TYPED_TEST_P(LongModelLaws, AreKeptAsClaimedOverTheDomain) {
  using namespace model_laws;
  using M = typename TypeParam::template Model<double, 3>;
  for (int i = 2; i < 10; ++i)
    expect_claims<M>(at_share<M>([&](int k) { return random(i, k); }), quick<M>());
}

REGISTER_TYPED_TEST_SUITE_P(ModelNumbers, FloatAgreesWithDouble, PackAgreesWithFloatInEveryLane,
                            DualsAreTheDerivatives, DerivativesAreFiniteAtCornersOfDomainAndDirections,
                            IsFiniteAtTheHorizonInFloat);
REGISTER_TYPED_TEST_SUITE_P(ModelLaws, AreKeptAsClaimed);
REGISTER_TYPED_TEST_SUITE_P(LongModelLaws, AreKeptAsClaimedOverTheDomain);

// ctest drops the suite from the names of typed tests: the prefix says which are long.
#define NACRE_TEST_MODEL(Model)                                                                              \
  INSTANTIATE_TYPED_TEST_SUITE_P(Model, ModelNumbers, Family<Model>);                                        \
  INSTANTIATE_TYPED_TEST_SUITE_P(Model, ModelLaws, Family<Model>);                                           \
  INSTANTIATE_TYPED_TEST_SUITE_P(Long##Model, LongModelLaws, Family<Model>);

} // namespace nacre
