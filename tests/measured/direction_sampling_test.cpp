// Importance sampling of whatever is measured: isotropic or not, reflected or let through, with parts
// missing.

#include "measured/direction_sampling.h"

#include "bsdf/user_shader.h"
#include "core/random.h"
#include "core/statistics.h"
#include "measured/function_bsdf.h"
#include "measured/measured_albedo.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

struct Case {
  std::string name;
  const MeasuredBsdf* measured;
  const DirectionSampling* sampling;
  double largest_variance; ///< of f cos / pdf over its squared mean
};

constexpr MeasuredSides both_sides{true, true, true, true}, through{false, false, true, true};

/// Light let through straight, and a little to all sides.
double sheet(const Vec3d& wo, const Vec3d& wi) { return 0.05 + 3 * std::exp((dot(wo, -wi) - 1) / sqr(0.15)); }
/// Back to where it came from.
double retroreflector(const Vec3d& wo, const Vec3d& wi) {
  return 0.1 + 2 * std::exp((dot(wo, wi) - 1) / sqr(0.12));
}

const std::vector<Case>& cases() {
  static const std::vector<Case> all = [] {
    std::vector<Case> list;
    const auto add = [&](const std::string& name, double largest_variance, FunctionBsdf&& f) {
      const auto* kept = new FunctionBsdf(std::move(f)); // live as long as the tests
      list.push_back({name, kept, new DirectionSampling(*kept), largest_variance});
    };
    const auto grey = [](auto f) {
      return [f](const Vec3d& wo, const Vec3d& wi) { return std::array{f(wo, wi), f(wo, wi), f(wo, wi)}; };
    };
    add("conductor", 0.02, function_of("ggx_conductor:alpha_x=0.2,alpha_y=0.2"));
    add("brushed", 0.15, function_of("ggx_conductor:alpha_x=0.08,alpha_y=0.4", false));
    add("glass", 0.2, function_of("ggx_dielectric:alpha_x=0.3,alpha_y=0.3", true, both_sides));
    add("sheet", 0.1, FunctionBsdf(grey(sheet), true, through));
    add("retroreflector", 0.2, FunctionBsdf(grey(retroreflector)));
    add("black", 0, FunctionBsdf(grey([](const Vec3d&, const Vec3d&) { return 0.0; })));
    add("half measured", 0.1, FunctionBsdf(grey([](const Vec3d& wo, const Vec3d& wi) {
          return wo.z > 0.34 && wi.z > 0.34 ? 0.1 + std::exp(-sqr((wo + wi).x) - sqr((wo + wi).y)) : -1.0;
        })));
    const auto add_user = [&](const std::string& name, double largest_variance, const std::string& text) {
      const auto model = UserModel::parse(text, name + ".brdf");
      const auto* kept = new UserBsdf(model, model->initial_values());
      list.push_back({name, kept, new DirectionSampling(*kept), largest_variance});
    };
    add_user("cloth of a user", 0.05, user_shader::cloth());
    add_user("brushed by a user", 0.15,
             user_shader::body("vec3 h = normalize(L + V); float x = dot(h, X) / 0.1, y = dot(h, Y) / 0.4;\n"
                               "return vec3(0.05 + exp(-(x * x + y * y) / (h.z * h.z)));"));
    return list;
  }();
  return all;
}

std::vector<Vec3d> views(const MeasuredBsdf& measured) {
  std::vector<Vec3d> list;
  const MeasuredSides sides = measured.sides();
  for (const double theta : {0.0, 8.0, 33.0, 57.0, 76.0, 88.0})
    for (const double phi : {0.3, 2.4, -1.65}) {
      if (measured.is_isotropic() && phi != 2.4) continue;
      const Vec3d wo = spherical_direction(theta * pi / 180, phi);
      if (sides.reflects_front || sides.transmits_to_front) list.push_back(wo);
      if (sides.reflects_back || sides.transmits_to_back) list.push_back({wo.x, wo.y, -wo.z});
    }
  return list;
}

