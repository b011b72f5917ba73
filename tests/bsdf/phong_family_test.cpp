// The cosine-power lobes: against another program's values of published fits, and against closed forms.
#include "bsdf/models/blinn_phong.h"
#include "bsdf/models/lafortune.h"
#include "bsdf/models/modified_phong.h"
#include "bsdf/models/phong.h"

#include "bsdf/published_fits.h"
#include "core/quadrature.h"
#include "core/random.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

using Gray = Spectrum<double, 1>;
using Rgb = Spectrum<double, 3>;

double random(int i, int d) { return unit_double(hash(3, i, d)); }
Vec3d upper(int i, int d) { return spherical_direction(std::acos(random(i, d)), 2 * pi * random(i, d + 1)); }

/// Integral of f cos over the light's directions.
template <class M>
double albedo(const M& m, double theta) {
  const Vec3d wo = spherical_direction(theta, 0.0);
  return integrate_hemisphere([&](const Vec3d& wi) { return m.eval(wo, wi)[0] * wi.z; }, 200, 400);
}

TEST(ModifiedPhong, HasBbmsValuesOfNgansBlinnPhongFits) {
  const auto d = published_fits::compare("ngan_blinnphong", [](const nlohmann::json& lobe) {
    return ModifiedPhong<double, 3>{{}, published_fits::albedo(lobe), lobe["sharpness"]};
  });
  if (d.count == 0) GTEST_SKIP() << "no published fits beside the project";
  EXPECT_EQ(d.count, 3 * 1075);
  EXPECT_LT(d.worst, 1e-6) << d.where;
}

// The fits mean the half vector; that program evaluates them about the mirror direction. Where the half
// vector is the normal the two agree; about a lobe's flank they do not.
TEST(BlinnPhong, HasBbmsValuesOfNgansFitsInTheMirrorDirectionAlone) {
  const auto make = [](const nlohmann::json& lobe) {
    return BlinnPhong<double, 3>{{}, published_fits::albedo(lobe), lobe["sharpness"]};
  };
  const auto mirror = published_fits::compare("ngan_blinnphong", make, [](const published_fits::Row& r) {
    return r.theta_i == r.theta_o && (r.phi == 180 || r.theta_i == 0);
  });
  if (mirror.count == 0) GTEST_SKIP() << "no published fits beside the project";
  EXPECT_EQ(mirror.count, 43 * 5 * 3);
  EXPECT_LT(mirror.worst, 1e-6) << mirror.where;
  EXPECT_GT(published_fits::compare("ngan_blinnphong", make).beyond, 500);
}

TEST(Lafortune, HasBbmsValuesOfNgansFits) {
  const auto d = published_fits::compare("ngan_lafortune", [](const nlohmann::json& lobe) {
    const double xy = lobe["Cxy"], z = lobe["Cz"], n = lobe["sharpness"];
    return Lafortune<double, 3>{{}, published_fits::albedo(lobe), Rgb(xy), Rgb(xy), Rgb(z), Rgb(n)};
  });
  if (d.count == 0) GTEST_SKIP() << "no published fits beside the project";
  EXPECT_EQ(d.count, 3 * 650);
  EXPECT_LT(d.worst, 1e-6) << d.where;
}

TEST(Lafortune, WithPhongsCoefficientsIsModifiedPhong) {
  const Lafortune<double, 1> general{{}, Gray(0.7), Gray(-0.5), Gray(-0.5), Gray(0.5), Gray(30)};
  const ModifiedPhong<double, 1> phong{{}, Gray(0.7), 30};
  for (int i = 0; i < 200; ++i) {
    const Vec3d wo = upper(i, 0), wi = upper(i, 2);
    EXPECT_NEAR(general.eval(wo, wi)[0], phong.eval(wo, wi)[0], 1e-12);
    EXPECT_NEAR(general.pdf(wo, wi), phong.pdf(wo, wi), 1e-12);
  }
}

// Table 1 of the paper's kind: a channel's own C and n and no normalisation. Red of the blue paint.
TEST(Lafortune, AnUnnormalisedPublishedLobeConverts) {
  const double cx = -1.031545, cz = 0.706734, n = 66.89906;
  const double rho = 2 * pi * std::pow(-cx, n) / (n + 2);
  const Lafortune<double, 1> m{{}, Gray(rho), Gray(cx), Gray(cx), Gray(cz), Gray(n)};
  for (int i = 0; i < 200; ++i) {
    const Vec3d wo = upper(i, 0), wi = upper(i, 2);
    const double base = cx * wo.x * wi.x + cx * wo.y * wi.y + cz * wo.z * wi.z;
    const double f = base > 0 ? std::pow(base, n) : 0;
    EXPECT_NEAR(m.eval(wo, wi)[0], f, 1e-9 * f + 1e-15);
  }
}

