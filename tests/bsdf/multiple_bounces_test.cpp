// The light of several bounces among facets: what each way to bring it back promises.
#include "bsdf/models/invariance_conductor.h"
#include "bsdf/models/kulla_conty.h"
#include "bsdf/models/turquin.h"
#include "bsdf/models/walk_conductor.h"
#include "bsdf/models/walk_dielectric.h"
#include "bsdf/models/walk_diffuse.h"

#include "core/random.h"
#include "core/statistics.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

using Grey = Spectrum<double, 1>;
double random(int i, int d) { return unit_double(hash(21, i, d)); }
Vec3d at(double theta_deg, double phi = 0.4) { return spherical_direction(theta_deg * pi / 180, phi); }

/// No metal is white; an absorption this large comes as near as double resolves.
template <class M>
M white_metal() {
  M m = default_model<M>();
  m.eta = Grey(1e-3), m.k = Grey(1e5);
  return m;
}
template <template <class> class Distribution>
WalkConductor<double, 1, Distribution> white_walk(double alpha_x, double alpha_y) {
  auto m = white_metal<WalkConductor<double, 1, Distribution>>();
  m.alpha_x = alpha_x, m.alpha_y = alpha_y, m.walks = 1;
  return m;
}

struct Light {
  RunningMoments reflected, transmitted, all; ///< energy
};
/// Energy, not radiance: what the refraction compresses is taken out.
template <class M>
Light by_sampling(const M& m, const Vec3d& wo, int n, double eta_ti = 1) {
  Light light;
  for (int i = 0; i < n; ++i) {
    const auto s = m.sample(wo, random(i, 0), {random(i, 1), random(i, 2)});
    const double w = s.pdf > 0 ? s.f[0] * std::abs(s.wi.z) / s.pdf : 0;
    const bool same = s.wi.z * wo.z > 0;
    light.reflected.add(same ? w : 0);
    light.transmitted.add(same ? 0 : w * sqr(eta_ti));
    light.all.add(same ? w : w * sqr(eta_ti));
  }
  return light;
}
/// By evaluating at directions of a first bounce and at diffuse ones, by turns, of an additive recurrence
/// (the plastic number's): its error is below the standard error of random ones.
template <class M, template <class> class Distribution>
RunningMoments by_evaluating(const M& m, const Distribution<double>& d, const Vec3d& wo, int n) {
  RunningMoments sum;
  for (int i = 0; i < n; ++i) {
    const Vec2<double> u{std::fmod(0.5 + i * 0.7548776662466927, 1),
                         std::fmod(0.5 + i * 0.5698402909980532, 1)};
    const Vec3d wi = i % 2 ? reflect(wo, d.sample_visible(wo, u)) : square_to_cosine_hemisphere(u);
    const double p = 0.5 * facet_reflection_pdf(d, wo, wi) + 0.5 * std::max(wi.z, 0.0) * inv_pi;
    sum.add(wi.z > 0 ? m.eval(wo, wi)[0] * wi.z / p : 0);
  }
  return sum;
}

