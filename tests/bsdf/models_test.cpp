// Every model of the list says the same through every number type it is compiled for.
#include "bsdf/list.h"

#include "core/dual.h"
#include "core/error.h"
#include "core/random.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

template <class M>
class ModelNumbers : public testing::Test {};
template <class... M>
using AsTypes = testing::Types<M...>;
struct ModelNames {
  template <class M>
  static std::string GetName(int) {
    return std::string(M::name);
  }
};
using AllModels = Models<double, 1, AsTypes>;
TYPED_TEST_SUITE(ModelNumbers, AllModels, ModelNames);

/// The model `M` of the list with its parameters of another number type.
template <class M, class R>
struct Rebind;
template <template <class, int> class Template, class S, int C, class R>
struct Rebind<Template<S, C>, R> {
  using type = Template<R, C>;
};
template <template <class, int, template <class> class> class Template, class S, int C,
          template <class> class Distribution, class R>
struct Rebind<Template<S, C, Distribution>, R> {
  using type = Template<R, C, Distribution>;
};

constexpr std::uint64_t seed = 7;
double random(int i, int d) { return unit_double(hash(seed, i, d)); }

/// Random parameters well inside their domains: a fifth to four fifths, on a logarithmic scale where the
/// domain spans more than a decade above 0.
template <class M>
std::vector<double> random_parameters(int i) {
  std::vector<double> values;
  int d = 100;
  for_each_parameter<M>([&](const auto& p) {
    for (int c = 0; c < p.size; ++c) {
      const double t = 0.2 + 0.6 * random(i, d++);
      values.push_back(p.lo > 0 && p.hi > 10 * p.lo ? p.lo * std::pow(p.hi / p.lo, t)
                                                    : p.lo + (p.hi - p.lo) * t);
    }
  });
  return values;
}

struct Pair {
  Vec3d wo, wi;
};
template <class M>
Pair random_pair(int i) {
  // 5 to 75 degrees from the normal; for transmission a third of the light comes from below.
  const auto angle = [&](int d) { return (5 + 70 * random(i, d)) * pi / 180; };
  Pair p{spherical_direction(angle(0), 2 * pi * random(i, 1)),
         spherical_direction(angle(2), 2 * pi * random(i, 3))};
  if (M::laws.transmits && i % 3 == 0) p.wi.z = -p.wi.z;
  if (M::laws.transmits && i % 4 == 0) p.wo.z = -p.wo.z;
  return p;
}

template <class R, class M>
typename Rebind<M, R>::type with_numbers(const std::vector<double>& values) {
  std::vector<R> v;
  for (const double x : values)
    v.push_back(constant<R>(x));
  return from_vector<typename Rebind<M, R>::type>(v.data());
}

TYPED_TEST(ModelNumbers, FloatAgreesWithDouble) {
  for (int i = 0; i < 300; ++i) {
    const auto values = random_parameters<TypeParam>(i);
    const auto [wo, wi] = random_pair<TypeParam>(i);
    const auto reference = with_numbers<double, TypeParam>(values);
    const auto model = with_numbers<float, TypeParam>(values);
    const double f = reference.eval(wo, wi)[0], p = reference.pdf(wo, wi);
    // 1e-3: the float rounding of a half vector moves a narrow lobe by that much of its value
    EXPECT_NEAR(model.eval(vec3<float>(wo), vec3<float>(wi))[0], f, 1e-3 * std::abs(f) + 1e-6);
    EXPECT_NEAR(model.pdf(vec3<float>(wo), vec3<float>(wi)), p, 1e-3 * std::abs(p) + 1e-6);
  }
}

