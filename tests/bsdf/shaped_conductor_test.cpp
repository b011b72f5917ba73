// Conductors of shaped distributions: their common members, and how much their V-cavity sampling scatters.
#include "bsdf/models/blinn_phong_facets.h"
#include "bsdf/models/low.h"
#include "bsdf/models/rough_conductor.h"
#include "bsdf/models/sgd.h"
#include "bsdf/models/shaped_conductor.h"
#include "bsdf/models/two_scale.h"

#include "core/random.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

template <class M>
M with_shape(double ax, double ay, double shape) {
  M m = default_model<M>();
  m.alpha_x = ax, m.alpha_y = ay, m.shape = shape;
  return m;
}

TEST(ShapedConductors, AreGgxAndBeckmannAtTheirCommonMembers) {
  for (int n = 0; n < 200; ++n) {
    const auto u = [&](int k) { return unit_double(hash(4, n, k)); };
    const Vec3d wo = spherical_direction(1.4 * u(0), 6 * u(1)),
                wi = spherical_direction(1.4 * u(2), 6 * u(3));
    const double ax = 0.1 + 0.9 * u(4), ay = 0.1 + 0.9 * u(5);
    auto ggx = default_model<GgxConductor<double, 1>>();
    auto beckmann = default_model<BeckmannConductor<double, 1>>();
    ggx.alpha_x = beckmann.alpha_x = ax, ggx.alpha_y = beckmann.alpha_y = ay;
    const double g = ggx.eval(wo, wi)[0], b = beckmann.eval(wo, wi)[0];
    EXPECT_NEAR((with_shape<GtrConductor<double, 1>>(ax, ay, 2).eval(wo, wi)[0]), g, 1e-3 * g);
    EXPECT_NEAR((with_shape<StudentTConductor<double, 1>>(ax, ay, 2).eval(wo, wi)[0]), g, 1e-5 * g);
    EXPECT_NEAR((with_shape<ExponentialPowerConductor<double, 1>>(ax, ay, 1).eval(wo, wi)[0]), b,
                1e-3 * b + 1e-9);
  }
}

/// Standard deviation of a sample's weight f cos / pdf over its mean.
template <class M>
double scatter(const M& m, double theta) {
  const Vec3d wo = spherical_direction(theta, 0.3);
  double sum = 0, squares = 0;
  constexpr int count = 20000;
  for (int n = 0; n < count; ++n) {
    const auto u = [&](int k) { return unit_double(hash(8, n, k)); };
    const auto s = m.sample(wo, u(0), {u(1), u(2)});
    const double w = s.pdf > 0 ? average(s.f) * s.wi.z / s.pdf : 0;
    sum += w, squares += w * w;
  }
  return std::sqrt(squares / count - sqr(sum / count)) / (sum / count);
}

TEST(MicrofacetSampling, WeightsScatterLittle) {
  const auto expect_little = [](const char* name, const auto& m) {
    for (const double theta : {0.2, 1.0, 1.4})
      EXPECT_LT(scatter(m, theta), 1.1) << name << " " << theta;
  };
  for (const double alpha : {0.1, 0.5}) {
    auto ggx = default_model<GgxConductor<double, 1>>();
    ggx.alpha_x = ggx.alpha_y = alpha;
    expect_little("ggx, Smith normals", ggx);
    expect_little("student_t 2", with_shape<StudentTConductor<double, 1>>(alpha, alpha, 2));
    expect_little("student_t 1.6", with_shape<StudentTConductor<double, 1>>(alpha, alpha, 1.6));
    expect_little("gtr 1", with_shape<GtrConductor<double, 1>>(alpha, alpha, 1));
    expect_little("exponential_power 0.3",
                  with_shape<ExponentialPowerConductor<double, 1>>(alpha / 10, alpha / 10, 0.3));
    expect_little("exponential_power 0.6",
                  with_shape<ExponentialPowerConductor<double, 1>>(alpha, alpha, 0.6));
    expect_little("exponential_power 3", with_shape<ExponentialPowerConductor<double, 1>>(alpha, alpha, 3));
    auto blinn = default_model<BlinnPhongConductor<double, 1>>();
    blinn.alpha_x = blinn.alpha_y = alpha;
    expect_little("blinn_phong_facets", blinn);
  }
  expect_little("sgd", default_model<Sgd<double, 3>>());
  expect_little("low_microfacet", default_model<LowMicrofacet<double, 3>>());
  expect_little("low_smooth", default_model<LowSmooth<double, 3>>());
  expect_little("two_scale", default_model<TwoScale<double, 3>>());
}

} // namespace
} // namespace nacre
