#pragma once
// EPD: slopes whose density is exp(-(r / beta)^(2p)): Beckmann at p = 1, a sharper peak with a long tail
// below, a flat top with a steep edge above. Invariant to stretching.

#include "optics/smith_quadrature.h"
#include "optics/stable_functions.h"
#include "optics/stretched_distribution.h"

namespace nacre {

/// p in [0.2, 5]. Source: Holzschuch and Pacanowski 2017, A Two-Scale Microfacet Reflectance Model Combining
/// Reflection and Diffraction, ACM TOG 36(4), eq. 34, 35; earlier Brady et al. 2014, genBRDF, model A.
template <class R>
struct ExponentialPowerShape {
  R p;
  static constexpr std::string_view name = "EPD";

  R density(const R& h2, const R& z2) const { return scale() * falloff(h2 / z2) * sqr(R(1) / z2); }
  R lambda_cos(const R& s, const R& z) const {
    const R steepest = exp(constant<R>(0.5 * std::log(40.0)) / p); // beyond, exp(-40)
    return scale() * smith_lambda_cos([&](const R& r2) { return falloff(r2); }, s, z, smith_nodes().bounded,
                                      [&](const R& start) { return R(max(steepest - start, R(0))); });
  }
  // The distribution function is an incomplete gamma function, whose inverse the source takes from a library.
  // Sampled instead are close densities of r^2 with heavier tails and closed inverses: for p <= 1 Lomax's,
  // for p >= 1 Fermi's; both are the exponential, and exact, at p = 1.
  R radius2(const R& u) const {
    const R share = clamp(u, 1e-8f, 1.0f);
    const Lomax a = lomax();
    const R minus_log = -log(share);
    const R long_tail = a.scale * minus_log * expm1_over(R(min(a.shape * minus_log, R(80))));
    const Fermi b = fermi();
    const R flat_top =
        -b.width * log(max(share * b.log_over_kappa * expm1_over(R(share * b.log)), R(1e-30f)));
    return select(p < R(1), long_tail, max(flat_top, R(0)));
  }
  R sampling_density(const R& h2, const R& z2) const {
    const R r2 = h2 / z2;
    const Lomax a = lomax();
    const R q = r2 / a.scale, log1p = q * log1p_over(R(a.shape * q));
    const R long_tail = exp(-log1p - a.shape * log1p) / a.scale;
    const Fermi b = fermi();
    const R flat_top = R(1) / (b.log_over_kappa * b.width * (exp(min(r2 / b.width, R(80))) + b.kappa));
    return constant<R>(inv_pi) * select(p < R(1), long_tail, flat_top) * sqr(R(1) / z2);
  }

private:
  R scale() const { return constant<R>(inv_pi) * p * exp(-log_gamma(R(R(1) / p))); }
  R falloff(const R& r2) const {
    const R power = p * log(max(r2, R(1e-30f)));
    return exp(-exp(min(power, R(5)))); // beyond, exp(-148) is 0
  }
  struct Lomax {
    R shape, scale; ///< survival (1 + shape r^2 / scale)^(-1 / shape)
  };
  /// Shape fitted to the target's quantiles, scale from its median (that of the gamma distribution).
  Lomax lomax() const {
    const R k = R(1) / p;
    const R median = exp(k * log(k - constant<R>(1.0 / 3) + constant<R>(std::log(2.0) - 2.0 / 3) * p));
    const R shape = max(R(1) - p, R(0)) / (p * max(R(3.25f) - R(2.8f) * p, R(0.45f)));
    const R log2 = constant<R>(std::log(2.0));
    return {shape, median / (log2 * expm1_over(R(shape * log2)))};
  }
  struct Fermi {
    R width, kappa, log, log_over_kappa; ///< density 1 / (exp(r^2 / width) + kappa); log(1 + kappa)
  };
  /// Width by trial, kappa such that density and target fall to 1/e at the same slope.
  Fermi fermi() const {
    const R inv = R(1.4f) * max(p, R(1)) - R(0.4f);
    const R kappa = max((exp(inv) - constant<R>(std::exp(1.0))) * constant<R>(1 / (std::exp(1.0) - 1)), R(0));
    const R ratio = log1p_over(kappa);
    return {R(1) / inv, kappa, ratio * kappa, ratio};
  }
};

template <class R>
StretchedDistribution<R, ExponentialPowerShape<R>> exponential_power(const R& beta_x, const R& beta_y,
                                                                     const R& p) {
  return {{p}, beta_x, beta_y};
}

} // namespace nacre
