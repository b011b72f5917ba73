#pragma once
// The wavelengths one light path carries: a hero wavelength and three companions (Wilkie et al. 2014, Hero
// Wavelength Spectral Sampling), drawn where the eye is sensitive, with support over the whole range Nacre
// simulates.

#include "core/spectrum.h"

#include <array>

namespace nacre {

inline constexpr float lambda_min_nm = 360.0f;
inline constexpr float lambda_max_nm = 830.0f;

/// One quantity at the four wavelengths of a path.
using SampledSpectrum = Spectrum<float, 4>;

/// Four wavelengths and the density with which each was drawn.
struct Wavelengths {
  std::array<float, 4> lambda_nm; ///< in [360, 830]; [0] is the hero
  std::array<float, 4> pdf;       ///< 1/nm; 0 marks a wavelength the path no longer carries
};

/// Density of each of the wavelengths of `sample_wavelengths`, 1/nm; 0 outside [360, 830].
/// p = k / cosh^2(0.0072 (lambda - 538)): Radziszewski et al. 2009, An Improved Technique for Full Spectral
/// Rendering, with the constants of Pharr, Jakob, Humphreys 2023, section 4.5.4, normalised over [360, 830]
/// exactly.
float wavelength_pdf(float lambda_nm);

/// Hero wavelength at `u` in [0, 1) and companions at u + 1/4, 1/2, 3/4 (mod 1), all through the same inverse
/// distribution; every one alone is distributed as `wavelength_pdf`, so their average is unbiased.
Wavelengths sample_wavelengths(float u);

/// The same path after a wavelength-dependent turn (dispersion): only the hero remains, and an estimate that
/// averages over four stays unbiased because the hero's density is divided by four.
Wavelengths hero_only(const Wavelengths& wavelengths);

} // namespace nacre
