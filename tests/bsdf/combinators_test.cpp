// Combinators keep what their parts keep: energy, reciprocity, and sampling that agrees with eval.
#include "bsdf/combinators.h"

#include "bsdf/models/ggx_schlick.h"
#include "bsdf/models/lambert.h"
#include "bsdf/models/smooth_conductor.h"
#include "bsdf/models/smooth_dielectric.h"
#include "core/quadrature.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

using WhiteLambert = Lambert<double, 1>;
using Gloss = GgxSchlick<double, 1>;
using Mirror = SmoothConductor<double, 1>;

double random(int i, int d) { return unit_double(hash(3, i, d)); }
Vec3d direction(double cos, double phi = 0.3) { return spherical_direction(std::acos(cos), phi); }

WhiteLambert lambert(double reflectance) {
  WhiteLambert m;
  m.reflectance[0] = reflectance;
  return m;
}
Gloss gloss(double f0, double alpha) {
  Gloss m;
  m.f0[0] = f0, m.alpha = alpha;
  return m;
}
Mirror perfect_mirror() {
  Mirror m = default_model<Mirror>();
  m.k[0] = 30, m.eta[0] = 0.01;
  return m;
}

/// By eval; directions of the whole sphere.
template <class M>
double albedo(const M& m, const Vec3d& wo, int n_theta = 96, int n_phi = 192) {
  return integrate_hemisphere(
      [&](const Vec3d& w) {
        return (m.eval(wo, w)[0] + m.eval(wo, {w.x, w.y, -w.z})[0]) * w.z;
      },
      n_theta, n_phi);
}
template <class M>
double mass(const M& m, const Vec3d& wo) {
  return integrate_hemisphere(
      [&](const Vec3d& w) {
        return m.pdf(wo, w) + m.pdf(wo, {w.x, w.y, -w.z});
      },
      96, 192);
}

struct Sampled {
  double albedo = 0, error = 0, found = 0, delta = 0;
};
/// The albedo by sampling, the share of samples that are valid and of those that are not delta; where they
/// are not, f and pdf must be eval's and pdf's.
template <class M>
Sampled sample_many(const M& m, const Vec3d& wo, int n = 20000) {
  Sampled r;
  double squares = 0;
  for (int i = 0; i < n; ++i) {
    const auto s = m.sample(wo, random(i, 0), {random(i, 1), random(i, 2)});
    if (!(s.pdf > 0)) continue;
    if (!s.is_delta) {
      EXPECT_NEAR(s.f[0], m.eval(wo, s.wi)[0], 1e-9 * s.f[0]);
      EXPECT_NEAR(s.pdf, m.pdf(wo, s.wi), 1e-9 * s.pdf);
      r.found += 1.0 / n;
    } else
      r.delta += 1.0 / n;
    const double w = s.f[0] * std::abs(s.wi.z) / s.pdf;
    r.albedo += w / n, squares += w * w / n;
  }
  r.error = std::sqrt(std::max(squares - r.albedo * r.albedo, 0.0) / n);
  return r;
}

/// Sampling has the energy of eval and finds directions as often as the pdf says.
template <class M>
void expect_sampling_agrees(const M& m, const Vec3d& wo, double quadrature_error = 2e-3) {
  const Sampled s = sample_many(m, wo);
  EXPECT_NEAR(s.albedo, albedo(m, wo), 4.5 * s.error + quadrature_error);
  EXPECT_NEAR(s.found, mass(m, wo), 4.5 * 0.5 / std::sqrt(20000) + quadrature_error);
  // Moments of the directions.
  double mean_x = 0, mean_z = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto x = m.sample(wo, random(i, 0), {random(i, 1), random(i, 2)});
    if (x.pdf > 0) mean_x += x.wi.x / 20000, mean_z += x.wi.z / 20000;
  }
  const auto moment = [&](auto f) {
    return integrate_hemisphere([&](const Vec3d& w) { return m.pdf(wo, w) * f(w); }, 96, 192);
  };
  EXPECT_NEAR(mean_x, moment([](const Vec3d& w) { return w.x; }), 0.02);
  EXPECT_NEAR(mean_z, moment([](const Vec3d& w) { return w.z; }), 0.02);
}
template <class M>
void expect_reciprocal(const M& m) {
  for (int i = 0; i < 500; ++i) {
    const Vec3d a = direction(random(i, 5), 2 * pi * random(i, 6)),
                b = direction(random(i, 7), 6 * random(i, 8));
    const double f = m.eval(a, b)[0];
    EXPECT_NEAR(f, m.eval(b, a)[0], 1e-9 * f + 1e-12);
  }
}

