#include "optics/single_bounce_share.h"

#include "core/parallel.h"
#include "optics/fresnel.h"

namespace nacre {

template <template <class> class Distribution>
SingleBounceShare SingleBounceShare::compute() {
  constexpr std::size_t cells = std::size_t(n_alpha) * n_cos;
  SingleBounceShare t;
  t.mirror_.resize(cells);
  t.reflected_.resize(cells * n_eta);
  t.transmitted_.resize(cells * n_eta);
  parallel_for(cells, [&](std::size_t cell) {
    const double c = std::max(1e-4, sqr(double(cell % n_cos) / (n_cos - 1)));
    const double a = std::max(1e-3, sqr(double(cell / n_cos) / (n_alpha - 1)));
    const Distribution<double> d{a, a};
    const Vec3d wo{std::sqrt(1 - c * c), 0, c};
    constexpr int n = 377, step = 233; // Fibonacci's lattice over the visible normals
    for (int i = 0; i < n; ++i) {
      const Vec3d wm = d.sample_visible(wo, {(i + 0.5) / n, double((i * step) % n) / n});
      const Vec3d wi = reflect(wo, wm);
      // G2 / G1(wo), Heitz 2014, eq. 43 and 99
      const double lo = d.lambda_cos(wo);
      const double seen =
          wi.z > 0 ? (wo.z + lo) * wi.z / (wo.z * wi.z + lo * wi.z + d.lambda_cos(wi) * wo.z) / n : 0;
      t.mirror_[cell] += float(seen);
      for (std::size_t e = 0; e < n_eta; ++e) {
        const double r = (eta_max - 1) / (eta_max + 1) * (2.0 * double(e) / (n_eta - 1) - 1);
        const double eta = (1 + r) / (1 - r), cos_m = dot(wo, wm);
        const auto fresnel = fresnel_dielectric(cos_m, eta);
        const Vec3d wt = wm * (cos_m / eta + fresnel.cos_t) - wo * (1 / eta);
        t.reflected_[e * cells + cell] += float(seen * fresnel.reflectance);
        if (wt.z < 0)
          t.transmitted_[e * cells + cell] += float((1 - fresnel.reflectance) * smith_g1(d, -wt) / n);
      }
    }
  });
  return t;
}

template <template <class> class Distribution>
const SingleBounceShare& SingleBounceShare::table() {
  static const SingleBounceShare instance = compute<Distribution>();
  return instance;
}
template const SingleBounceShare& SingleBounceShare::table<Ggx>();
template const SingleBounceShare& SingleBounceShare::table<Beckmann>();

} // namespace nacre
