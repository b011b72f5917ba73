#pragma once
// Generalised Trowbridge-Reitz: GGX with a free exponent of its tail. gamma = 2 is GGX, gamma = 1 (Berry) has
// the longest tail in use, that of Disney's clear coat.

#include "optics/smith_quadrature.h"
#include "optics/stable_functions.h"
#include "optics/stretched_distribution.h"

namespace nacre {

/// alpha in (0, 1], gamma in [0, 5]. Not invariant to stretching: Burley defines it isotropic, and `gtr`
/// below stretches the shape of the mean roughness. Source: Burley 2012, Physically Based Shading at Disney,
/// appendix B.2, eq. 4 to 7 and 9.
template <class R>
struct GtrShape {
  R alpha, gamma;
  static constexpr std::string_view name = "GTR";

  R density(const R& h2, const R& z2) const { return scale() * falloff(h2, z2); }
  R sampling_density(const R& h2, const R& z2) const { return density(h2, z2); }
  R lambda_cos(const R& s, const R& z) const {
    // What faces away at grazing angles lies about slope alpha, but up to 1 the longer the tail.
    const R light = max(gamma - R(1), R(0));
    const R middle = exp(R(-0.25f) * depth() * (R(1) + min(light, R(1)))) / sqrt(max(light, R(1)));
    return scale() * smith_lambda_cos([&](const R& r2) { return falloff(r2, R(1)); }, s, z,
                                      smith_nodes().wide, [&](const R& start) { return R(start + middle); });
  }
  R radius2(const R& u) const { // eq. 9; u is the share of steeper normals
    const R y =
        max(exponential_blend(u, R((gamma - R(1)) * depth())), R(1e-8f)); // -log(alpha^2 cos^2 + sin^2)
    const R rest = max(R(1) - y, R(0)) * depth();
    return sqr(alpha) * max(R(1) - y, R(0)) * expm1_over(rest) / (y * expm1_over(R(-y * depth())));
  }

private:
  // D = c / (alpha^2 cos^2 + sin^2)^gamma with the powers of alpha in c and in the fraction cancelled.
  R scale() const {
    const R power = (R(1) - gamma) * depth();
    return expm1_over(R(-depth())) / (constant<R>(pi) * alpha * alpha * expm1_over(power));
  }
  R falloff(const R& h2, const R& z2) const {
    const R all = h2 + z2, a2 = alpha * alpha, ratio = a2 * all / (a2 * z2 + h2); // in [a2, 1]
    return exp(gamma * log(ratio)) * sqr(R(1) / all);
  }
  R depth() const { return R(-2) * log(alpha); }
};

template <class R>
StretchedDistribution<R, GtrShape<R>> gtr(const R& alpha_x, const R& alpha_y, const R& gamma) {
  const R alpha = sqrt(alpha_x * alpha_y);
  return {{alpha, gamma}, alpha_x / alpha, alpha_y / alpha};
}

} // namespace nacre
