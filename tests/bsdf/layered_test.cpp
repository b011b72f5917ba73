// Coats over bases: the random walk against closed forms of its limits, Belcour's statistics against the
// walk.
#include "bsdf/models/coated_conductor.h"
#include "bsdf/models/coated_diffuse.h"
#include "bsdf/models/layered_belcour.h"
#include "bsdf/models/rough_plastic.h"
#include "bsdf/models/smooth_plastic.h"
#include "bsdf/models/thin_dielectric.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

double random(int i, int d) { return unit_double(hash(5, i, d)); }

struct Mean {
  double value = 0, error = 0; ///< standard error
};
template <class F>
Mean mean(int n, F f) {
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    const double x = f(i);
    sum += x, squares += x * x;
  }
  const double m = sum / n;
  return {m, std::sqrt(std::max(squares / n - m * m, 0.0) / n)};
}
Vec3d turned(const Vec3d& w, double phi) {
  return {w.x * std::cos(phi) - w.y * std::sin(phi), w.x * std::sin(phi) + w.y * std::cos(phi), w.z};
}
/// The expectation of an isotropic model's noisy eval: turning both directions about the normal changes its
/// random numbers and nothing else.
template <class M>
Mean expected_eval(const M& m, const Vec3d& wo, const Vec3d& wi, int n) {
  return mean(n, [&](int i) {
    const double phi = 2 * pi * random(i, 9);
    return m.eval(turned(wo, phi), turned(wi, phi))[0];
  });
}
template <class M>
Mean sampled_albedo(const M& m, double cos, int n) {
  const Vec3d wo{std::sqrt(1 - cos * cos), 0, cos};
  return mean(n, [&](int i) {
    const auto s = m.sample(wo, random(i, 0), {random(i, 1), random(i, 2)});
    return s.pdf > 0 ? s.f[0] * s.wi.z / s.pdf : 0;
  });
}
/// By eval, at directions of the model's own pdf and sampling of its twin in distribution: a mixture of the
/// cosine and the coat's facets.
template <class M>
Mean evaluated_albedo(const M& m, double cos, double alpha, int n) {
  const Vec3d wo{std::sqrt(1 - cos * cos), 0, cos};
  const Ggx<double> d{alpha, alpha};
  return mean(n, [&](int i) {
    const Vec2<double> u{random(i, 1), random(i, 2)};
    const Vec3d wi =
        random(i, 0) < 0.5 ? square_to_cosine_hemisphere(u) : reflect(wo, d.sample_visible(wo, u));
    const double p = 0.5 * std::max(wi.z, 0.0) * inv_pi + 0.5 * facet_reflection_pdf(d, wo, wi);
    return wi.z > 0 ? m.eval(wo, wi)[0] * wi.z / p : 0;
  });
}

using Diffuse = CoatedDiffuse<double, 1>;
using Conductor = CoatedConductor<double, 1>;

Diffuse white_under(double eta, double alpha) {
  Diffuse m = default_model<Diffuse>();
  m.reflectance[0] = 1, m.eta = eta, m.alpha = alpha;
  return m;
}

#define EXPECT_MEAN(m, truth, tolerance)                                                                     \
  EXPECT_NEAR((m).value, truth, 4.5 * (m).error + (tolerance)) << "+- " << (m).error

// 5e-3: the table of what facets lose.
TEST(CoatedDiffuse, WhiteBaseReflectsEverythingAtEveryRoughness) {
  for (const double eta : {1.05, 1.5, 2.5})
    for (const double alpha : {1e-3, 0.1, 0.4, 1.0})
      for (const double cos : {1.0, 0.6, 0.1}) {
        const Diffuse m = white_under(eta, alpha);
        const double tolerance = alpha < 0.01 ? 1e-3 : 5e-3;
        EXPECT_MEAN(sampled_albedo(m, cos, 3000), 1, tolerance) << eta << " " << alpha << " " << cos;
        EXPECT_MEAN(evaluated_albedo(m, cos, alpha, 3000), 1, tolerance) << eta << " " << alpha << " " << cos;
      }
}

