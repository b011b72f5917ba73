#pragma once
// STD: slopes of Student's t-distribution, from longer tails than GGX (gamma < 2) through GGX (gamma = 2) to
// Beckmann (gamma to infinity), invariant to stretching.

#include "optics/smith_quadrature.h"
#include "optics/stable_functions.h"
#include "optics/stretched_distribution.h"

namespace nacre {

/// gamma > 1.5: below, facets have no mean slope and Smith's masking would hide everything.
/// Source: Ribardiere, Bringier, Meneveaux and Simonot 2017, STD: Student's t-Distribution of Slopes for
/// Microfacet Based BSDFs, CGF 36(2), eq. 11 (D), 13 to 15 (Lambda), 20 (sampling).
template <class R>
struct StudentTShape {
  R gamma;
  static constexpr std::string_view name = "STD";

  R density(const R& h2, const R& z2) const {
    const R q = h2 / (z2 * (gamma - R(1)));
    return constant<R>(inv_pi) * exp(-gamma * q * log1p_over(q)) * sqr(R(1) / z2);
  }
  R sampling_density(const R& h2, const R& z2) const { return density(h2, z2); }
  /// Exact, where the source fits its second term S2: that is an integral of cos^(2 gamma - 3), done here by
  /// quadrature to 1e-6.
  R lambda_cos(const R& s, const R& z) const {
    const SmithNodes& nodes = smith_nodes();
    const R width = sqrt(gamma - R(1)) * s, l2 = width * width + z * z;
    const R angle = atan2(max(z, R(0)), max(width, R(1e-20f))), power = R(2) * gamma - R(3);
    R integral = R(0);
    for (int i = 0; i < SmithNodes::count; ++i)
      integral =
          integral + constant<R>(nodes.weight[i]) * exp(power * log(cos(R(angle * constant<R>(nodes.x[i])))));
    const R n = constant<R>(1 / std::sqrt(pi)) * (gamma - R(1)) *
                exp(log_gamma(R(gamma - R(0.5f))) - log_gamma(gamma));
    const R cos_to_power = exp(R(0.5f) * power * log(max(width * width / l2, R(1e-30f))));
    return max(n * (width * cos_to_power / power + z * angle * integral) - R(0.5f) * z, R(0));
  }
  R radius2(const R& u) const {
    const R y = min(-log(max(u, R(1e-8f))) / (gamma - R(1)), R(60));
    return (gamma - R(1)) * y * expm1_over(y);
  }
};

template <class R>
StretchedDistribution<R, StudentTShape<R>> student_t(const R& alpha_x, const R& alpha_y, const R& gamma) {
  return {{gamma}, alpha_x, alpha_y};
}

} // namespace nacre
