// The fitter's derivatives (duals over packs, some at a time) against duals over double, ceres::Jet and
// central differences, for models of every kind: tests/models holds each model of the list to its own
// derivatives.

#include "bsdf/models/ggx_schlick.h"
#include "bsdf/models/lambert.h"
#include "bsdf/models/oren_nayar.h"
#include "bsdf/models/rough_conductor.h"
#include "bsdf/models/rough_dielectric.h"
#include "bsdf/models/rough_plastic.h"
#include "bsdf/models/smooth_plastic.h"
#include "core/dual.h"
#include "core/random.h"
#include "fit/jet.h"
#include "fit/observations.h"
#include "measured/material_spec.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

struct Derivatives {
  double f = 0;
  std::vector<double> d;
};

template <class R>
Vec3<R> direction(const std::array<std::vector<float>, 3>& w, std::size_t i) {
  return {R(double(w[0][i])), R(double(w[1][i])), R(double(w[2][i]))};
}

template <template <class, int> class Model>
struct Reference {
  static constexpr int n = [] {
    int fitted = 0;
    for_each_parameter<Model<float, 1>>([&](const auto& p) { fitted += p.fitted; });
    return fitted;
  }();
  /// The model whose k-th fitted parameter is the k-th variable.
  template <class R, class Variable>
  static Model<R, 1> with_variables(const std::vector<double>& values, Variable variable) {
    std::vector<R> numbers;
    int k = 0;
    for_each_parameter<Model<R, 1>>([&](const auto& p) {
      const double x = values[numbers.size()];
      numbers.push_back(p.fitted ? variable(x, k++) : R(x));
    });
    return from_vector<Model<R, 1>>(numbers.data());
  }
  static Derivatives dual(const std::vector<double>& values, const Observations& at, std::size_t i) {
    using R = Dual<double, n>;
    const auto model = with_variables<R>(values, [](double x, int k) { return R::variable(x, k); });
    const R y = model.eval(direction<R>(at.wo, i), direction<R>(at.wi, i))[0];
    return {y.v, {y.d.begin(), y.d.end()}};
  }
  static Derivatives jet(const std::vector<double>& values, const Observations& at, std::size_t i) {
    using R = ceres::Jet<double, n>;
    const auto model = with_variables<R>(values, [](double x, int k) { return R(x, k); });
    const R y = model.eval(direction<R>(at.wo, i), direction<R>(at.wi, i))[0];
    return {y.a, {y.v.data(), y.v.data() + n}};
  }
  static double value(const std::vector<double>& values, const Observations& at, std::size_t i) {
    return from_vector<Model<double, 1>>(values.data())
        .eval(direction<double>(at.wo, i), direction<double>(at.wi, i))[0];
  }
};

struct ReferenceOf {
  int model; ///< in the list
  Derivatives (*dual)(const std::vector<double>&, const Observations&, std::size_t);
  Derivatives (*jet)(const std::vector<double>&, const Observations&, std::size_t);
  double (*value)(const std::vector<double>&, const Observations&, std::size_t);
};
template <template <class, int> class Model>
ReferenceOf reference() {
  using M = Reference<Model>;
  return {model_index(Model<float, 1>::name), &M::dual, &M::jet, &M::value};
}
const std::vector<ReferenceOf>& references() {
  static const std::vector<ReferenceOf> list{reference<Lambert>(),       reference<OrenNayar>(),
                                             reference<GgxSchlick>(),    reference<GgxConductor>(),
                                             reference<GgxDielectric>(), reference<BeckmannConductor>(),
                                             reference<SmoothPlastic>(), reference<GgxPlastic>()};
  return list;
}

double random(std::uint64_t set, std::uint64_t i, std::uint64_t dimension) {
  return unit_double(hash(std::uint64_t(20240517), set, i, dimension));
}

Vec3d unit(double cos_theta, double phi) {
  const double s = std::sqrt(1 - cos_theta * cos_theta);
  return {s * std::cos(phi), s * std::sin(phi), cos_theta};
}

