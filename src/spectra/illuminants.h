#pragma once
// Spectral power distributions of standard light.

#include "spectra/wavelengths.h"

#include <array>

namespace nacre {

/// A spectrum sampled at 360, 361, ..., 830 nm, linear in between, 0 outside.
struct DenseSpectrum {
  static constexpr int count = 471;
  std::array<float, count + 1> values{}; ///< one entry of padding, so that 830 nm needs no special case

  float operator()(float lambda_nm) const {
    if (!(lambda_nm >= lambda_min_nm && lambda_nm <= lambda_max_nm)) return 0;
    const float x = lambda_nm - lambda_min_nm;
    const int i = static_cast<int>(x);
    const float t = x - static_cast<float>(i);
    return values[i] + t * (values[i + 1] - values[i]);
  }
  SampledSpectrum operator()(const Wavelengths& w) const {
    SampledSpectrum s;
    for (int i = 0; i < 4; ++i)
      s[i] = (*this)(w.lambda_nm[i]);
    return s;
  }
};

/// CIE standard illuminants, relative, 100 at 560 nm (CIE 015:2018). D65 and D50 are linear between 10 nm
/// nodes.
const DenseSpectrum& illuminant_d65();
const DenseSpectrum& illuminant_d50();
/// CIE standard illuminant A by its defining formula (ISO/CIE 11664-2).
const DenseSpectrum& illuminant_a();
/// D65 scaled to luminance 1: the light of linear sRGB (1, 1, 1).
const DenseSpectrum& unit_d65();

/// CIE daylight of a correlated colour temperature in [4000, 25000] K, relative, 100 at 560 nm, linear
/// between 10 nm nodes. D65 has cct_k = 6500 x 1.4388 / 1.4380. Source: CIE 015:2018, section 4.1.2.
/// @throws Error if cct_k is outside that domain
DenseSpectrum cie_daylight(double cct_k);

/// Planck's law: radiance of a blackbody in W/(m^2 sr nm), CODATA 2018 constants (exact by the SI of 2019).
/// lambda_nm > 0, temperature_k > 0; 0 where the exponential overflows.
double blackbody(double lambda_nm, double temperature_k);
/// The same divided by its largest value over all wavelengths (Wien's displacement law): in [0, 1].
double blackbody_normalized(double lambda_nm, double temperature_k);

} // namespace nacre
