#include "core/quadrature.h"
#include "core/random.h"
#include "core/statistics.h"
#include "measured/measured_albedo.h"
#include "measured/merl_brdf.h"
#include "measured/synthetic_tables.h"

#include <filesystem>
#include <iostream>

#include <gtest/gtest.h>

namespace nacre {
namespace {

double random(std::uint64_t seed, int i, int d) { return unit_double(hash(seed, i, d)); }

/// The upper hemisphere in polar coordinates about the mirror direction of wo, from it (t = 0) to the horizon
/// (t = 1): fine where reflectance is sharp, and no cell straddles the horizon.
struct MirrorChart {
  Vec3d axis, side, across;

  explicit MirrorChart(const Vec3d& wo) : axis{-wo.x, -wo.y, wo.z} {
    const auto frame = Frame<double>::around(axis);
    side = frame.s, across = frame.t;
  }
  double horizon(double azimuth) const {
    return std::atan2(axis.z, -(side.z * std::cos(azimuth) + across.z * std::sin(azimuth)));
  }
  /// Direction at (t, azimuth), and solid angle per dt dazimuth.
  DirectionNode at(double t, double azimuth) const {
    const double range = horizon(azimuth), angle = range * t * t * t;
    return {axis * std::cos(angle) +
                (side * std::cos(azimuth) + across * std::sin(azimuth)) * std::sin(angle),
            std::sin(angle) * 3 * range * t * t};
  }
  /// Where w lies: t and azimuth, both in [0, 1).
  Vec2<double> find(const Vec3d& w) const {
    const double x = dot(w, side), y = dot(w, across), azimuth = std::atan2(y, x);
    const double angle = std::atan2(std::sqrt(x * x + y * y), dot(w, axis));
    return {std::min(std::cbrt(angle / horizon(azimuth)), 1 - 1e-9),
            azimuth / (2 * pi) + (azimuth < 0 ? 1 : 0)};
  }
  /// Integral of f over the part [t0, t1] x [a0, a1] (in [0, 1]) by an n x n midpoint rule.
  template <class F>
  double integrate(double t0, double t1, double a0, double a1, int n, F f) const {
    double sum = 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const auto node = at(t0 + (t1 - t0) * (i + 0.5) / n, 2 * pi * (a0 + (a1 - a0) * (j + 0.5) / n));
        sum += f(node.w) * node.weight;
      }
    return sum * (t1 - t0) * (a1 - a0) * 2 * pi / (n * n);
  }
};

const std::vector<double> angles_deg{0, 1, 12, 37, 60, 78, 87, 89};

struct NamedTable {
  std::string name;
  const MerlTable* table;
};
std::vector<NamedTable> tables() {
  static const MerlTable diffuse = diffuse_table(), glossy = glossy_table(0.2);
  static const MerlTable empty(2, 2, 2, std::vector<MerlTable::Cell>(8));
  static const MerlTable holes =
      MerlTable::tabulate(20, 20, 20, [](double h, double d, double) -> std::array<double, 3> {
        const double f = h > 0.2 && h < 0.5 && d < 0.7 ? -1 : std::exp(-3 * h);
        return {f, f, f};
      });
  return {{"diffuse", &diffuse},
          {"glossy", &glossy},
          {"empty", &empty},
          {"holes", &holes},
          {"alum-bronze", &published_table("alum-bronze")},
          {"chrome", &published_table("chrome")},
          {"beige-fabric", &published_table("beige-fabric")}};
}

TEST(MerlSampling, PdfIntegratesToOne) {
  for (const auto& [name, table] : tables())
    for (const double theta : angles_deg) {
      const Vec3d wo = spherical_direction(theta * pi / 180, 0.7);
      const MerlBrdf<double, 3> model(table);
      const double whole =
          MirrorChart(wo).integrate(0, 1, 0, 1, 500, [&](const Vec3d& wi) { return model.pdf(wo, wi); });
      // Midpoint rule of a function that is constant a cell: first order in the node distance.
      EXPECT_NEAR(whole, 1, 8e-3) << name << " at " << theta << " degrees";
    }
}

TEST(MerlSampling, PdfIntegratesToOneAtGrazing) {
  const Vec3d wo = spherical_direction(89.9 * pi / 180, 0.7);
  for (const std::string name : {"chrome", "beige-fabric"}) {
    const MerlBrdf<double, 3> model(&published_table(name));
    const double whole =
        MirrorChart(wo).integrate(0, 1, 0, 1, 2000, [&](const Vec3d& wi) { return model.pdf(wo, wi); });
    EXPECT_NEAR(whole, 1, 5e-3) << name;
  }
}

template <class R>
void expect_samples_follow_the_pdf() {
  const int n = 60000, n_t = 24, n_azimuth = 16;
  const auto all = tables();
  const double significance = sidak_significance(0.01, static_cast<int>(all.size() * angles_deg.size()));
  for (const auto& [name, table] : all)
    for (const double theta : angles_deg) {
      const Vec3d wo = spherical_direction(theta * pi / 180, -2.1);
      const MirrorChart chart(wo);
      const MerlBrdf<double, 3> reference(table);
      const MerlBrdf<R, 3> model(table);
      std::vector<double> observed(n_t * n_azimuth + 1), expected(n_t * n_azimuth + 1);
      int rejected = 0;
      for (int i = 0; i < n; ++i) {
        const auto u = [&](int d) { return static_cast<R>(unit_float(hash(5, i, d) >> 32)); };
        const auto s = model.sample(vec3<R>(wo), u(0), {u(1), u(2)});
        if (!(s.pdf > 0)) {
          ++rejected;
          continue;
        }
        const Vec2<double> at = chart.find(normalize(Vec3d{s.wi.x, s.wi.y, s.wi.z}));
        observed[static_cast<int>(at.x * n_t) * n_azimuth + static_cast<int>(at.y * n_azimuth)] += 1;
      }
      EXPECT_LT(rejected, n / 1000) << name << " at " << theta;
      double total = 0;
      for (int i = 0; i < n_t; ++i)
        for (int j = 0; j < n_azimuth; ++j)
          total += expected[i * n_azimuth + j] =
              chart.integrate(i / double(n_t), (i + 1.0) / n_t, j / double(n_azimuth), (j + 1.0) / n_azimuth,
                              20, [&](const Vec3d& wi) { return reference.pdf(wo, wi); });
      for (double& e : expected)
        e *= (n - rejected) / total;
      const auto result = chi_square_test(observed, expected);
      EXPECT_GT(result.p, significance)
          << name << " at " << theta << " degrees, statistic " << result.statistic << " with "
          << result.degrees_of_freedom << " degrees of freedom";
    }
}
TEST(MerlSampling, SamplesFollowThePdf) { expect_samples_follow_the_pdf<double>(); }
TEST(MerlSampling, SamplesOfFloatsFollowThePdf) { expect_samples_follow_the_pdf<float>(); }

TEST(MerlSampling, SampleReturnsTheValuesOfEvalAndPdf) {
  const MerlBrdf<float, 3> model(&published_table("alum-bronze"));
  for (int i = 0; i < 2000; ++i) {
    const Vec3f wo = spherical_direction(1.55f * float(random(3, i, 0)), 6.0f * float(random(3, i, 1)));
    const auto s = model.sample(wo, float(random(3, i, 2)), {float(random(3, i, 3)), float(random(3, i, 4))});
    EXPECT_NEAR(length(s.wi), 1, 1e-5);
    EXPECT_FALSE(s.is_delta);
    EXPECT_EQ(s.pdf, model.pdf(wo, s.wi));
    EXPECT_EQ(s.f[1], model.eval(wo, s.wi)[1]);
  }
}

TEST(MerlSampling, PacksSampleWhatFloatsSample) {
  const MerlTable table = glossy_table();
  const MerlBrdf<float, 3> scalar(&table);
  const MerlBrdf<Pack, 3> wide(&table);
  for (int n = 0; n < 50; ++n) {
    float u[5][pack_width];
    for (int d = 0; d < 5; ++d)
      for (std::size_t l = 0; l < pack_width; ++l)
        u[d][l] = float(random(n, l, d)) * 0.999f;
    const Vec3<Pack> wo = spherical_direction(load(u[0]) * Pack(1.7f), load(u[1]) * Pack(6.0f)); // some below
    const auto s = wide.sample(wo, load(u[2]), {load(u[3]), load(u[4])});
    for (std::size_t l = 0; l < pack_width; ++l) {
      const auto one =
          scalar.sample({lane(wo.x, l), lane(wo.y, l), lane(wo.z, l)}, u[2][l], {u[3][l], u[4][l]});
      EXPECT_EQ(lane(s.wi.x, l), one.wi.x);
      EXPECT_EQ(lane(s.wi.z, l), one.wi.z);
      EXPECT_EQ(lane(s.pdf, l) > 0, one.pdf > 0);
    }
  }
}

/// Mean and variance of luminance f cos / pdf over n samples, with numbers of a stratified sequence's kind.
RunningMoments estimate_albedo(const MerlTable& table, const Vec3d& wo, int n) {
  const MerlBrdf<float, 1> model(&table);
  RunningMoments moments;
  for (int i = 0; i < n; ++i) {
    const auto s = model.sample(vec3<float>(wo), float(random(9, i, 0)) * 0.9999999f,
                                {float(random(9, i, 1)) * 0.9999999f, float(random(9, i, 2)) * 0.9999999f});
    moments.add(s.pdf > 0 ? s.f[0] * s.wi.z / s.pdf : 0);
  }
  return moments;
}

TEST(MerlSampling, EstimatorIsUnbiased) {
  for (const auto& [name, table] : tables())
    for (const double theta : {0.0, 40.0, 80.0}) {
      const Vec3d wo = spherical_direction(theta * pi / 180, 0.3);
      const MerlBrdf<double, 1> model(table);
      const double albedo = MirrorChart(wo).integrate(
          0, 1, 0, 1, 500, [&](const Vec3d& wi) { return model.eval(wo, wi)[0] * wi.z; });
      const auto found = estimate_albedo(*table, wo, 40000);
      // 4.5 standard errors: a false alarm in 7e-6 a case; half a per mille for the quadrature.
      EXPECT_NEAR(found.mean(), albedo, 4.5 * found.standard_error() + 5e-4 * albedo)
          << name << " at " << theta;
    }
}

TEST(MerlSampling, VarianceIsBoundedByTheCosineLobe) {
  // With a density in proportion to f cos, weights vary only as f does within a cell.
  for (const auto& [name, table] : tables())
    for (const double theta : {0.0, 40.0, 80.0}) {
      const auto found = estimate_albedo(*table, spherical_direction(theta * pi / 180, 0.3), 20000);
      EXPECT_LE(found.variance(), 0.35 * sqr(found.mean())) << name << " at " << theta;
    }
}

TEST(MerlAlbedo, AgreesWithQuadratureOverDirections) {
  for (const auto& [name, table] : tables())
    for (const double theta : {0.0, 40.0, 80.0}) {
      const Vec3d wo = spherical_direction(theta * pi / 180, 0.0);
      const MerlBrdf<double, 3> model(table);
      const auto found = directional_albedo(*table, wo).reflected;
      for (int c = 0; c < 3; ++c) {
        const double albedo = MirrorChart(wo).integrate(
            0, 1, 0, 1, 500, [&](const Vec3d& wi) { return model.eval(wo, wi)[c] * wi.z; });
        // The reflectance of a table with holes jumps to 0 inside them: first order in the node distance.
        EXPECT_NEAR(found[c], albedo, (name == "holes" ? 5e-3 : 1e-3) * albedo) << name << " at " << theta;
      }
    }
}

TEST(MerlAlbedo, OfAConstantIsPiTimesIt) {
  const MerlTable table = diffuse_table(0.25);
  for (const double theta : {0.0, 0.7, 1.5})
    EXPECT_NEAR(directional_albedo(table, spherical_direction(theta, 0.0)).reflected[0], 0.25 * pi, 2e-3);
}

TEST(MerlSampling, OfMeasuredFilesIsUnbiasedAndItsVarianceKnown) {
  const std::string folder = NACRE_SOURCE_DIR "/../shared/data/measured/merl/";
  for (const std::string name : {"alum-bronze.binary", "gold-metallic-paint.binary"}) {
    if (!std::filesystem::exists(folder + name)) GTEST_SKIP() << "no measured data at " << folder + name;
    const auto table = read_merl(folder + name);
    for (const double theta : {0.0, 30.0, 60.0, 80.0}) {
      const Vec3d wo = spherical_direction(theta * pi / 180, 0.0);
      const MerlBrdf<double, 1> model(table.get());
      const double albedo = MirrorChart(wo).integrate(
          0, 1, 0, 1, 500, [&](const Vec3d& wi) { return model.eval(wo, wi)[0] * wi.z; });
      const auto found = estimate_albedo(*table, wo, 40000);
      std::cout << name << " at " << theta << " degrees: albedo " << albedo << ", variance of f cos / pdf "
                << found.variance() << " (" << found.variance() / sqr(albedo) << " of its square)\n";
      EXPECT_NEAR(found.mean(), albedo, 4.5 * found.standard_error() + 5e-4 * albedo)
          << name << " at " << theta;
      EXPECT_LT(found.variance(), 0.2 * sqr(albedo)) << name << " at " << theta;
    }
  }
}

} // namespace
} // namespace nacre
