#include "optics/rough_transmittance.h"

#include "core/parallel.h"
#include "core/quadrature.h"
#include "optics/fresnel.h"

namespace nacre {
namespace {

struct Albedo {
  double reflected, transmitted;
};

/// Directional albedos of single scattering by facets of this distribution, by quadrature over the unit
/// square from which visible normals are sampled: the integrals of F G1(wi) and (1 - F) G1(wt) (Heitz 2018,
/// eq. 19).
template <template <class> class Distribution>
Albedo single_scattering(double cos_theta, double alpha, double eta, int n) {
  if (alpha < 1e-4) {
    const double F = fresnel_dielectric(cos_theta, eta).reflectance;
    return {F, 1 - F};
  }
  const Distribution<double> d{alpha, alpha};
  const Vec3d wo{std::sqrt(1 - cos_theta * cos_theta), 0, cos_theta};
  Albedo sum{0, 0};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Vec3d wm = d.sample_visible(wo, {(i + 0.5) / n, (j + 0.5) / n});
      const double c = dot(wo, wm);
      const auto fresnel = fresnel_dielectric(c, eta);
      const Vec3d wi = reflect(wo, wm);
      if (wi.z > 0) sum.reflected += fresnel.reflectance * smith_g1(d, wi);
      const Vec3d wt = wm * (c / eta + fresnel.cos_t) - wo * (1 / eta);
      if (wt.z < 0) sum.transmitted += (1 - fresnel.reflectance) * smith_g1(d, -wt);
    }
  return {sum.reflected / (n * n), sum.transmitted / (n * n)};
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
    // Inside, total reflection makes a kink that wants more nodes.
    const double inside = integrate(composite_gauss_legendre(8, 6, 0, 1), [&](double mu) {
      return 2 * mu * single_scattering<Distribution>(mu, alpha, 1 / eta, 10).reflected;
    });
    t.inside_[cell] = float(inside);
    for (int c = 0; c < n_cos; ++c) {
      const double cos_theta = std::max(1e-4, std::pow(double(c) / (n_cos - 1), 2));
      t.outside_[cell * n_cos + std::size_t(c)] =
          float(single_scattering<Distribution>(cos_theta, alpha, eta, 12).transmitted);
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
