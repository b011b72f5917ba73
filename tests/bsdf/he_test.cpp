#include "bsdf/models/he.h"

#include "bsdf/models/rough_conductor.h"
#include "bsdf/published_fits.h"
#include "core/quadrature.h"
#include "core/random.h"

#include <gtest/gtest.h>

namespace nacre {
namespace {

using Color = Spectrum<double, 3>;
using Model = He<double, 3>;

/// The series with as many terms as it takes: Poisson's deviation is the root of g, X shifts the largest
/// term.
double series(double g, double X) {
  double sum = 0;
  const int first = std::max(1, int(g - 12 * std::sqrt(g)));
  const int last = int(g + 2 * std::min(X / g, 100.0) + 15 * std::sqrt(g)) + 60;
  for (int m = first; m < last; ++m)
    sum += std::exp((m - 1) * std::log(g) - g - std::lgamma(m + 1) - X / m) / m;
  return sum;
}

TEST(HeSeries, IsTheSumOfAllTerms) {
  for (const double g : {1e-6, 0.1, 1.0, 7.0, 15.9, 16.1, 20.0, 60.0, 300.0, 2000.0})
    for (const double u : {0.0, 0.1, 1.0, 3.0, 8.0}) {
      const double X = u * std::max(g, 1.0), whole = series(g, 0);
      EXPECT_NEAR(he_series(g, X), series(g, X), 1e-5 * series(g, X) + 1e-9 * whole) << g << " " << u;
      EXPECT_NEAR(he_series(float(g), float(X)), series(g, X), 3e-4 * series(g, X) + 1e-7 * whole)
          << g << " " << u;
    }
}

TEST(LambertW, IsTheRootForTinyAndHugeArguments) {
  for (double t = 1e-20; t < 1e30; t *= 3.7) {
    const double w = lambert_w(t);
    EXPECT_NEAR(std::log(w) + w, std::log(t), 1e-8) << t;
    EXPECT_NEAR(lambert_w(float(t)), w, 3e-6 * w);
  }
  EXPECT_EQ(lambert_w(0.0), 0);
}

/// Eq. 71 to 84 in the paper's own steps: unit vectors s and p, bisection of the equation for z0, all terms
/// of the series. Or with what BBM does instead.
struct Paper {
  double sigma, tau, eta;
  bool as_bbm;
  static constexpr std::array<double, 3> wavelength{0.645, 0.526, 0.444}; ///< BBM's, in um

