#pragma once
// CIELAB, and its linear opponent cousin YCxCz, relative to D65.

#include "spectra/color_space.h"

#include <cmath>
#include <numbers>

namespace nacre {

using Lab = std::array<double, 3>; ///< L* in [0, 100], a*, b*

/// XYZ of linear sRGB (1, 1, 1).
inline constexpr XYZ d65_white = srgb_to_xyz * RGB{1, 1, 1};

/// CIE 15:2004, eqs. 8.3 to 8.10.
inline Lab xyz_to_lab(const XYZ& xyz) {
  constexpr double delta = 6.0 / 29;
  std::array<double, 3> f;
  for (int i = 0; i < 3; ++i) {
    const double t = xyz[i] / d65_white[i];
    f[i] = t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
  }
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}
inline XYZ lab_to_xyz(const Lab& lab) {
  constexpr double delta = 6.0 / 29;
  const double fy = (lab[0] + 16) / 116;
  const std::array<double, 3> f{fy + lab[1] / 500, fy, fy - lab[2] / 200};
  XYZ xyz;
  for (int i = 0; i < 3; ++i)
    xyz[i] = d65_white[i] * (f[i] > delta ? f[i] * f[i] * f[i] : 3 * delta * delta * (f[i] - 4.0 / 29));
  return xyz;
}
inline Lab srgb_to_lab(const RGB& linear) { return xyz_to_lab(srgb_to_xyz * linear); }

/// The linear part of CIELAB (Flohr et al. 1993): contrast sensitivities may be applied to it by convolution.
inline std::array<double, 3> srgb_to_ycxcz(const RGB& linear) {
  const XYZ v = srgb_to_xyz * linear;
  const double x = v[0] / d65_white[0], y = v[1] / d65_white[1], z = v[2] / d65_white[2];
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}
inline RGB ycxcz_to_srgb(const std::array<double, 3>& v) {
  const double y = (v[0] + 16) / 116, x = y + v[1] / 500, z = y - v[2] / 200;
  return xyz_to_srgb * XYZ{x * d65_white[0], y * d65_white[1], z * d65_white[2]};
}

} // namespace nacre