/// Midpoint rule over a part of the sphere, in polar coordinates about the normal whose steps crowd at the
/// horizon, where densities are steep: theta in units of half a turn from 0 (up) to 1 (down).
template <class F>
double integrate(double t0, double t1, double phi0, double phi1, int n_theta, int n_phi, F f) {
  double sum = 0;
  for (int i = 0; i < n_theta; ++i) {
    const double t = t0 + (t1 - t0) * (i + 0.5) / n_theta, theta = pi * t;
    double ring = 0;
    for (int j = 0; j < n_phi; ++j)
      ring += f(spherical_direction(theta, phi0 + (phi1 - phi0) * (j + 0.5) / n_phi));
    sum += ring * std::sin(theta);
  }
  return sum * pi * (t1 - t0) * (phi1 - phi0) / (n_theta * n_phi);
}

std::string text(const Vec3d& w) {
  return "(" + std::to_string(w.x) + ", " + std::to_string(w.y) + ", " + std::to_string(w.z) + ")";
}

TEST(DirectionSampling, PdfIntegratesToOne) {
  for (const Case& c : cases())
    for (const Vec3d& wo : views(*c.measured)) {
      const double whole =
          integrate(0, 1, 0, 2 * pi, 600, 300, [&](const Vec3d& wi) { return c.sampling->pdf(wo, wi); });
      // Midpoint rule of a function that is constant a cell: first order in the node distance.
      EXPECT_NEAR(whole, 1, 0.02) << c.name << " at " << text(wo);
    }
}

template <class R>
Vec3d sampled(const DirectionSampling& sampling, const Vec3d& wo, int i) {
  const auto u = [&](int d) { return R(unit_float(std::uint32_t(hash(11, i, d) >> 32))); };
  const Vec3<R> wi = sampling.sample(vec3<R>(wo), u(0), Vec2<R>{u(1), u(2)});
  return normalize(Vec3d{double(wi.x), double(wi.y), double(wi.z)});
}

template <class R>
void expect_samples_follow_the_pdf() {
  constexpr int n = 20000, n_t = 24, n_phi = 16;
  int tests = 0;
  for (const Case& c : cases())
    tests += int(views(*c.measured).size());
  const double significance = sidak_significance(0.01, tests);
  for (const Case& c : cases())
    for (const Vec3d& wo : views(*c.measured)) {
      std::vector<double> observed(n_t * n_phi), expected(n_t * n_phi);
      int rejected = 0;
      for (int i = 0; i < n; ++i) {
        const Vec3d wi = sampled<R>(*c.sampling, wo, i);
        if (!(c.sampling->pdf(wo, wi) > 0)) {
          ++rejected;
          continue;
        }
        const double t = std::acos(std::clamp(wi.z, -1.0, 1.0)) / pi, phi = std::atan2(wi.y, wi.x) / (2 * pi);
        observed[std::size_t(std::min(int(t * n_t), n_t - 1) * n_phi +
                             std::min(int((phi < 0 ? phi + 1 : phi) * n_phi), n_phi - 1))] += 1;
      }
      EXPECT_LE(rejected, n / 500) << c.name << " at " << text(wo);
      double total = 0;
      for (int i = 0; i < n_t; ++i)
        for (int j = 0; j < n_phi; ++j)
          total += expected[std::size_t(i * n_phi + j)] =
              integrate(i / double(n_t), (i + 1.0) / n_t, 2 * pi * j / n_phi, 2 * pi * (j + 1) / n_phi, 20,
                        20, [&](const Vec3d& wi) { return c.sampling->pdf(wo, wi); });
      for (double& e : expected)
        e *= (n - rejected) / total;
      const auto result = chi_square_test(observed, expected);
      EXPECT_GT(result.p, significance) << c.name << " at " << text(wo) << ", statistic " << result.statistic
                                        << " with " << result.degrees_of_freedom << " degrees of freedom";
    }
}
TEST(DirectionSampling, SamplesFollowThePdf) { expect_samples_follow_the_pdf<double>(); }
TEST(DirectionSampling, SamplesOfFloatsFollowThePdf) { expect_samples_follow_the_pdf<float>(); }

