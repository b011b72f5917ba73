#pragma once
// From linear sRGB to smooth spectra.

#include "spectra/wavelengths.h"

#include <array>
#include <cmath>
#include <vector>

namespace nacre {

/// A spectrum in (0, 1): s(t) = 1/2 + x / (2 sqrt(1 + x^2)), x = c0 t^2 + c1 t + c2, where t runs from -1 at
/// 360 nm to 1 at 830 nm. Source: Jakob and Hanika 2019, A Low-Dimensional Function Space for Efficient
/// Spectral Upsampling, eqs. 2 and 3, in a normalised wavelength, which keeps the sum free of cancellation in
/// float.
struct SigmoidPolynomial {
  float c0 = 0, c1 = 0, c2 = 0;

  float operator()(float lambda_nm) const {
    const float t = (lambda_nm - centre_nm) * (1 / half_width_nm);
    const float x = (c0 * t + c1) * t + c2;
    return 0.5f + 0.5f * x / std::sqrt(1 + x * x);
  }
  SampledSpectrum operator()(const Wavelengths& w) const {
    SampledSpectrum s;
    for (int i = 0; i < 4; ++i)
      s[i] = (*this)(w.lambda_nm[i]);
    return s;
  }
  /// Largest value over [360, 830] nm.
  float max_value() const;

  static constexpr float centre_nm = 0.5f * (lambda_min_nm + lambda_max_nm);
  static constexpr float half_width_nm = 0.5f * (lambda_max_nm - lambda_min_nm);
};

/// The sigmoid spectrum whose colour under D65 is the given linear sRGB. Gray gives a constant, exact also at
/// 0 and 1. Damped Gauss-Newton in CIE Lab (the paper, section 4), about a microsecond; colours come back
/// within 5e-4.
/// @param rgb  each in [0, 1]
/// @throws     Error if a component is NaN or outside
SigmoidPolynomial fit_sigmoid(const std::array<float, 3>& rgb);

/// The same by table, for textures: three cubes of 64^3 fitted coefficients, one for each largest component,
/// trilinear (the paper, section 5). Colours come back within 3e-3, 3e-4 on average. Immutable, shared by all
/// threads, 9 MB.
class RgbToSpectrumTable {
public:
  /// The one table, built on first use by all cores.
  static const RgbToSpectrumTable& instance();

  /// @param rgb  clamped to [0, 1] (NaN counts as 0): a texture may hold anything
  SigmoidPolynomial operator()(std::array<float, 3> rgb) const;

private:
  RgbToSpectrumTable();
  std::vector<float> scale_;                      ///< nodes of the largest component
  std::vector<float> ratio_;                      ///< nodes of the others relative to it
  std::vector<std::array<float, 3>> coefficient_; ///< [largest][z][y][x]
};

/// Spectra of the sRGB primaries that sum to 1 at every wavelength, so r B_r + g B_g + b B_b lies in [0, 1]
/// for RGB in [0, 1] and is linear in RGB. Table: Mallett and Yuksel 2019, Spectral Primary Decomposition for
/// Rendering with sRGB Reflectance (380 to 780 nm at 5 nm, extended by its end values). Colours come back
/// within 2e-3.
std::array<SampledSpectrum, 3> rgb_basis(const Wavelengths& wavelengths);

} // namespace nacre