void add(Observations& at, const Vec3d& wo, const Vec3d& wi) {
  const double o[3] = {wo.x, wo.y, wo.z}, i[3] = {wi.x, wi.y, wi.z};
  for (std::size_t k = 0; k < 3; ++k) {
    at.wo[k].push_back(float(o[k]));
    at.wi[k].push_back(float(i[k]));
  }
  ++at.count;
}

/// Pairs in general position: half of them near the mirror direction, where rough models have their peak.
Observations general_directions(std::uint64_t set, std::size_t n) {
  Observations at;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d wo = unit(0.15 + 0.84 * random(set, i, 0), 2 * pi * random(set, i, 1));
    const double spread = i % 2 == 0 ? 0.1 : 1;
    const Vec3d wi =
        normalize(Vec3d{-wo.x + spread * (random(set, i, 2) - 0.5),
                        -wo.y + spread * (random(set, i, 3) - 0.5), wo.z + 0.1 * random(set, i, 4)});
    add(at, wo, wi);
  }
  return at;
}

/// Normal, equal, opposite in azimuth, grazing, on and below the horizon.
Observations degenerate_directions() {
  const Vec3d up{0, 0, 1};
  std::vector<Vec3d> w{up,
                       unit(0.5, 0),
                       unit(0.5, pi),
                       unit(0.5, 2),
                       unit(1e-3, 0.3),
                       unit(1e-3, 0.3 + pi),
                       unit(1e-6, 1),
                       unit(1 - 1e-7, 1),
                       unit(0, 1),
                       {1, 0, 0},
                       unit(-0.3, 1),
                       {0, 0, -1}};
  Observations at;
  for (const Vec3d& wo : w)
    for (const Vec3d& wi : w)
      add(at, wo, wi);
  while (at.count % pack_width != 0)
    add(at, up, up);
  return at;
}

/// One channel's parameters at share u of their domains, evenly in the logarithm for positive wide ones.
std::vector<double> at_share(const ModelInfo& model, const std::function<double(std::size_t)>& share) {
  std::vector<double> values;
  for (std::size_t k = 0; k < model.parameters.size(); ++k) {
    const ParameterInfo& p = model.parameters[k];
    const double u = share(k);
    double x = p.lo > 0 && p.hi / p.lo >= 100 ? p.lo * std::pow(p.hi / p.lo, u) : p.lo + u * (p.hi - p.lo);
    x = std::clamp(x, p.lo, p.hi);
    // A float, so that packs and doubles are given the same number, moved inside the domain.
    if (double(float(x)) < p.lo) x = std::nextafter(float(x), 1e30f);
    if (double(float(x)) > p.hi) x = std::nextafter(float(x), -1e30f);
    values.push_back(double(float(x)));
  }
  return values;
}

std::string describe(const ModelInfo& model, const std::vector<double>& values, const Observations& at,
                     std::size_t i) {
  std::string text = model.name;
  for (std::size_t k = 0; k < values.size(); ++k)
    text += fmt::format(" {}={:.9g}", model.parameters[k].name, values[k]);
  return text + fmt::format(" wo=({:.9g} {:.9g} {:.9g}) wi=({:.9g} {:.9g} {:.9g})", at.wo[0][i], at.wo[1][i],
                            at.wo[2][i], at.wi[0][i], at.wi[1][i], at.wi[2][i]);
}

struct PackResults {
  std::vector<float> f, df, f_alone;
};
PackResults over_packs(int model, const std::vector<double>& values, const Observations& at) {
  const ModelDerivatives& lobe = model_derivatives(model);
  const auto& declared = model_infos()[std::size_t(model)].parameters;
  std::vector<int> fitted;
  for (std::size_t k = 0; k < declared.size(); ++k)
    if (declared[k].fitted) fitted.push_back(int(k));
  PackResults r{std::vector<float>(at.count), std::vector<float>(at.count * std::size_t(lobe.count)),
                std::vector<float>(at.count)};
  lobe.evaluate(values, fitted, at.from(0), at.count, r.f.data(), r.df.data());
  lobe.evaluate(values, {}, at.from(0), at.count, r.f_alone.data(), nullptr);
  return r;
}

