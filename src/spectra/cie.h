#pragma once
// From spectra to tristimulus values: the CIE 1931 2-degree observer, by quadrature and by Monte Carlo.

#include "spectra/color_space.h"
#include "spectra/wavelengths.h"

namespace nacre {

/// Colour matching functions xbar, ybar, zbar at one wavelength; 0 outside [360, 830]. CIE 018:2019, table 6,
/// at 5 nm, brought to 1 nm by Sprague's quintic (CIE 167:2005), linear in between: within 1e-4 of the CIE's
/// own 1 nm table.
std::array<float, 3> cie_1931(float lambda_nm);

/// Integral of ybar over [360, 830] in nm, of the table as interpolated.
inline constexpr double cie_y_integral_nm = 106.8570315385;

/// Monte Carlo estimate of XYZ from radiance at the wavelengths of one path, normalised by the integral of
/// ybar, so a flat spectrum of value 1 has Y = 1. Wavelengths of density 0 count as nothing.
XYZ to_xyz(const SampledSpectrum& radiance, const Wavelengths& wavelengths);

/// XYZ by the trapezoidal rule at 1 nm; `spectrum(lambda_nm)` is called at 360, 361, ..., 830. Same
/// normalisation.
template <class F>
XYZ integrate_xyz(F&& spectrum) {
  XYZ sum{};
  for (int nm = static_cast<int>(lambda_min_nm); nm <= static_cast<int>(lambda_max_nm); ++nm) {
    const bool end = nm == static_cast<int>(lambda_min_nm) || nm == static_cast<int>(lambda_max_nm);
    const auto lambda_nm = static_cast<float>(nm);
    const double weight = (end ? 0.5 : 1.0) / cie_y_integral_nm * static_cast<double>(spectrum(lambda_nm));
    const auto cmf = cie_1931(lambda_nm);
    for (int i = 0; i < 3; ++i)
      sum[i] += weight * static_cast<double>(cmf[i]);
  }
  return sum;
}

} // namespace nacre
