// Models that prepare something for many directions are the same models with it.
#include "bsdf/list.h"
#include "bsdf/model_functions.h"
#include "core/pack.h"
#include "core/random.h"
#include "core/warp.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

TEST(PreparedModels, EvaluateAsWithoutPreparation) {
  std::vector<std::string> prepared_models;
  for (std::size_t m = 0; m < model_infos().size(); ++m) {
    const auto& functions = model_functions<Pack, 3>(int(m));
    if (!functions.prepare) continue;
    const ModelInfo& model = model_infos()[m];
    prepared_models.push_back(model.name);
    for (std::uint64_t set = 0; set < 200; ++set) {
      const auto u = [&](std::uint64_t d) { return unit_double(hash(std::uint64_t(7), m, set, d)); };
      std::vector<Pack> values;
      for (const ParameterInfo& p : model.parameters)
        for (int c = 0; c < (p.per_channel ? 3 : 1); ++c) {
          const double share = u(values.size());
          const double x = p.lo > 0 && p.hi / p.lo >= 100 ? p.lo * std::pow(p.hi / p.lo, share)
                                                          : p.lo + share * (p.hi - p.lo);
          values.push_back(constant<Pack>(p.fitted ? x : p.initial));
        }
      const auto prepared = functions.prepare(values.data());
      for (std::uint64_t i = 0; i < 20; ++i) {
        const auto direction = [&](std::uint64_t d) {
          const Vec3d w = square_to_cosine_hemisphere(Vec2<double>{u(100 + 4 * i + d), u(101 + 4 * i + d)});
          return Vec3<Pack>{constant<Pack>(w.x), constant<Pack>(w.y), constant<Pack>(w.z)};
        };
        const Vec3<Pack> wo = direction(0), wi = direction(2);
        const auto plain = functions.eval(values.data(), wo, wi),
                   quick = functions.eval_prepared(values.data(), prepared.get(), wo, wi);
        for (int c = 0; c < 3; ++c) {
          const double a = double(lane(plain[c], 0)), b = double(lane(quick[c], 0));
          EXPECT_NEAR(b, a, 1e-5 * std::abs(a) + 1e-9) << model.name << ", set " << set;
        }
      }
    }
  }
  EXPECT_EQ(prepared_models,
            (std::vector<std::string>{"gtr_conductor", "student_t_conductor", "exponential_power_conductor",
                                      "blinn_phong_facets", "sgd", "two_scale"}));
}

} // namespace
} // namespace nacre