constexpr std::size_t pairs = 64;
/// 1/sr. Below it f is the far tail of an exponential, whose relative error is that of its exponent.
constexpr double negligible = 1e-9;

TEST(ModelDerivatives, JetsAndDualsOverDoubleAreEqual) {
  for (std::size_t m = 0; m < references().size(); ++m)
    for (std::uint64_t set = 0; set < 20; ++set) {
      const ModelInfo& model = model_infos()[std::size_t(references()[m].model)];
      const Observations at = general_directions(set, pairs);
      const auto values = at_share(model, [&](std::size_t k) { return random(m, set, 100 + k); });
      for (std::size_t i = 0; i < pairs; ++i) {
        const Derivatives a = references()[m].dual(values, at, i), b = references()[m].jet(values, at, i);
        ASSERT_NEAR(a.f, b.f, 1e-11 * std::abs(b.f) + 1e-3 * negligible) << describe(model, values, at, i);
        // Derivatives are sums of terms of the size of f over the parameter: that is the scale of rounding.
        for (std::size_t k = 0; k < a.d.size(); ++k)
          ASSERT_NEAR(a.d[k], b.d[k], 1e-9 * (std::abs(b.d[k]) + std::abs(b.f) + negligible))
              << k << " " << describe(model, values, at, i);
      }
    }
}

TEST(ModelDerivatives, CentralDifferencesAgree) {
  for (std::size_t m = 0; m < references().size(); ++m)
    for (std::uint64_t set = 0; set < 20; ++set) {
      const ModelInfo& model = model_infos()[std::size_t(references()[m].model)];
      const Observations at = general_directions(set, pairs);
      const auto values =
          at_share(model, [&](std::size_t k) { return 0.05 + 0.9 * random(m, set, 100 + k); });
      for (std::size_t i = 0; i < pairs; ++i) {
        const Derivatives exact = references()[m].dual(values, at, i);
        EXPECT_NEAR(exact.f, references()[m].value(values, at, i), 1e-12 * std::abs(exact.f));
        std::size_t d = 0;
        for (std::size_t k = 0; k < values.size(); ++k) {
          if (!model.parameters[k].fitted) continue;
          const auto difference = [&](double h) {
            auto above = values, below = values;
            above[k] += h;
            below[k] -= h;
            return (references()[m].value(above, at, i) - references()[m].value(below, at, i)) / (2 * h);
          };
          const double h = 1e-5 * values[k], slope = difference(h);
          // Rounding is some 1e-16 f / h = 1e-11 f / x; the truncation error, third of what doubling h
          // changes, is large near the critical angle alone.
          const double truncation = std::abs(difference(2 * h) - slope);
          ASSERT_LT(truncation, 1e-3 * (std::abs(slope) + (std::abs(exact.f) + negligible) / values[k]));
          ASSERT_NEAR(exact.d[d], slope,
                      1e-7 * (std::abs(slope) + (std::abs(exact.f) + negligible) / values[k]) + truncation)
              << model.parameters[k].name << " " << describe(model, values, at, i);
          ++d;
        }
      }
    }
}