TEST(WalkConductor, WhiteFacetsReturnAllLight) {
  for (const double alpha : {0.05, 0.1, 0.3, 0.5, 0.7, 1.0})
    for (const double theta : {0.0, 30.0, 60.0, 80.0, 89.0, 89.9}) {
      const auto ggx = by_sampling(white_walk<Ggx>(alpha, 0.5 * alpha), at(theta), 3000);
      EXPECT_NEAR(ggx.reflected.mean(), 1, 1e-3) << alpha << " " << theta;
      const auto beckmann = by_sampling(white_walk<Beckmann>(alpha, alpha), at(theta), 1000);
      EXPECT_NEAR(beckmann.reflected.mean(), 1, 1e-3) << alpha << " " << theta;
    }
}
TEST(WalkConductor, BouncesAreManyEnough) {
  EXPECT_NEAR(by_sampling(white_walk<Ggx>(1, 1), at(0), 200000).reflected.mean(), 1, 1e-4);
  EXPECT_NEAR(by_sampling(white_walk<Ggx>(1, 1), at(45), 200000).reflected.mean(), 1, 1e-4);
}
TEST(WalkConductor, EvalIntegratesToAllLight) {
  for (const double alpha : {0.3, 1.0})
    for (const double theta : {10.0, 70.0}) {
      const auto sum =
          by_evaluating(white_walk<Ggx>(alpha, alpha), Ggx<double>{alpha, alpha}, at(theta), 60000);
      EXPECT_NEAR(sum.mean(), 1, 4 * sum.standard_error()) << alpha << " " << theta;
      EXPECT_LT(sum.standard_error(), 0.01);
    }
}
TEST(LongWalkConductor, EvalReturnsAllLightWithinHalfAPercent) {
  for (const double alpha : {0.1, 0.3, 0.5, 0.7, 1.0})
    for (const double theta : {0.0, 30.0, 60.0, 75.0, 85.0, 89.0}) {
      auto ggx = white_walk<Ggx>(alpha, alpha);
      auto beckmann = white_walk<Beckmann>(alpha, alpha);
      ggx.walks = beckmann.walks = 2;
      const auto a = by_evaluating(ggx, Ggx<double>{alpha, alpha}, at(theta), 200000);
      const auto b = by_evaluating(beckmann, Beckmann<double>{alpha, alpha}, at(theta), 80000);
      EXPECT_NEAR(a.mean(), 1, 5e-3) << alpha << " " << theta << " +- " << a.standard_error();
      EXPECT_NEAR(b.mean(), 1, 5e-3) << alpha << " " << theta << " +- " << b.standard_error();
    }
}
TEST(WalkConductor, IsReciprocalInTheMean) {
  auto m = white_walk<Ggx>(0.9, 0.5);
  m.eta = Grey(0.4), m.k = Grey(2.5), m.walks = 16;
  const Vec3d a = at(70, 0.2), b = at(20, 2.8);
  RunningMoments there, back;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d nudged = normalize(b + Vec3d{1e-9 * i, 0, 0});
    there.add(m.eval(a, nudged)[0]);
    back.add(m.eval(nudged, a)[0]);
  }
  EXPECT_NEAR(there.mean(), back.mean(), 5 * (there.standard_error() + back.standard_error()));
  EXPECT_LT(there.standard_error(), 0.01 * there.mean());
}
TEST(WalkConductor, PolishedSurfaceHasOneBounceAlone) {
  auto m = white_walk<Ggx>(1e-3, 1e-3);
  const Vec3d wo = at(40), near_mirror = normalize(Vec3d{-wo.x + 1e-3, -wo.y, wo.z});
  EXPECT_NEAR(m.eval(wo, near_mirror)[0] / m.first_bounce(wo, near_mirror)[0], 1, 1e-3);
}

TEST(WalkDielectric, KeepsAllLight) {
  for (const double alpha : {0.2, 1.0})
    for (const double eta : {1.5, 1 / 1.8})
      for (const double theta : {0.0, 50.0, 89.0, 130.0, 91.0}) {
        auto m = default_model<WalkGgxDielectric<double, 1>>();
        m.eta = eta, m.alpha_x = alpha, m.alpha_y = 0.7 * alpha, m.walks = 1;
        const double eta_ti = theta < 90 ? eta : 1 / eta;
        const Light light = by_sampling(m, at(theta), 2000, eta_ti);
        EXPECT_NEAR(light.reflected.mean() + light.transmitted.mean(), 1, 2e-3)
            << alpha << " " << eta << " " << theta;
      }
}
/// eval and sample are different estimates of the same two albedos.
TEST(WalkDielectric, EvalAgreesWithSample) {
  auto m = default_model<WalkGgxDielectric<double, 1>>();
  m.eta = 1.5, m.alpha_x = m.alpha_y = 0.8, m.walks = 2;
  for (const double theta : {40.0, 120.0}) {
    const Vec3d wo = at(theta);
    const double eta_ti = theta < 90 ? 1.5 : 1 / 1.5;
    const Light sampled = by_sampling(m, wo, 60000, eta_ti);
    RunningMoments reflected, transmitted;
    for (int i = 0; i < 60000; ++i) {
      Vec3d wi = square_to_cosine_hemisphere(Vec2<double>{random(i, 1), random(i, 2)});
      if (i % 2) wi.z = -wi.z;
      const bool same = wi.z * wo.z > 0;
      const double f = 2 * pi * m.eval(wo, wi)[0];
      reflected.add(same ? f : 0);
      transmitted.add(same ? 0 : f * sqr(eta_ti));
    }
    EXPECT_NEAR(reflected.mean(), sampled.reflected.mean(),
                4 * std::hypot(reflected.standard_error(), sampled.reflected.standard_error()));
    EXPECT_NEAR(transmitted.mean(), sampled.transmitted.mean(),
                4 * std::hypot(transmitted.standard_error(), sampled.transmitted.standard_error()));
  }
}
TEST(WalkDielectric, EqualIndicesLetAllLightGoStraightOn) {
  auto m = default_model<WalkGgxDielectric<float, 1>>();
  m.eta = 1;
  const Vec3f wo = vec3<float>(at(50));
  const auto s = m.sample(wo, 0.3f, {0.2f, 0.8f});
  EXPECT_TRUE(s.is_delta);
  EXPECT_EQ(s.wi.z, -wo.z);
  EXPECT_NEAR(s.f[0] * wo.z, 1, 1e-6);
  EXPECT_EQ(m.eval(wo, s.wi)[0], 0);
}