TYPED_TEST(ModelNumbers, PackAgreesWithFloatInEveryLane) {
  for (int i = 0; i < 100; ++i) {
    const auto values = random_parameters<TypeParam>(i);
    const auto scalar = with_numbers<float, TypeParam>(values);
    const auto packed = with_numbers<Pack, TypeParam>(values);
    std::array<std::array<float, pack_width>, 6> w;
    std::vector<Pair> pairs;
    for (std::size_t l = 0; l < pack_width; ++l) {
      pairs.push_back(random_pair<TypeParam>(1000 + i * int(pack_width) + int(l)));
      const auto& [o, n] = pairs.back();
      const double xyz[] = {o.x, o.y, o.z, n.x, n.y, n.z};
      for (std::size_t k = 0; k < 6; ++k)
        w[k][l] = float(xyz[k]);
    }
    const Vec3<Pack> wo{load(w[0].data()), load(w[1].data()), load(w[2].data())};
    const Vec3<Pack> wi{load(w[3].data()), load(w[4].data()), load(w[5].data())};
    const Pack f = packed.eval(wo, wi)[0], p = packed.pdf(wo, wi);
    const auto s = packed.sample(wo, Pack(0.4f), Vec2<Pack>{Pack(0.3f), Pack(0.6f)});
    for (std::size_t l = 0; l < pack_width; ++l) {
      const auto o = vec3<float>(pairs[l].wo), n = vec3<float>(pairs[l].wi);
      const float fs = scalar.eval(o, n)[0], ps = scalar.pdf(o, n);
      EXPECT_NEAR(lane(f, l), fs, 1e-3f * std::abs(fs) + 1e-6f);
      EXPECT_NEAR(lane(p, l), ps, 1e-3f * std::abs(ps) + 1e-6f);
      const auto one = scalar.sample(o, 0.4f, {0.3f, 0.6f});
      EXPECT_NEAR(lane(s.wi.x, l), one.wi.x, 1e-3f); // what inverting a distribution function in float allows
      EXPECT_NEAR(lane(s.wi.z, l), one.wi.z, 1e-3f);
      EXPECT_NEAR(lane(s.pdf, l), one.pdf, 5e-3f * std::abs(one.pdf) + 1e-6f);
    }
  }
}

TYPED_TEST(ModelNumbers, DualsAreTheDerivatives) {
  constexpr int n = parameter_count<TypeParam>();
  using D = Dual<double, n>;
  using P = Dual<Pack, n>;
  for (int i = 0; i < 100; ++i) {
    const auto values = random_parameters<TypeParam>(i);
    const auto [wo, wi] = random_pair<TypeParam>(i);
    std::vector<D> variables;
    std::vector<P> packed;
    for (int k = 0; k < n; ++k) {
      variables.push_back(D::variable(values[std::size_t(k)], k));
      packed.push_back(P::variable(Pack(float(values[std::size_t(k)])), k));
    }
    const auto dual = from_vector<typename Rebind<TypeParam, D>::type>(variables.data());
    const auto dual_pack = from_vector<typename Rebind<TypeParam, P>::type>(packed.data());
    const D f = dual.eval(vec3<D>(wo), vec3<D>(wi))[0];
    const P fp = dual_pack.eval(vec3<P>(wo), vec3<P>(wi))[0];
    EXPECT_NEAR(f.v, (with_numbers<double, TypeParam>(values).eval(wo, wi)[0]),
                1e-12 * std::abs(f.v) + 1e-15);
    EXPECT_NEAR(lane(fp.v, 0), f.v, 1e-3 * std::abs(f.v) + 1e-6);
    for (int k = 0; k < n; ++k) {
      auto low = values, high = values;
      const double h = 1e-6 * std::max(std::abs(values[std::size_t(k)]), 1e-2);
      low[std::size_t(k)] -= h, high[std::size_t(k)] += h;
      const double slope = (with_numbers<double, TypeParam>(high).eval(wo, wi)[0] -
                            with_numbers<double, TypeParam>(low).eval(wo, wi)[0]) /
                           (2 * h);
      const double scale = std::abs(slope) + std::abs(f.v);
      // A table interpolated linearly has a kink at its nodes; away from them the slopes agree to rounding.
      EXPECT_NEAR(f.d[std::size_t(k)], slope, 1e-4 * scale + 1e-7) << "parameter " << k << " case " << i;
      EXPECT_NEAR(lane(fp.d[std::size_t(k)], 0), f.d[std::size_t(k)], 5e-3 * scale + 1e-5)
          << "parameter " << k;
    }
  }
}

