#pragma once
// Blinn-Phong's cosine power as a distribution of facets, normalised over projected area. Nearly Beckmann
// with alpha^2 = 2 / (n + 2), but without normals near the horizon when rough.

#include "optics/smith_quadrature.h"
#include "optics/stable_functions.h"
#include "optics/stretched_distribution.h"

namespace nacre {

/// D = (n + 2) / (2 pi) cos^n for n >= 0. Source: Blinn 1977; as a distribution: Walter et al. 2007, eq. 30.
template <class R>
struct BlinnPhongShape {
  R exponent;
  static constexpr std::string_view name = "Blinn-Phong";

  R density(const R& h2, const R& z2) const {
    const R r2 = h2 / z2, log_cos2 = -r2 * log1p_over(r2);
    return (exponent + R(2)) * constant<R>(0.5 * inv_pi) * exp(R(0.5f) * exponent * log_cos2) *
           sqr(R(1) / (h2 + z2));
  }
  R sampling_density(const R& h2, const R& z2) const { return density(h2, z2); }
  R lambda_cos(const R& s, const R& z) const {
    const R middle = sqrt(R(2) / (exponent + R(2)));
    return smith_lambda_cos([&](const R& r2) { return density(r2, R(1)); }, s, z, smith_nodes().narrow,
                            [&](const R& start) { return R(start + middle); });
  }
  R radius2(const R& u) const { // Walter et al. 2007, eq. 31
    const R y = R(-2) * log(max(u, R(1e-8f))) / (exponent + R(2));
    return y * expm1_over(y);
  }
};

/// From roughness as Beckmann's, alpha in (0, 1]: n = 2 / (alpha_x alpha_y) - 2, slopes stretched about it.
template <class R>
StretchedDistribution<R, BlinnPhongShape<R>> blinn_phong_facets(const R& alpha_x, const R& alpha_y) {
  const R alpha2 = alpha_x * alpha_y, alpha = sqrt(alpha2);
  return {{R(2) / alpha2 - R(2)}, alpha_x / alpha, alpha_y / alpha};
}

} // namespace nacre