TEST(WalkDiffuse, WhiteFacetsReturnAllLight) {
  auto m = default_model<WalkGgxDiffuse<double, 1>>();
  m.albedo = Grey(1), m.alpha_x = 1, m.alpha_y = 0.6, m.walks = 1;
  for (const double theta : {0.0, 60.0, 89.0})
    EXPECT_NEAR(by_sampling(m, at(theta), 20000).reflected.mean(), 1, 5e-4) << theta;
}
TEST(WalkDiffuse, EvalAgreesWithSample) {
  auto m = default_model<WalkBeckmannDiffuse<double, 1>>();
  m.albedo = Grey(0.7), m.alpha_x = m.alpha_y = 0.9, m.walks = 1;
  for (const double theta : {20.0, 75.0}) {
    const auto sampled = by_sampling(m, at(theta), 20000).reflected;
    const auto sum = by_evaluating(m, Beckmann<double>{0.9, 0.9}, at(theta), 20000);
    EXPECT_NEAR(sum.mean(), sampled.mean(), 4 * std::hypot(sum.standard_error(), sampled.standard_error()));
  }
}
TEST(WalkDiffuse, SmoothSurfaceIsLambertian) {
  auto m = default_model<WalkGgxDiffuse<double, 1>>();
  m.albedo = Grey(0.6), m.alpha_x = m.alpha_y = 1e-3;
  EXPECT_NEAR(m.eval(at(50), at(30, 2))[0], 0.6 * inv_pi, 1e-3);
}

template <class M>
void expect_white_without_noise(double tolerance) {
  auto m = white_metal<M>();
  for (const double alpha : {0.07, 0.3, 0.55, 0.8, 1.0})
    for (const double theta : {0.0, 40.0, 70.0, 85.0}) {
      m.alpha = alpha;
      const auto sum = by_evaluating(m, Ggx<double>{alpha, alpha}, at(theta), 20000);
      EXPECT_NEAR(sum.mean(), 1, tolerance + 4 * sum.standard_error())
          << M::name << " " << alpha << " " << theta;
    }
}
TEST(NoiselessWays, WhiteFacetsReturnAllLight) {
  expect_white_without_noise<InvarianceConductor<double, 1>>(2e-3);
  expect_white_without_noise<KullaContyConductor<double, 1>>(2e-3);
  expect_white_without_noise<TurquinConductor<double, 1>>(2e-3);
}
/// The lobe of later bounces itself, not only its sum.
TEST(InvarianceConductor, IsTheMeanOfWalks) {
  for (const double alpha : {0.4, 1.0}) {
    auto solved = white_metal<InvarianceConductor<double, 1>>();
    solved.alpha = alpha;
    auto walk = white_walk<Ggx>(alpha, alpha);
    walk.walks = 256;
    for (const auto& [wo, wi] : {std::pair{at(20), at(10, 2)}, std::pair{at(60), at(50, 3.5)},
                                 std::pair{at(60), at(50, 0.4)}, std::pair{at(80), at(30, 1.5)}}) {
      RunningMoments walked;
      for (int i = 0; i < 20; ++i)
        walked.add(walk.eval(wo, normalize(wi + Vec3d{1e-9 * i, 0, 0}))[0]);
      const double single = walk.first_bounce(wo, wi)[0], later = solved.eval(wo, wi)[0] - single;
      EXPECT_NEAR(later, walked.mean() - single, 0.03 * later + 5 * walked.standard_error()) << alpha;
    }
  }
}
TEST(TurquinConductor, IsNotReciprocal) {
  auto m = white_metal<TurquinConductor<double, 1>>();
  m.alpha = 1;
  EXPECT_GT(m.eval(at(10), at(80, 3))[0] / m.eval(at(80, 3), at(10))[0], 1.5);
}
TEST(KullaContyDielectric, IsReciprocalAcrossTheSurface) {
  auto m = default_model<KullaContyDielectric<double, 1>>();
  m.eta = 1.7, m.alpha = 0.8;
  const Vec3d above = at(30), below = at(140, 2.0);
  EXPECT_NEAR(m.eval(above, below)[0] / m.eval(below, above)[0], 1 / sqr(1.7), 1e-6);
}
TEST(KullaContyDielectric, KeepsAllLight) {
  auto m = default_model<KullaContyDielectric<double, 1>>();
  m.eta = 1.5;
  for (const double alpha : {0.3, 0.7, 1.0})
    for (const double theta : {20.0, 70.0, 160.0, 110.0}) {
      m.alpha = alpha;
      const auto all = by_sampling(m, at(theta), 20000, theta < 90 ? 1.5 : 1 / 1.5).all;
      EXPECT_NEAR(all.mean(), 1, 2e-3 + 4 * all.standard_error()) << alpha << " " << theta;
    }
}

} // namespace
} // namespace nacre