  double S(const Vec3d& w) const {
    const double s = std::hypot(w.x, w.y);
    if (s < 1e-12) return 1;
    const double a = tau * w.z / (2 * sigma * s), e = std::erfc(a);
    return (1 - e / 2) / (0.5 * (std::exp(-a * a) / (std::sqrt(pi) * a) - e) + 1);
  }
  double G(const Vec3d& i, const Vec3d& r) const {
    const Vec3d n{0, 0, 1}, ki = -i, kr = r, v = kr - ki;
    const Vec3d across = cross(kr, ki);
    if (length(across) < 1e-7) return as_bbm ? 1 : sqr(length_squared(v) / v.z);
    const auto perpendicular = [&](const Vec3d& k) {
      const Vec3d c = cross(k, n);
      return length(c) > 1e-12 ? normalize(c) : Vec3d{1, 0, 0};
    };
    const Vec3d si = perpendicular(ki), sr = perpendicular(kr), p_i = cross(si, ki), p_r = cross(sr, kr);
    return sqr(length_squared(v) / v.z) * (sqr(dot(sr, ki)) + sqr(dot(p_r, ki))) *
           (sqr(dot(si, kr)) + sqr(dot(p_i, kr))) / sqr(length_squared(across));
  }
  double seen_sigma(const Vec3d& i, const Vec3d& r) const {
    const auto K = [&](const Vec3d& w) {
      const double s = std::hypot(w.x, w.y);
      return s < 1e-12 ? 0 : s / w.z * std::erfc(tau * w.z / (2 * sigma * s));
    };
    double lo = 0, hi = 40 * sigma; // sqrt(pi / 2) z0 = sigma / 4 (Ki + Kr) exp(-z0^2 / (2 sigma^2))
    for (int n = 0; n < 200; ++n) {
      const double z = 0.5 * (lo + hi);
      const double left = std::sqrt(pi / 2) * z;
      (left < sigma / 4 * (K(i) + K(r)) * std::exp(-sqr(z / sigma) / 2) ? lo : hi) = z;
    }
    return sigma / std::sqrt(1 + sqr(lo / sigma));
  }
  std::array<double, 3> eval(const Vec3d& wo, const Vec3d& wi) const {
    std::array<double, 3> g, X, D, f;
    const double seen = seen_sigma(wi, wo);
    for (std::size_t c = 0; c < 3; ++c) {
      const double wave = 2 * pi / wavelength[c];
      g[c] = sqr(wave * seen * (wo.z + wi.z));
      X[c] = (sqr(wo.x + wi.x) + sqr(wo.y + wi.y)) * sqr(wave * tau) / 4;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      D[c] = g[c] * series(g[c], X[c]);
      // BBM changes over to the limit of large g between 18 and 19, all channels by the smallest g.
      const double limit = std::clamp(*std::min_element(g.begin(), g.end()) - 18, 0.0, 1.0);
      if (as_bbm) D[c] += limit * (std::exp(-X[c] / g[c]) / g[c] - D[c]);
      D[c] *= sqr(pi * tau / (2 * wavelength[c]));
      const double F = fresnel_dielectric(0.5 * length(wo + wi), eta).reflectance;
      f[c] = F * G(wi, wo) * S(wi) * S(wo) * D[c] / (pi * wo.z * wi.z);
    }
    return f;
  }
};

Model model_of(const nlohmann::json& lobe) {
  auto m = default_model<Model>();
  m.specular_reflectance = published_fits::albedo(lobe);
  m.eta = Color(lobe["eta"].get<double>());
  m.sigma = lobe["roughness"];
  m.tau = lobe["autocorrelation"];
  m.wavelength = Color(Paper::wavelength);
  return m;
}

// All published fits of Ngan et al. at all directions of the reference: the model is the paper's, and BBM's
// values are the paper's but for two shortcuts of its own.
TEST(He, PublishedFitsHaveThePapersValuesAndThoseOfBbm) {
  published_fits::Deviation ours, theirs;
  for (const auto& fit : published_fits::read("ngan_he")) {
    const Model m = model_of(fit.lobe);
    Paper paper{m.sigma, m.tau, m.eta[0], false}, bbm{m.sigma, m.tau, m.eta[0], true};
    for (const auto& row : fit.rows) {
      const Color f = m.eval(row.wo, row.wi);
      const auto exact = paper.eval(row.wo, row.wi), other = bbm.eval(row.wo, row.wi);
      for (int c = 0; c < 3; ++c) {
        const auto k = std::size_t(c);
        const double base = fit.diffuse_albedo[k] * inv_pi, factor = m.specular_reflectance[c];
        ours.add(f[c] + base, factor * exact[k] + base, fit.text(row));
        theirs.add(factor * other[k] + base, row.f[k], fit.text(row));
      }
    }
  }
  if (ours.count == 0) GTEST_SKIP() << "no published fits beside the project";
  EXPECT_EQ(ours.count, 3 * 1035);
  EXPECT_LT(ours.worst, 2e-5) << ours.where;
  EXPECT_LT(theirs.worst, 1e-3) << theirs.beyond << " " << theirs.where;
}

/// Of a perfect reflector: the mirror image and the spread light.
struct Albedo {
  double mirror, spread;
};
Albedo albedo_of(double sigma, double tau, double theta) {
  auto m = default_model<He<double, 1>>();
  m.eta = Spectrum<double, 1>(0.01), m.k = Spectrum<double, 1>(30.0);
  m.sigma = sigma, m.tau = tau;
  const Vec3d wo = spherical_direction(theta, 0.0);
  const auto mirror = m.sample(wo, 0.0, {0.5, 0.5});
  double spread = 0;
  const int n = 60, lobes = 10;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int l = 0; l < lobes; ++l) {
        const double u = mirror.pdf + (1 - mirror.pdf) * (l + unit_double(hash(5, i * n + j, l))) / lobes;
        const auto s = m.sample(wo, u, {(i + 0.5) / n, (j + 0.5) / n});
        if (s.pdf > 0 && !s.is_delta) spread += s.f[0] * s.wi.z / s.pdf * (1 - mirror.pdf) / (n * n * lobes);
      }
  return {mirror.f[0] * mirror.wi.z, spread};
}

TEST(He, LightLostFromTheMirrorImageIsSpread) {
  for (const double sigma : {0.01, 0.05, 0.1, 0.3})
    for (const double theta : {0.0, 0.5, 1.0}) {
      const Albedo a = albedo_of(sigma, 12, theta);
      EXPECT_NEAR(a.mirror + a.spread, 1, 0.01)
          << sigma << " " << theta << ": " << a.mirror << " + " << a.spread;
    }
  // The classic factor exp(-(4 pi sigma cos / lambda)^2) of the total integrated scatter.
  EXPECT_NEAR(albedo_of(0.05, 12, 0.5).mirror, std::exp(-sqr(4 * pi * 0.05 * std::cos(0.5) / 0.55)), 1e-2);
}

TEST(He, PolishedSurfaceIsAMirrorWithFresnelsReflectance) {
  auto m = default_model<He<double, 1>>();
  m.eta = Spectrum<double, 1>(1.5), m.sigma = 1e-3, m.tau = 10;
  for (const double theta : {0.0, 0.8, 1.4}) {
    const auto s = m.sample(spherical_direction(theta, 0.0), 0.1, {0.5, 0.5});
    ASSERT_TRUE(s.is_delta);
    EXPECT_NEAR(s.f[0] * s.wi.z, fresnel_dielectric(std::cos(theta), 1.5).reflectance, 6e-4);
  }
}

// For heights far above the wavelength diffraction gives way to facets of slope 2 sigma / tau.
TEST(He, VeryRoughSurfaceIsBeckmanns) {
  auto m = default_model<He<double, 1>>();
  m.sigma = 10, m.tau = 100;
  auto facets = default_model<BeckmannConductor<double, 1>>();
  m.eta = facets.eta = Spectrum<double, 1>(1.2), m.k = facets.k = Spectrum<double, 1>(5.0);
  facets.alpha_x = facets.alpha_y = 0.2;
  for (const double theta : {0.0, 0.3, 0.5})
    for (const double phi : {2.6, pi}) {
      const Vec3d wo = spherical_direction(theta, 0.0), wi = spherical_direction(0.4, phi);
      const double f = facets.eval(wo, wi)[0];
      EXPECT_NEAR(m.eval(wo, wi)[0], f, 2e-3 * f) << theta << " " << phi;
    }
}

TEST(He, SurfaceTurnsSmoothTowardsTheHorizon) {
  const Albedo steep = albedo_of(0.2, 20, 0.2), grazing = albedo_of(0.2, 20, 1.52);
  EXPECT_LT(steep.mirror, 1e-3);
  EXPECT_GT(grazing.mirror, 0.8 * (grazing.mirror + grazing.spread));
}

} // namespace
} // namespace nacre
