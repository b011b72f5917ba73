#pragma once
// The transfer function of sRGB, exact: IEC 61966-2-1:1999, clauses 5.2 and 5.3.

#include <cmath>

namespace nacre {

/// Display code in [0, 1] of a linear value in [0, 1]. Outside that range the segments simply continue.
inline double srgb_encode(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}
/// Linear value of a display code. The two thresholds of the standard are rounded, so that
/// srgb_decode(srgb_encode(x)) differs from x by up to 3e-8 beside the joint and by rounding alone elsewhere.
inline double srgb_decode(double code) {
  return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

} // namespace nacre