TEST(CoatedDiffuse, WithoutCompensationLosesWhatFacetsLose) {
  Diffuse m = white_under(1.5, 0.3);
  m.compensation = 0;
  const double plastic = [] {
    auto p = default_model<GgxPlastic<double, 1>>();
    p.diffuse_reflectance[0] = 1, p.alpha = 0.3;
    return sampled_albedo(p, 0.6, 20000).value;
  }();
  const Mean s = sampled_albedo(m, 0.6, 20000), e = evaluated_albedo(m, 0.6, 0.3, 20000);
  EXPECT_MEAN(s, plastic, 0.01);
  EXPECT_MEAN(e, plastic, 0.01);
  EXPECT_LT(s.value, 0.75); // a third of the light is gone: why there is compensation
}

TEST(CoatedDiffuse, ScatteringWithoutAbsorptionLosesNothing) {
  for (const double g : {-0.5, 0.0, 0.8})
    for (const double thickness : {0.3, 5.0}) {
      Diffuse m = white_under(1.5, 1e-3);
      m.optical_thickness[0] = thickness, m.albedo[0] = 1, m.g = g;
      EXPECT_MEAN(sampled_albedo(m, 0.7, 3000), 1, 1e-3);
      EXPECT_MEAN(evaluated_albedo(m, 0.7, 1e-3, 10000), 1, 1e-3);
    }
}

// Channels share a path; what one channel's extinction chose must not harm another.
TEST(CoatedDiffuse, ChannelsOfUnlikeMediaKeepTheirEnergy) {
  auto m = default_model<CoatedDiffuse<double, 3>>();
  m.reflectance = Spectrum<double, 3>(1.0), m.alpha = 1e-3;
  m.optical_thickness = Spectrum<double, 3>({5.0, 0.5, 0.0});
  m.albedo = Spectrum<double, 3>(1.0);
  const Vec3d wo{0.6, 0, 0.8};
  for (int c = 0; c < 3; ++c) {
    const Mean albedo = mean(10000, [&](int i) {
      const auto s = m.sample(wo, random(i, 0), {random(i, 1), random(i, 2)});
      return s.pdf > 0 ? s.f[c] * s.wi.z / s.pdf : 0;
    });
    EXPECT_MEAN(albedo, 1, 1e-3);
    EXPECT_LT(albedo.error, 0.02);
  }
}

TEST(CoatedDiffuse, IsSaundersonsPlasticInTheSmoothLimit) {
  auto plastic = default_model<SmoothPlastic<double, 1>>();
  Diffuse m = default_model<Diffuse>();
  m.alpha = 1e-3, m.walks = 16;
  for (const double reflectance : {0.3, 0.9})
    for (const double theta : {0.1, 0.8, 1.3}) {
      plastic.diffuse_reflectance[0] = m.reflectance[0] = reflectance;
      const Vec3d wo = spherical_direction(theta, 0.0), wi = spherical_direction(0.6, 2.0);
      const double truth = plastic.eval(wo, wi)[0];
      const Mean f = expected_eval(m, wo, wi, 1000);
      EXPECT_MEAN(f, truth, 1e-3 * truth);
      EXPECT_LT(f.error, 0.02 * truth);
    }
}

// Where bounces are few (a dark base) the tabulated transmittances of ggx_plastic tell the truth.
TEST(CoatedDiffuse, IsGgxPlasticOverADarkBase) {
  auto plastic = default_model<GgxPlastic<double, 1>>();
  Diffuse m = default_model<Diffuse>();
  m.walks = 16, m.compensation = 0, plastic.diffuse_reflectance[0] = m.reflectance[0] = 0.1;
  for (const double alpha : {0.1, 0.4}) {
    plastic.alpha = m.alpha = alpha;
    for (const double theta : {0.1, 0.8}) {
      const Vec3d wo = spherical_direction(theta, 0.0), wi = spherical_direction(0.6, 2.0);
      const double truth = plastic.eval(wo, wi)[0];
      EXPECT_MEAN(expected_eval(m, wo, wi, 1000), truth, 0.015 * truth);
    }
  }
}

