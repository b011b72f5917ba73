#include "optics/rough_transmittance.h"

#include "core/parallel.h"
#include "optics/fresnel.h"

namespace nacre {
namespace {

struct Albedo {
  double reflected, transmitted;
};

/// What one visible normal, at `u` of the unit square from which they are sampled, reflects and transmits:
/// F G1(wi) and (1 - F) G1(wt) (Heitz 2018, eq. 19). The mean over the square is the directional albedo of
/// single scattering.
template <template <class> class Distribution>
Albedo single_scattering(double cos_theta, double alpha, double eta, const Vec2<double>& u) {
  if (alpha < 1e-4) {
    const double F = fresnel_dielectric(cos_theta, eta).reflectance;
    return {F, 1 - F};
  }
  const Distribution<double> d{alpha, alpha};
  const Vec3d wo{std::sqrt(1 - cos_theta * cos_theta), 0, cos_theta};
  const Vec3d wm = d.sample_visible(wo, u);
  const double c = dot(wo, wm);
  const auto fresnel = fresnel_dielectric(c, eta);
  const Vec3d wi = reflect(wo, wm), wt = wm * (c / eta + fresnel.cos_t) - wo * (1 / eta);
  return {wi.z > 0 ? fresnel.reflectance * smith_g1(d, wi) : 0,
          wt.z < 0 ? (1 - fresnel.reflectance) * smith_g1(d, -wt) : 0};
}

double fraction(double x) { return x - std::floor(x); }

/// Total reflection and the horizon make kinks, which product rules with few nodes sample badly: lattices of
/// low discrepancy instead. This one is Fibonacci's.
template <template <class> class Distribution>
double transmitted(double cos_theta, double alpha, double eta) {
  constexpr int n = 233, step = 144;
  double sum = 0;
  for (int i = 0; i < n; ++i)
    sum += single_scattering<Distribution>(cos_theta, alpha, eta,
                                           {(i + 0.5) / n, fraction(double(i) * step / n)})
               .transmitted;
  return sum / n;
}

/// Hemispherical: with cos^2 theta uniform, by a Kronecker sequence of the plastic number g = 1.3247, g^3 = g
/// + 1.
template <template <class> class Distribution>
double reflected_inside(double alpha, double eta) {
  constexpr int n = 4096;
  constexpr double inv_g = 0.7548776662466927, inv_g2 = inv_g * inv_g;
  double sum = 0;
  for (int i = 0; i < n; ++i)
    sum += single_scattering<Distribution>(std::sqrt((i + 0.5) / n), alpha, 1 / eta,
                                           {fraction(0.5 + i * inv_g), fraction(0.5 + i * inv_g2)})
               .reflected;
  return sum / n;
}

} // namespace

template <template <class> class Distribution>
RoughTransmittance RoughTransmittance::compute() {
  RoughTransmittance t;
  t.outside_.resize(std::size_t(n_cos) * n_alpha * n_eta);
  t.inside_.resize(std::size_t(n_alpha) * n_eta);
  const auto alpha_of = [](int i) { return std::pow(double(i) / (n_alpha - 1), 2); };
  parallel_for(std::size_t(n_alpha) * n_eta, [&](std::size_t cell) {
    const double alpha = alpha_of(int(cell % n_alpha));
    const double eta = eta_lo + (eta_hi - eta_lo) * std::pow(double(cell / n_alpha) / (n_eta - 1), 2);
    t.inside_[cell] = float(reflected_inside<Distribution>(alpha, eta));
    for (int c = 0; c < n_cos; ++c) {
      const double cos_theta = std::max(1e-4, std::pow(double(c) / (n_cos - 1), 2));
      t.outside_[cell * n_cos + std::size_t(c)] = float(transmitted<Distribution>(cos_theta, alpha, eta));
    }
  });
  return t;
}

template <template <class> class Distribution>
const RoughTransmittance& RoughTransmittance::table() {
  static const RoughTransmittance instance = compute<Distribution>();
  return instance;
}
template const RoughTransmittance& RoughTransmittance::table<Ggx>();
template const RoughTransmittance& RoughTransmittance::table<Beckmann>();

} // namespace nacre