TYPED_TEST(ModelNumbers, DerivativesAreFiniteEverywhere) {
  constexpr int n = parameter_count<TypeParam>();
  using P = Dual<Pack, n>;
  const auto model = default_model<typename Rebind<TypeParam, P>::type>();
  const auto values = [&] { // every parameter a variable at its default
    auto m = model;
    int k = 0;
    for_each_parameter<decltype(m)>([&](const auto& p) {
      const auto x = P::variable(Pack(float(p.initial)), k++);
      if constexpr (p.per_channel)
        (m.*p.member)[0] = x;
      else
        m.*p.member = x;
    });
    return m;
  }();
  for (const double z : {1.0, 0.5, 1e-3, 1e-6, 0.0, -1e-6, -0.5, -1.0})
    for (const double zi : {1.0, 0.5, 1e-3, 1e-6, 0.0, -1e-6, -0.5, -1.0})
      for (const double phi : {0.0, 1.0, pi}) {
        const double s = std::sqrt(1 - z * z), si = std::sqrt(1 - zi * zi);
        const Vec3d wo{s, 0, z}, wi{si * std::cos(phi), si * std::sin(phi), zi};
        const P f = values.eval(vec3<P>(wo), vec3<P>(wi))[0];
        EXPECT_TRUE(std::isfinite(lane(f.v, 0)));
        for (int k = 0; k < n; ++k)
          EXPECT_TRUE(std::isfinite(lane(f.d[std::size_t(k)], 0)))
              << "parameter " << k << " z " << z << " " << zi;
      }
}

// wo + wi may be so short that its square is 0 in float: a facet that no one can tell is no facet.
TYPED_TEST(ModelNumbers, IsFiniteAtTheHorizonInFloat) {
  using M = typename Rebind<TypeParam, float>::type;
  const auto n = std::size_t(parameter_count<M>());
  for (int corner = 0; corner < 3; ++corner) {
    std::vector<float> values;
    for_each_parameter<M>([&](const auto& p) {
      for (int c = 0; c < p.size; ++c)
        values.push_back(float(corner == 0 ? p.lo : corner == 1 ? p.initial : p.hi));
    });
    ASSERT_EQ(values.size(), n);
    const M model = from_vector<M>(values.data());
    for (const float zo : {1e-3f, 1e-8f, 1e-20f, 1e-30f})
      for (const float zi : {1e-3f, 1e-8f, 1e-20f, 1e-30f, -1e-20f})
        for (const float x : {-1.0f, 1.0f}) {
          const Vec3f wo{1, 0, zo}, wi{x, 0, zi};
          EXPECT_TRUE(std::isfinite(model.eval(wo, wi)[0])) << corner << " " << zo << " " << zi << " " << x;
          EXPECT_TRUE(std::isfinite(model.pdf(wo, wi))) << corner << " " << zo << " " << zi << " " << x;
          EXPECT_GE(model.eval(wo, wi)[0], 0);
        }
  }
}

template <class M>
void expect_straight_through() {
  M glass = default_model<M>();
  glass.eta = 1;
  for (const double z : {1.0, 0.5, 0.1, 1e-3, -0.5, -1.0})
    for (int i = 0; i < 20; ++i) {
      const Vec3f wo = vec3<float>(Vec3d{std::sqrt(1 - z * z), 0, z});
      const auto s = glass.sample(wo, float(random(i, 0)), {float(random(i, 1)), float(random(i, 2))});
      EXPECT_TRUE(s.is_delta);
      EXPECT_EQ(dot(s.wi, wo), -length_squared(wo));
      EXPECT_NEAR(s.f[0] * std::abs(s.wi.z) / s.pdf, 1, 1e-6);
      EXPECT_EQ(glass.eval(wo, s.wi)[0], 0);
    }
}

TEST(RoughDielectric, EqualIndicesLetAllLightGoStraightOn) {
  expect_straight_through<GgxDielectric<float, 1>>();
  expect_straight_through<BeckmannDielectric<float, 1>>();
}

TEST(ModelList, NamesAreUniqueAndFound) {
  const auto& infos = model_infos();
  for (std::size_t i = 0; i < infos.size(); ++i)
    EXPECT_EQ(model_index(infos[i].name), int(i));
}

TEST(ModelList, DefaultsLieInTheirDomains) {
  for (const ModelInfo& m : model_infos())
    for (const ParameterInfo& p : m.parameters) {
      EXPECT_LE(p.lo, p.initial) << m.name << " " << p.name;
      EXPECT_LE(p.initial, p.hi) << m.name << " " << p.name;
      EXPECT_FALSE(p.meaning.empty());
    }
}

TEST(ModelList, MisspeltNameIsSuggested) {
  try {
    find_model("lambertt");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("'lambert'"));
  }
}

} // namespace
} // namespace nacre