TEST(Lafortune, UnequalCoefficientsInThePlaneAreAnisotropic) {
  const Lafortune<double, 1> m{{}, Gray(0.5), Gray(-1), Gray(-0.8), Gray(0.9), Gray(20)};
  const auto mirror = [&](double phi) {
    return m.eval(spherical_direction(0.8, phi), spherical_direction(0.8, phi + pi))[0];
  };
  EXPECT_GT(mirror(0), 5 * mirror(pi / 2));
}

TEST(Lafortune, NeverGainsMoreThanItsReflectance) {
  for (int i = 0; i < 40; ++i) {
    const auto c = [&](int d) { return Gray(3 * random(i, d) - 1.5); };
    const Lafortune<double, 1> m{{}, Gray(1), c(0), c(1), c(2), Gray(std::pow(200.0, random(i, 3)))};
    for (const double theta : {0.0, 0.5, 1.0, 1.5})
      EXPECT_LE(albedo(m, theta), 1 + 1e-4) << i << " " << theta;
  }
}

TEST(ModifiedPhong, AlbedoIsItsReflectanceAlongTheNormalAndLessElsewhere) {
  for (const double n : {1.0, 3.0, 20.0, 300.0}) {
    const ModifiedPhong<double, 1> m{{}, Gray(0.8), n};
    EXPECT_NEAR(albedo(m, 0), 0.8, 1e-4) << n;
    for (const double theta : {0.3, 0.6, 0.9, 1.2, 1.5})
      EXPECT_LT(albedo(m, theta), 0.8);
  }
}

// Walter 2005: dwi = 4 cos(theta_h) dwh about the normal, and light above the horizon has theta_h < 45
// degrees.
TEST(BlinnPhong, GainsUpToThreeTimesItsReflectance) {
  for (const double n : {1.0, 20.0, 300.0}) {
    const double c = std::sqrt(0.5),
                 expected = 4 * (n + 2) *
                            (2 * (1 - std::pow(c, n + 4)) / (n + 4) - (1 - std::pow(c, n + 2)) / (n + 2));
    EXPECT_NEAR(albedo(BlinnPhong<double, 1>{{}, Gray(1), n}, 0), expected, 1e-3) << n;
    EXPECT_LT(expected, 1 + (BlinnPhong<double, 1>::laws.energy_gain));
  }
}

TEST(Phong, AlbedoIsNotNormalisedAndReachesPi) {
  for (const double n : {1.0, 5.0, 50.0})
    EXPECT_NEAR(albedo(Phong<double, 1>{{}, Gray(1), n}, 0), 2 * pi / (n + 1), 1e-3) << n;
  EXPECT_NEAR(1 + (Phong<double, 1>::laws.energy_gain), pi, 1e-12);
}

TEST(Phong, BreaksReciprocityByTheRatioOfCosines) {
  const Phong<double, 1> m{{}, Gray(1), 4};
  for (int i = 0; i < 100; ++i) {
    const Vec3d wo = upper(i, 0), wi = upper(i, 2);
    EXPECT_NEAR(m.eval(wo, wi)[0] * wi.z, m.eval(wi, wo)[0] * wo.z, 1e-12);
  }
}

TEST(Phong, IsSampledExactly) {
  const Phong<double, 1> m{{}, Gray(0.6), 12};
  for (int i = 0; i < 100; ++i) {
    const auto s = m.sample(upper(i, 0), 0, {random(i, 2), random(i, 3)});
    if (s.pdf == 0) continue; // below the horizon
    EXPECT_NEAR(s.f[0] * s.wi.z / s.pdf, 0.6 * 2 * pi / 13, 1e-12);
  }
}

TEST(PowerLobe, KeepsItsDigitsAtLargeExponentsInFloat) {
  for (const double x : {1e-12, 1e-8, 1e-6, 1e-4, 0.01, 0.5}) {
    EXPECT_NEAR(log_one_minus(x), std::log1p(-x), 4e-16 * x / (1 - x)) << x;
    EXPECT_NEAR(log_one_minus(float(x)), std::log1p(-double(float(x))), 2e-7 * x / (1 - x)) << x;
    EXPECT_NEAR(one_minus_exp(x), -std::expm1(-x), 4e-16 * x) << x;
    EXPECT_NEAR(one_minus_exp(float(x)), -std::expm1(-double(float(x))), 2e-7 * x) << x;
  }
  EXPECT_EQ(log_one_minus(0.0), 0);
  EXPECT_EQ(one_minus_exp(0.0), 0);
  EXPECT_NEAR(one_minus_exp(200.0), 1, 1e-15);
}

} // namespace
} // namespace nacre
