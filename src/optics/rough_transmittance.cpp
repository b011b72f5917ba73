#include "optics/rough_transmittance.h"

#include "core/parallel.h"
#include "core/quadrature.h"
#include "optics/fresnel.h"

namespace nacre {
namespace {

/// Directional albedo of single reflection from facets of this distribution, by quadrature over the visible
/// normals: the integral of F G2 / G1 over the unit square from which they are sampled (Heitz 2018, eq. 19).
template <template <class> class Distribution>
double reflection_albedo(double cos_theta, double alpha, double eta_outward) {
  if (alpha < 1e-4) return fresnel_dielectric(cos_theta, eta_outward).reflectance;
  const Distribution<double> d{alpha, alpha};
  const Vec3d wo{std::sqrt(1 - cos_theta * cos_theta), 0, cos_theta};
  constexpr int n = 24;
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Vec3d wm = d.sample_visible(wo, {(i + 0.5) / n, (j + 0.5) / n});
      const Vec3d wi = reflect(wo, wm);
      if (wi.z <= 0) continue;
      const double li = d.lambda_cos(wi) / wi.z, lo = d.lambda_cos(wo) / wo.z;
      sum += fresnel_dielectric(dot(wo, wm), eta_outward).reflectance * (1 + lo) / (1 + lo + li);
    }
  return sum / (n * n);
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
    const double eta = eta_lo + (eta_hi - eta_lo) * double(cell / n_alpha) / (n_eta - 1);
    double from_outside = 0; // hemispherical average of the transmittance, integral of 2 cos T dcos
    const QuadratureRule rule = gauss_legendre(16, 0, 1);
    for (std::size_t q = 0; q < rule.node.size(); ++q)
      from_outside += rule.weight[q] * 2 * rule.node[q] *
                      (1 - reflection_albedo<Distribution>(rule.node[q], alpha, eta));
    // Light that leaves pays the same toll as light that enters, compressed by eta^2.
    t.inside_[cell] = float(1 - from_outside / (eta * eta));
    for (int c = 0; c < n_cos; ++c) {
      const double cos_theta = std::max(1e-4, std::pow(double(c) / (n_cos - 1), 2));
      t.outside_[cell * n_cos + std::size_t(c)] =
          float(1 - reflection_albedo<Distribution>(cos_theta, alpha, eta));
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