TEST(DirectionSampling, EstimatorIsUnbiasedAndItsVarianceBounded) {
  for (const Case& c : cases())
    for (const Vec3d& wo : views(*c.measured)) {
      const DirectionalAlbedo shares = directional_albedo(*c.measured, wo);
      const double albedo = shares.reflected[1] + shares.transmitted[1];
      RunningMoments found;
      for (int i = 0; i < 20000; ++i) {
        const Vec3d wi = sampled<double>(*c.sampling, wo, i);
        const double pdf = c.sampling->pdf(wo, wi);
        found.add(pdf > 0 ? c.measured->rgb(wo, wi)[1] * std::abs(wi.z) / pdf : 0);
      }
      // 4.5 standard errors: a false alarm in 7e-6 a case; the rest is the quadrature's.
      EXPECT_NEAR(found.mean(), albedo, 4.5 * found.standard_error() + 2e-3 * albedo)
          << c.name << " at " << text(wo);
      if (std::abs(wo.z) > 0.2) {
        EXPECT_LE(found.variance(), c.largest_variance * sqr(albedo))
            << c.name << " at " << text(wo) << ": " << found.variance() / sqr(albedo);
      }
    }
}

TEST(DirectionSampling, PacksHaveThePdfOfFloats) {
  for (const Case& c : cases())
    for (int n = 0; n < 40; ++n) {
      std::array<std::array<float, pack_width>, 6> w;
      for (std::size_t l = 0; l < pack_width; ++l)
        for (std::size_t k = 0; k < 2; ++k) {
          const auto u = [&](int d) { return float(unit_double(hash(3, n, l, k, d))); };
          const Vec3f v = spherical_direction(float(pi) * u(0), float(2 * pi) * u(1));
          w[3 * k][l] = v.x, w[3 * k + 1][l] = v.y, w[3 * k + 2][l] = v.z;
        }
      const auto at = [&](std::size_t k) { return load(w[k].data()); };
      const Pack pdf = c.sampling->pdf(Vec3<Pack>{at(0), at(1), at(2)}, Vec3<Pack>{at(3), at(4), at(5)});
      for (std::size_t l = 0; l < pack_width; ++l) {
        const double one =
            c.sampling->pdf(Vec3d{w[0][l], w[1][l], w[2][l]}, Vec3d{w[3][l], w[4][l], w[5][l]});
        // A direction at the edge of a cell may fall to either side: then both are densities of neighbours.
        if (std::abs(double(lane(pdf, l)) - one) > 1e-3 * one) {
          const double inside =
              c.sampling->pdf(normalize(Vec3d{w[0][l] * 1.00001, w[1][l] * 0.99999, w[2][l]}),
                              normalize(Vec3d{w[3][l] * 0.99999, w[4][l] * 1.00001, w[5][l]}));
          EXPECT_NEAR(double(lane(pdf, l)), inside, 0.5 * std::max(one, inside)) << c.name;
        }
      }
    }
}

TEST(DirectionSampling, KnowsNoDirectionOnSidesThatAreNotMeasured) {
  const FunctionBsdf front = function_of("lambert");
  const DirectionSampling sampling(front);
  const Vec3d up = spherical_direction(0.5, 1.0), down{up.x, up.y, -up.z};
  EXPECT_GT(sampling.pdf(up, up), 0);
  EXPECT_EQ(sampling.pdf(up, down), 0);
  EXPECT_EQ(sampling.pdf(down, up), 0);
  EXPECT_EQ(sampling.pdf(down, down), 0);
  EXPECT_EQ(sampling.pdf(down, sampling.sample(down, 0.3, Vec2d{0.2, 0.7})), 0);
  const Vec3d level{1, 0, 0}, nan{0, 0, std::nan("")};
  EXPECT_EQ(sampling.pdf(level, up), 0);
  EXPECT_EQ(sampling.pdf(up, level), 0);
  EXPECT_EQ(sampling.pdf(level, sampling.sample(level, 0.3, Vec2d{0.2, 0.7})), 0);
  EXPECT_EQ(sampling.pdf(nan, up), 0);
  EXPECT_EQ(sampling.pdf(up, nan), 0);
  EXPECT_FALSE(sampling.pdf(nan, sampling.sample(nan, 0.3, Vec2d{0.2, 0.7})) > 0);
}

} // namespace
} // namespace nacre