TEST(CoatedDiffuse, AbsorptionFollowsBeersLawOverADarkBase) {
  Diffuse m = default_model<Diffuse>();
  m.alpha = 1e-3, m.reflectance[0] = 0.01, m.optical_thickness[0] = 0.7, m.walks = 16;
  auto clear = default_model<SmoothPlastic<double, 1>>();
  clear.diffuse_reflectance[0] = 0.01;
  const Vec3d wo = spherical_direction(0.9, 0.0), wi = spherical_direction(0.4, 2.0);
  const auto inside = [&](const Vec3d& w) { return -fresnel_dielectric(w.z, 1.5).cos_t; };
  const double truth = clear.eval(wo, wi)[0] * std::exp(-0.7 / inside(wo) - 0.7 / inside(wi));
  EXPECT_MEAN(expected_eval(m, wo, wi, 1000), truth, 0.006 * truth); // second bounces take another way
}

// Chandrasekhar 1960, Radiative Transfer, single scattering of a slab over black, seen through the interface.
TEST(CoatedDiffuse, ThinMediumOverBlackScattersOnce) {
  Diffuse m = default_model<Diffuse>();
  m.alpha = 1e-3, m.reflectance[0] = 0, m.optical_thickness[0] = 0.01, m.albedo[0] = 0.8, m.g = 0.4;
  m.walks = 32;
  const Vec3d wo = spherical_direction(0.9, 0.0), wi = spherical_direction(0.4, 2.0);
  const auto refracted = [&](const Vec3d& w) {
    return Vec3d{w.x / 1.5, w.y / 1.5, -fresnel_dielectric(w.z, 1.5).cos_t};
  };
  const auto passed = [&](const Vec3d& w) { return 1 - fresnel_dielectric(w.z, 1.5).reflectance; };
  const Vec3d o = refracted(wo), i = refracted(wi);
  const double tau = 0.01, way = 1 / o.z + 1 / i.z;
  const double truth = passed(wo) * passed(wi) / (1.5 * 1.5) * 0.8 * henyey_greenstein(-dot(o, i), 0.4) /
                       (o.z * i.z) * (1 - std::exp(-tau * way)) / way;
  const Mean f = expected_eval(m, wo, wi, 8000);
  EXPECT_MEAN(f, truth, 0.03 * truth); // of second scattering and light reflected inside before
  EXPECT_LT(f.error, 0.03 * truth);
}

TEST(CoatedDiffuse, SampleAndEvalCarryTheSameEnergy) {
  for (const double alpha : {0.05, 0.3, 1.0})
    for (const double cos : {0.95, 0.3}) {
      Diffuse m = white_under(1.5, alpha);
      m.optical_thickness[0] = 0.5, m.albedo[0] = 0.7, m.g = 0.3;
      const Mean s = sampled_albedo(m, cos, 20000), e = evaluated_albedo(m, cos, alpha, 20000);
      EXPECT_NEAR(s.value, e.value, 4.5 * std::hypot(s.error, e.error) + 5e-3) << alpha << " " << cos;
      EXPECT_LT(s.value, 1);
    }
}

TEST(CoatedConductor, SampleAndEvalCarryTheSameEnergy) {
  for (const double alpha : {0.1, 0.5})
    for (const double cos : {0.95, 0.4}) {
      Conductor m = default_model<Conductor>();
      m.coat_alpha = alpha, m.base_alpha = 0.4;
      const Mean s = sampled_albedo(m, cos, 20000), e = evaluated_albedo(m, cos, 0.5, 20000);
      EXPECT_NEAR(s.value, e.value, 4.5 * std::hypot(s.error, e.error) + 5e-3) << alpha << " " << cos;
      EXPECT_LT(s.value, 1);
    }
}

// Through a smooth coat of little reflection light meets the metal once, in refracted directions.
TEST(CoatedConductor, IsTheRefractedMetalUnderAFaintSmoothCoat) {
  Conductor m = default_model<Conductor>();
  m.coat_eta = 1.05, m.coat_alpha = 1e-3, m.base_alpha = 0.1, m.walks = 16;
  auto metal = default_model<GgxConductor<double, 1>>();
  metal.eta[0] /= 1.05, metal.k[0] /= 1.05, metal.alpha_x = metal.alpha_y = 0.1;
  const Vec3d wo = spherical_direction(0.4, 0.0), wi = spherical_direction(0.3, 3.0);
  const auto refracted = [&](const Vec3d& w) {
    return Vec3d{w.x / 1.05, w.y / 1.05, -fresnel_dielectric(w.z, 1.05).cos_t};
  };
  const auto passed = [&](const Vec3d& w) { return 1 - fresnel_dielectric(w.z, 1.05).reflectance; };
  const double truth = passed(wo) * passed(wi) / (1.05 * 1.05) * metal.eval(refracted(wo), refracted(wi))[0];
  EXPECT_MEAN(expected_eval(m, wo, wi, 500), truth, 0.005 * truth);
}

