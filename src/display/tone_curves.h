#pragma once
// Tone curves as published: from an exposed linear value >= 0 to a display-linear value.

#include <algorithm>

namespace nacre {

/// Reinhard et al. 2002, Photographic Tone Reproduction for Digital Images, eq. 4: `white` is the smallest
/// luminance shown as pure white; an infinite one gives eq. 3, L / (1 + L).
inline double reinhard_curve(double luminance, double white) {
  // In this order no product of two large luminances is formed, and small ones keep their digits.
  return luminance / (1 + luminance) * (1 + luminance / white / white);
}

/// The curve Hable fitted to film for Uncharted 2 (Filmic Tonemapping Operators, 2010, filmicgames.com; the
/// constants A ... F are those of that page), before division by its value at the white point.
inline double hable_curve(double x) {
  constexpr double a = 0.15, b = 0.50, c = 0.10, d = 0.20, e = 0.02, f = 0.30;
  return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
}

/// Narkowicz's rational fit of the ACES reference rendering and output transforms for a display of 100 cd/m^2
/// (ACES Filmic Tone Mapping Curve, 2015, knarkowicz.wordpress.com). Reaches 1 at x = 7.24; clipped there.
inline double narkowicz_curve(double x) {
  return std::min(1.0, x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
}

} // namespace nacre