TEST(ModelDerivatives, PacksAgreeWithDouble) {
  for (std::size_t m = 0; m < references().size(); ++m)
    for (std::uint64_t set = 0; set < 20; ++set) {
      const ModelInfo& model = model_infos()[std::size_t(references()[m].model)];
      const Observations at = general_directions(set, pairs);
      const auto values = at_share(model, [&](std::size_t k) { return random(m, set, 100 + k); });
      const PackResults packs = over_packs(references()[m].model, values, at);
      for (std::size_t i = 0; i < pairs; ++i) {
        const Derivatives exact = references()[m].dual(values, at, i);
        ASSERT_NEAR(packs.f[i], exact.f, 1e-4 * std::abs(exact.f) + negligible)
            << describe(model, values, at, i);
        ASSERT_NEAR(packs.f_alone[i], packs.f[i], 1e-4 * std::abs(packs.f[i]) + negligible)
            << describe(model, values, at, i);
        std::size_t d = 0;
        for (std::size_t k = 0; k < values.size(); ++k) {
          if (!model.parameters[k].fitted) continue;
          const double scale = std::abs(exact.d[d]) + std::abs(exact.f) / std::max(values[k], 0.1);
          const double floor = negligible / std::max(values[k], 1e-3);
          ASSERT_NEAR(packs.df[d * at.count + i], exact.d[d], 1e-3 * scale + floor)
              << model.parameters[k].name << " " << describe(model, values, at, i);
          ++d;
        }
      }
    }
}

TEST(ModelDerivatives, AreFiniteAtTheEdgesOfDomainsAndDirections) {
  const Observations edge = degenerate_directions(), general = general_directions(7, pairs);
  for (std::size_t m = 0; m < references().size(); ++m) {
    const ModelInfo& model = model_infos()[std::size_t(references()[m].model)];
    // Corners of the domain: all numbers low, all high, each alone at an end, each in the middle.
    const std::size_t n = model.parameters.size();
    for (std::size_t corner = 0; corner < 3 * n + 2; ++corner) {
      const auto values = at_share(model, [&](std::size_t k) {
        if (corner < 2) return double(corner);
        const std::size_t which = (corner - 2) / 3, where = (corner - 2) % 3;
        return k == which ? 0.5 * double(where) : 0.5;
      });
      for (const Observations* at : {&edge, &general}) {
        const PackResults packs = over_packs(references()[m].model, values, *at);
        for (std::size_t i = 0; i < at->count; ++i) {
          ASSERT_TRUE(std::isfinite(packs.f[i])) << describe(model, values, *at, i);
          const Derivatives exact = references()[m].dual(values, *at, i);
          for (std::size_t d = 0; d < exact.d.size(); ++d) {
            ASSERT_TRUE(std::isfinite(exact.d[d])) << d << " " << describe(model, values, *at, i);
            ASSERT_TRUE(std::isfinite(packs.df[d * at->count + i]))
                << d << " " << describe(model, values, *at, i);
          }
        }
      }
    }
  }
}

TEST(ModelDerivatives, ChannelsDoNotMixInEval) {
  for (std::size_t m = 0; m < references().size(); ++m)
    for (std::uint64_t set = 0; set < 5; ++set) {
      const ModelInfo& model = model_infos()[std::size_t(references()[m].model)];
      const Observations at = general_directions(set, pairs);
      LobeSpec lobe = default_lobe(references()[m].model);
      std::array<std::vector<double>, 3> channel_values;
      for (std::size_t c = 0; c < 3; ++c)
        channel_values[c] = at_share(model, [&](std::size_t k) {
          return random(m, set, 100 + k + (model.parameters[k].per_channel ? 1000 * (c + 1) : 0));
        });
      for (std::size_t k = 0; k < lobe.values.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c)
          lobe.values[k][c] = channel_values[c][k];
      const auto bsdf = make_bsdf<double>({"colour", {lobe}});
      for (std::size_t i = 0; i < pairs; ++i) {
        const auto f = bsdf.eval(direction<double>(at.wo, i), direction<double>(at.wi, i));
        for (std::size_t c = 0; c < 3; ++c)
          ASSERT_NEAR(f[int(c)], references()[m].value(channel_values[c], at, i), 1e-12 * std::abs(f[int(c)]))
              << describe(model, channel_values[c], at, i);
      }
    }
}

} // namespace
} // namespace nacre