template <class M>
void expect_reciprocal(const M& m) {
  for (int k = 0; k < 4; ++k) {
    const Vec3d a = spherical_direction(1.2 * random(k, 20), 0.0);
    const Vec3d b = spherical_direction(1.2 * random(k, 21), 2 * pi * random(k, 22));
    const Mean ab = expected_eval(m, a, b, 3000), ba = expected_eval(m, b, a, 3000);
    EXPECT_NEAR(ab.value, ba.value, 4.5 * std::hypot(ab.error, ba.error)) << k;
    EXPECT_LT(ab.error, 0.05 * ab.value) << k;
  }
}
TEST(CoatedDiffuse, ExpectationIsReciprocal) {
  Diffuse m = default_model<Diffuse>();
  m.alpha = 0.3, m.optical_thickness[0] = 1, m.albedo[0] = 0.8, m.g = 0.5, m.walks = 4;
  expect_reciprocal(m);
}
TEST(CoatedConductor, ExpectationIsReciprocal) {
  Conductor m = default_model<Conductor>();
  m.coat_alpha = 0.2, m.base_alpha = 0.4, m.optical_thickness[0] = 0.5, m.albedo[0] = 0.5, m.walks = 4;
  expect_reciprocal(m);
}

// The derivative of an estimate is an estimate of the derivative.
TEST(LongCoatedConductor, DerivativesAreThoseOfTheExpectation) {
  using D = Dual<double, 3>;
  const Vec3d wo = spherical_direction(0.5, 0.0), wi = spherical_direction(0.5, 3.0);
  const auto at = [&]<class R>(const R& eta, const R& coat_alpha, const R& base_alpha) {
    auto m = default_model<CoatedConductor<R, 1>>();
    m.coat_eta = eta, m.coat_alpha = coat_alpha, m.base_alpha = base_alpha, m.walks = R(8);
    return m;
  };
  const auto dual = at(D::variable(1.5, 0), D::variable(0.3, 1), D::variable(0.3, 2));
  for (int k = 0; k < 3; ++k) {
    const Mean slope = mean(4000, [&](int i) {
      const double phi = 2 * pi * random(i, 9);
      return dual.eval(vec3<D>(turned(wo, phi)), vec3<D>(turned(wi, phi)))[0].d[std::size_t(k)];
    });
    const double h = 0.03;
    const auto moved = [&](double step) {
      return expected_eval(at(1.5 + (k == 0) * step, 0.3 + (k == 1) * step, 0.3 + (k == 2) * step), wo, wi,
                           20000);
    };
    const Mean high = moved(h), low = moved(-h);
    const double difference = (high.value - low.value) / (2 * h);
    const double error = std::hypot(high.error, low.error) / (2 * h);
    EXPECT_NEAR(slope.value, difference, 4 * std::hypot(slope.error, error) + 0.02 * std::abs(difference))
        << k;
    EXPECT_GT(std::abs(difference), 5 * error) << k; // the test can tell
  }
}

TEST(CoatedDiffuse, PacksDrawTheNumbersOfTheirLanes) {
  auto scalar = default_model<CoatedDiffuse<float, 1>>();
  scalar.optical_thickness[0] = 1, scalar.albedo[0] = 0.5, scalar.walks = 3;
  auto packed = default_model<CoatedDiffuse<Pack, 1>>();
  packed.optical_thickness[0] = 1, packed.albedo[0] = 0.5f, packed.walks = 3;
  int same = 0, all = 0;
  for (int i = 0; i < 50; ++i) {
    std::array<float, pack_width> x, z;
    for (std::size_t l = 0; l < pack_width; ++l)
      z[l] = float(0.2 + 0.7 * random(i, int(l))), x[l] = std::sqrt(1 - z[l] * z[l]);
    const Vec3<Pack> wi{load(x.data()), Pack(0.0f), load(z.data())};
    const Pack f = packed.eval({Pack(0.0f), Pack(0.6f), Pack(0.8f)}, wi)[0];
    for (std::size_t l = 0; l < pack_width; ++l) {
      const float one = scalar.eval({0, 0.6f, 0.8f}, {x[l], 0, z[l]})[0];
      ++all, same += std::abs(lane(f, l) - one) <= 1e-3f * one + 1e-6f;
    }
  }
  EXPECT_GE(same, all * 97 / 100); // a rounding may send a walk another way
}

