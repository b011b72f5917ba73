// The list of models, and what is told of single models of it.
#include "bsdf/list.h"

#include "bsdf/models/rough_dielectric.h"
#include "core/error.h"
#include "core/random.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace nacre {
namespace {

double random(int i, int d) { return unit_double(hash(std::uint64_t(7), i, d)); }

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
