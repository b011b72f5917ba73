#pragma once
// SGD: the shifted gamma distribution, a power of the slope that ends in an exponential. Made to fit measured
// metals and paints with one lobe. Isotropic.

#include "optics/smith_quadrature.h"
#include "optics/stable_functions.h"
#include "optics/stretched_distribution.h"

namespace nacre {

/// P22 = K exp(-T) / (pi T^p), T = alpha + tan^2 / alpha. alpha > 0, p in [0, 2].
/// Source: Bagher, Soler and Holzschuch 2012, Accurate Fitting of Measured Reflectances Using a Shifted Gamma
/// Micro-facet Distribution, CGF 31(4), eq. 9 to 11.
template <class R>
struct ShiftedGammaShape {
  R alpha, p;
  R K; ///< the factor that the source's tables give; shifted_gamma_normalisation computes it
  static constexpr std::string_view name = "SGD";

  R density(const R& h2, const R& z2) const {
    const R T = alpha + h2 / (z2 * alpha);
    return constant<R>(inv_pi) * K * exp(-min(T, R(200)) - p * log(T)) * sqr(R(1) / z2);
  }
  R lambda_cos(const R& s, const R& z) const {
    const R steepest = sqrt(R(40) * alpha); // beyond, exp(-40)
    return smith_lambda_cos([&](const R& r2) { return density(r2, R(1)); }, s, z, smith_nodes().bounded,
                            [&](const R& start) { return R(max(steepest - start, R(0))); });
  }
  // Sampled is T^-p alone up to r^2 = alpha and its exponential tail beyond, continuous, within a factor e of
  // the target. t stands for r^2 / alpha.
  R radius2(const R& u) const {
    const Pieces m = pieces();
    const auto core = u < m.core_share;
    const R v =
        m.log_range * exponential_blend(R(select(core, u / m.core_share, R(1))), R((R(1) - p) * m.log_range));
    const R rest = select(core, R(0.5f), (R(1) - u) / max(R(1) - m.core_share, R(1e-8f)));
    const R t = select(core, alpha * v * expm1_over(v), R(1) - log(max(rest, R(1e-8f))));
    return alpha * max(t, R(0));
  }
  R sampling_density(const R& h2, const R& z2) const {
    const Pieces m = pieces();
    const R t = h2 / (z2 * alpha);
    const R shape = exp(-p * log(alpha + min(t, R(1))) - clamp(t - R(1), 0.0f, 200.0f));
    return constant<R>(inv_pi) * shape / (alpha * (m.core + m.tail) * sqr(z2));
  }

private:
  struct Pieces {
    R log_range, core, tail, core_share;
  };
  Pieces pieces() const {
    const R log_range = log(R(1) + R(1) / alpha);
    const R core = exp((R(1) - p) * log(alpha)) * log_range * expm1_over(R((R(1) - p) * log_range));
    const R tail = exp(-p * log(R(1) + alpha));
    return {log_range, core, tail, core / (core + tail)};
  }
};

/// K with which the projected area of the facets is 1: 1 / (alpha Gamma(1 - p, alpha)), eq. 11.
template <class R>
R shifted_gamma_normalisation(const R& alpha, const R& p) {
  const SmithNodes& nodes = smith_nodes();
  // The upper incomplete gamma function in v = log T from log(alpha) to 4, where exp(-T) has vanished.
  const R start = log(alpha), length = R(4) - start;
  R sum = R(0);
  for (int i = 0; i < SmithNodes::count; ++i) {
    const R v = start + length * constant<R>(nodes.x[i]);
    sum = sum + constant<R>(nodes.weight[i]) * exp((R(1) - p) * v - exp(v));
  }
  return R(1) / (alpha * length * sum);
}

template <class R>
StretchedDistribution<R, ShiftedGammaShape<R>> shifted_gamma(const R& alpha, const R& p, const R& K) {
  return {{alpha, p, K}, R(1), R(1)};
}

} // namespace nacre