const Vec3d tilts[] = {bump_normal(0.2, 0.1), bump_normal(-0.5, 0.4), bump_normal(1.5, 0.0),
                       bump_normal(0.0, -2.5)};

TEST(Scaled, ScalesTheAlbedo) {
  const Scaled<WhiteLambert> m{lambert(0.8), Spectrum<double, 1>(0.5)};
  EXPECT_NEAR(albedo(m, direction(0.6)), 0.4, 1e-6);
  expect_sampling_agrees(m, direction(0.6));
  expect_reciprocal(m);
}

TEST(TwoSided, BackIsTheFrontTurnedOver) {
  const TwoSided<Gloss> m{gloss(0.6, 0.4)};
  const Vec3d wo = direction(0.7), wi = direction(0.4, 2.0);
  EXPECT_GT(m.eval(wo, wi)[0], 0);
  EXPECT_EQ(m.eval(-wo, -wi)[0], m.eval({-wo.x, -wo.y, wo.z}, {-wi.x, -wi.y, wi.z})[0]);
  EXPECT_EQ(m.eval(wo, -wi)[0], 0);
  const auto s = m.sample(-wo, 0.3, {0.4, 0.6});
  EXPECT_LT(s.wi.z, 0);
  EXPECT_NEAR(s.f[0], m.eval(-wo, s.wi)[0], 1e-12);
  EXPECT_NEAR(sample_many(m, -wo).albedo, albedo(m, -wo), 0.01);
}

TEST(Masked, CoverAndHolesShareTheLight) {
  const Masked<WhiteLambert> m{lambert(1), 0.3};
  const Sampled s = sample_many(m, direction(0.6));
  EXPECT_NEAR(s.albedo, 1, 1e-9); // every weight is 1
  EXPECT_NEAR(s.delta, 0.7, 0.02);
  EXPECT_NEAR(albedo(m, direction(0.6)), 0.3, 1e-6);
  for (const double opacity : {0.0, 1.0}) {
    const Sampled end = sample_many(Masked<WhiteLambert>{lambert(1), opacity}, direction(0.6));
    EXPECT_EQ(end.delta > 0, opacity == 0);
    EXPECT_NEAR(end.albedo, 1, 1e-9);
  }
  EXPECT_TRUE(m.laws.thin && m.laws.transmits);
}

TEST(NormalMapped, UnperturbedIsTheModelItself) {
  const NormalMapped<Gloss> m{gloss(0.5, 0.3), {0, 0, 1}};
  for (int i = 0; i < 100; ++i) {
    const Vec3d a = direction(random(i, 5), 2 * pi * random(i, 6)),
                b = direction(random(i, 7), 6 * random(i, 8));
    EXPECT_NEAR(m.eval(a, b)[0], m.model.eval(a, b)[0], 1e-9 * m.eval(a, b)[0]);
    EXPECT_NEAR(m.pdf(a, b), m.model.pdf(a, b), 1e-9 * m.pdf(a, b));
  }
}

TEST(NormalMapped, IsReciprocalAndNeverGains) {
  for (const Vec3d& n : tilts) {
    const NormalMapped<WhiteLambert> white{lambert(1), n};
    const NormalMapped<Gloss> glossy{gloss(1, 0.5), n};
    expect_reciprocal(white);
    expect_reciprocal(glossy);
    for (const double cos : {1.0, 0.7, 0.3, 0.05})
      for (const double phi : {0.0, 1.0, 2.5, 4.0}) {
        EXPECT_LE(albedo(white, direction(cos, phi)), 1 + 2e-3);
        EXPECT_LE(albedo(glossy, direction(cos, phi)), 1 + 5e-3);
      }
  }
}

