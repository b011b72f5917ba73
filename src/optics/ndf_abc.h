#pragma once
// ABC: an inverse power of 1 - cos theta, after the power spectra of polished optical surfaces. Isotropic.

#include "optics/smith_quadrature.h"
#include "optics/stable_functions.h"
#include "optics/stretched_distribution.h"

namespace nacre {

/// D = A / (1 + B (1 - cos))^C with B in [0.01, 1e7], C in [0, 4]. The source leaves A free, so that its D is
/// not normalised; the A of projected area 1 is abc_normalisation.
/// Source: Low, Kronander, Ynnerman and Unger 2012, BRDF Models for Accurate and Efficient Rendering of
/// Glossy Surfaces, ACM TOG 31(1), eq. 15.
template <class R>
struct AbcShape {
  R A, B, C;
  static constexpr std::string_view name = "ABC";

  R density(const R& h2, const R& z2) const { return A * falloff(h2, z2) * sqr(R(1) / (h2 + z2)); }
  R lambda_cos(const R& s, const R& z) const {
    const R middle = exp(R(-0.25f) * log(R(1) + B));
    return smith_lambda_cos([&](const R& r2) { return density(r2, R(1)); }, s, z, smith_nodes().wide,
                            [&](const R& start) { return R(start + middle); });
  }
  // Sampled with density D instead of D cos, which alone can be inverted.
  R radius2(const R& u) const {
    const R v = log_range() * exponential_blend(R(R(1) - u), R((R(1) - C) * log_range()));
    const R drop = min(v * expm1_over(v) / B, R(0.99999f)), c = R(1) - drop; // 1 - cos
    return drop * (R(2) - drop) / (c * c);
  }
  R sampling_density(const R& h2, const R& z2) const {
    const R area = log_range() * expm1_over(R((R(1) - C) * log_range())); // of (1 + x)^-C for x in [0, B]
    const R inv_cos = sqrt((h2 + z2) / z2);
    return B * constant<R>(0.5 * inv_pi) * falloff(h2, z2) / area * inv_cos * sqr(R(1) / (h2 + z2));
  }
  R falloff(const R& h2, const R& z2) const {
    const R all = h2 + z2, drop = h2 / (all + sqrt(all * z2)); // 1 - cos without cancellation
    return exp(-C * log(R(1) + B * drop));
  }

private:
  R log_range() const { return log(R(1) + B); }
};

/// A with which the projected area of the facets is 1.
template <class R>
R abc_normalisation(const R& B, const R& C) {
  const R range = log(R(1) + B);
  const auto moment = [&](const R& k) { return R(range * expm1_over(R((R(1) - k) * range))); };
  return B / (constant<R>(2 * pi) * ((R(1) + R(1) / B) * moment(C) - moment(R(C - R(1))) / B));
}

template <class R>
StretchedDistribution<R, AbcShape<R>> abc(const R& A, const R& B, const R& C) {
  return {{A, B, C}, R(1), R(1)};
}

} // namespace nacre
