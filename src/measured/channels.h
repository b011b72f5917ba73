#pragma once
// What the numbers of a measurement stand for: one grey value, linear RGB, or a value a wavelength.

#include "core/spectrum.h"
#include "spectra/wavelengths.h"

#include <array>
#include <span>
#include <vector>

namespace nacre {

class Channels {
public:
  static constexpr int max_count = 512;

  static Channels grey();
  static Channels rgb(); ///< linear sRGB primaries
  /// @throws Error unless the wavelengths are finite, positive, strictly increasing and at most max_count
  static Channels spectral(std::vector<double> wavelengths_nm);

  int count() const { return count_; }
  bool is_rgb() const { return count_ == 3 && wavelengths_nm_.empty(); }
  bool is_spectral() const { return !wavelengths_nm_.empty(); }
  const std::vector<double>& wavelengths_nm() const { return wavelengths_nm_; }

  /// Linear sRGB under D65. A spectrum is linear between its wavelengths and constant beyond them, so that
  /// f equal in all channels has that value in red, green and blue.
  std::array<double, 3> to_rgb(std::span<const float> f) const;
  /// Values at the wavelengths of a path: a spectrum as above, grey alike, RGB by the three spectra of
  /// Mallett and Yuksel (spectra/rgb.h), which sum to 1.
  SampledSpectrum at(std::span<const float> f, const Wavelengths& wavelengths) const;

private:
  int count_ = 1;
  std::vector<double> wavelengths_nm_;
  std::vector<std::array<double, 3>> rgb_weights_; ///< a channel's share in linear RGB; of spectra alone
};

} // namespace nacre