using Belcour = BelcourCoatedConductor<double, 1>;

// Of one smooth layer over another everything is known: bounces between two mirrors.
TEST(BelcourCoatedConductor, EnergyIsExactForSmoothLayers) {
  auto m = default_model<Belcour>();
  m.base_alpha = m.coat_alpha = 1e-3;
  auto walk = default_model<Conductor>();
  walk.base_alpha = walk.coat_alpha = 1e-3;
  for (const double cos : {1.0, 0.6, 0.3})
    EXPECT_MEAN(sampled_albedo(walk, cos, 4000), sampled_albedo(m, cos, 4000).value, 2e-3);
}

// A rough metal sends light beyond the critical angle, where the coat traps it; a lobe known by its mean and
// variance has no such part.
TEST(BelcourCoatedConductor, AlbedoExceedsTheWalksByTrappedLight) {
  for (const double coat : {0.05, 0.3})
    for (const double base : {0.1, 0.4})
      for (const double cos : {1.0, 0.5}) {
        auto m = default_model<Belcour>();
        m.coat_alpha = coat, m.base_alpha = base, m.absorption[0] = 0.2;
        auto walk = default_model<Conductor>();
        walk.coat_alpha = coat, walk.base_alpha = base, walk.optical_thickness[0] = 0.2;
        const double truth = sampled_albedo(walk, cos, 20000).value,
                     stated = sampled_albedo(m, cos, 2000).value;
        EXPECT_GT(stated, truth) << coat << " " << base << " " << cos;
        EXPECT_LT(stated, truth + 0.14) << coat << " " << base << " " << cos;
      }
}

TEST(BelcourLayered, EqualIndicesLeaveOnlyTheCoat) {
  auto m = default_model<BelcourLayered<double, 1>>();
  m.eta[0] = m.coat_eta;
  const Vec3d wo = spherical_direction(0.4, 0.0), wi = spherical_direction(0.5, 3.0);
  const CoatInterface<double> coat(m.coat_eta, m.coat_alpha, 0);
  const double truth = coat.reflect(coat.ray(wo, false), coat.ray(wi, false), false);
  EXPECT_NEAR(m.eval(wo, wi)[0], truth, 0.01 * truth);
}

TEST(ThinDielectric, NormalIncidenceIsTheSeriesOfBounces) {
  const auto m = default_model<ThinDielectric<double, 1>>();
  const auto mirror = m.sample({0, 0, 1}, 0.0, {0.5, 0.5}), through = m.sample({0, 0, -1}, 0.99, {0.5, 0.5});
  EXPECT_NEAR(mirror.f[0], 1.0 / 13, 1e-12); // 2 F / (1 + F), F = 0.04
  EXPECT_NEAR(through.f[0], 12.0 / 13, 1e-12);
  EXPECT_EQ(mirror.wi.z, 1);
  EXPECT_EQ(through.wi.z, 1);
  EXPECT_TRUE(mirror.is_delta && through.is_delta);
}

TEST(ThinDielectric, TotalReflectionLetsNothingThrough) {
  auto m = default_model<ThinDielectric<double, 1>>();
  m.eta = 0.5;
  const auto s = m.sample({0.8, 0, 0.6}, 0.999, {0.5, 0.5});
  EXPECT_NEAR(s.f[0] * std::abs(s.wi.z) / s.pdf, 1, 1e-12);
  EXPECT_EQ(s.wi.x, -0.8);
  EXPECT_EQ(s.wi.z, 0.6);
}

} // namespace
} // namespace nacre
