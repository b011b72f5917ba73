#pragma once
// The least-squares problem behind Jakob and Hanika's spectra, shared by the single fit and the table.

#include "spectra/color_space.h"
#include "spectra/rgb.h"

#include <array>

namespace nacre::detail {

using Coefficients = std::array<double, 3>; ///< c0, c1, c2 of SigmoidPolynomial

class SigmoidFitter {
public:
  static const SigmoidFitter& instance();

  /// Moves `c` to where the spectrum's colour under D65 is `target` in linear sRGB, by Levenberg-Marquardt on
  /// the difference in CIE Lab. @return the remaining distance in CIE Lab, 0.003 or less where it succeeded
  double fit(const RGB& target, Coefficients& c) const;

private:
  SigmoidFitter();
  struct Response {
    RGB rgb;
    Matrix3 derivative; ///< rows: r, g, b; columns: c0, c1, c2
  };
  Response respond(const Coefficients& c) const;

  static constexpr int node_count = 160; ///< 2.96 nm apart; a multiple of every pack's width
  std::array<float, node_count> t_;      ///< normalised wavelength of SigmoidPolynomial
  std::array<std::array<float, node_count>, 3>
      weight_; ///< linear sRGB of a reflectance: sum of weight times value
};

/// x of a constant sigmoid spectrum of that value in [0, 1]; finite, and exact in float at 0 and 1.
float constant_sigmoid(double value);

} // namespace nacre::detail