// All light reaches the face, by the mirror if not at once, so by etendue the share of what a Lambertian face
// of area 1 / cos sends out again is cos; even where it looks away, where a normal merely exchanged is black.
TEST(NormalMapped, WhiteFaceReturnsTheCosineOfItsTilt) {
  for (const Vec3d& n : tilts)
    for (const double cos : {0.9, 0.4, 0.05})
      for (const double phi : {0.0, 1.5, 3.5})
        EXPECT_NEAR(albedo(NormalMapped<WhiteLambert>{lambert(1), n}, direction(cos, phi)), n.z, 4e-3);
}

TEST(NormalMapped, SampledMirrorLosesOnlyTheLaterBounces) {
  for (const Vec3d& n : {tilts[0], tilts[1]})
    for (const double cos : {0.95, 0.5, 0.1}) {
      const Sampled s = sample_many(NormalMapped<Mirror>{perfect_mirror(), n}, direction(cos, 1.0));
      EXPECT_GT(s.delta, 0.5);
      EXPECT_LE(s.albedo, 1 + 1e-9);
      EXPECT_GT(s.albedo, 0.6);
    }
}

TEST(NormalMapped, SamplingAgrees) {
  for (const Vec3d& n : tilts)
    for (const double phi : {0.5, 3.5}) {
      expect_sampling_agrees(NormalMapped<WhiteLambert>{lambert(0.9), n}, direction(0.5, phi), 5e-3);
      expect_sampling_agrees(NormalMapped<Gloss>{gloss(0.8, 0.5), n}, direction(0.5, phi), 8e-3);
    }
}

TEST(Layered, WhiteBaseNeverGainsAndLosesLittle) {
  for (const double alpha : {0.1, 0.5}) {
    const Gloss top = gloss(0.04, alpha);
    const Layered<Gloss, WhiteLambert> m{top, lambert(1), SampledAlbedo<Gloss>(top)};
    expect_reciprocal(m);
    for (const double cos : {1.0, 0.5, 0.2}) {
      const double a = sample_many(m, direction(cos)).albedo;
      EXPECT_LE(a, 1.01) << alpha << " " << cos;
      EXPECT_GT(a, 0.85) << alpha << " " << cos;
    }
    expect_sampling_agrees(m, direction(0.6), 0.02);
  }
}

TEST(Layered, GlossOverGlossNeverGains) {
  const Gloss top = gloss(0.3, 0.3);
  const Layered<Gloss, Gloss> m{top, gloss(1, 0.2), SampledAlbedo<Gloss>(top)};
  for (const double cos : {1.0, 0.5, 0.2})
    EXPECT_LE(sample_many(m, direction(cos)).albedo, 1.01);
  expect_reciprocal(m);
}

TEST(Layered, DeltaCoatKeepsItsMirror) {
  using Coat = SmoothDielectric<double, 1>;
  const Coat top = default_model<Coat>();
  const Layered<Coat, WhiteLambert> m{top, lambert(1), SampledAlbedo<Coat>(top)};
  const Sampled s = sample_many(m, direction(0.9), 50000);
  EXPECT_GT(s.delta, 0);
  EXPECT_LE(s.albedo, 1 + 4.5 * s.error);
  EXPECT_GT(s.albedo, 0.85);
}

TEST(SampledAlbedo, IsTheAlbedo) {
  const Gloss m = gloss(0.3, 0.4);
  const SampledAlbedo<Gloss> a(m);
  for (const double cos : {1.0, 0.7, 0.25})
    EXPECT_NEAR(a(cos)[0], albedo(m, direction(cos)), 0.004) << cos;
}

} // namespace
} // namespace nacre
