// The directional-statistics lobe: its formula in the paper's words, and its sampler as a mixture of powers.
#include "bsdf/models/dsbrdf.h"

#include "core/quadrature.h"
#include "core/random.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

using Gray = Spectrum<double, 1>;
using Model = DsBrdf<double, 1>;

double random(int i, int d) { return unit_double(hash(9, i, d)); }
Vec3d upper(int i, int d) { return spherical_direction(std::acos(random(i, d)), 2 * pi * random(i, d + 1)); }

TEST(DsBrdf, IsThePapersLobeWhereItsFunctionsAreConstant) {
  const double kappa = 3, gamma = 25;
  const Model m{{}, Gray(kappa), Gray(kappa), Gray(kappa), gamma, gamma, gamma};
  for (int i = 0; i < 200; ++i) {
    const Vec3d wo = upper(i, 0), wi = upper(i, 2);
    const double f = std::exp(kappa * std::pow(normalize(wo + wi).z, gamma)) - 1;
    EXPECT_NEAR(m.eval(wo, wi)[0], f, 1e-10 * f + 1e-15);
  }
}

TEST(DsBrdf, ControlValuesAreThoseAtTheEndsOfThetaD) {
  const Model m{{}, Gray(0.5), Gray(2), Gray(6), 10, 100, 1000};
  const Vec3d n{0, 0, 1}, o = spherical_direction(0.5 * pi - 1e-6, 0.0), i{-o.x, -o.y, o.z};
  EXPECT_NEAR(m.eval(n, n)[0], std::exp(0.5) - 1, 1e-12);
  EXPECT_NEAR(m.eval(o, i)[0], std::exp(6) - 1, 0.02);
}

TEST(DsBrdf, SamplerHoldsTheWholeLobe) {
  for (const double kappa : {0.01, 1.0, 10.0})
    for (const double gamma : {0.1, 3.0, 100.0}) {
      // Along the normal and without the horizon the weight of the mirrored lobe is f cos / pdf.
      const Model m{{}, Gray(kappa), Gray(kappa), Gray(kappa), gamma, gamma, gamma};
      const Vec3d n{0, 0, 1};
      const double direct =
          integrate_hemisphere([&](const Vec3d& wi) { return m.eval(n, wi)[0] * wi.z; }, 300, 32);
      double sampled = 0;
      constexpr int count = 120;
      for (int i = 0; i < count; ++i)
        for (int j = 0; j < count; ++j) {
          const auto s = m.sample(n, random(i * count + j, 0), {(i + 0.5) / count, (j + 0.5) / count});
          if (s.pdf > 0) sampled += s.f[0] * s.wi.z / s.pdf;
        }
      EXPECT_NEAR(sampled / (count * count), direct, 0.02 * direct) << kappa << " " << gamma;
      EXPECT_LT(direct, 1 + Model::laws.energy_gain);
    }
}

} // namespace
} // namespace nacre
