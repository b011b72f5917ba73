#include "spectra/data/mallett_yuksel.h"
#include "spectra/rgb.h"

#include <algorithm>

namespace nacre {

std::array<SampledSpectrum, 3> rgb_basis(const Wavelengths& wavelengths) {
  constexpr float first_nm = 380, step_nm = 5;
  constexpr int last = 80;
  std::array<SampledSpectrum, 3> basis;
  for (int w = 0; w < 4; ++w) {
    const float x =
        std::clamp((wavelengths.lambda_nm[w] - first_nm) / step_nm, 0.0f, static_cast<float>(last));
    const int i = std::min(static_cast<int>(x), last - 1);
    const float t = x - static_cast<float>(i);
    for (int c = 0; c < 2; ++c) {
      const auto& table = data::mallett_yuksel_5nm[c];
      basis[c][w] = table[i] + t * (table[i + 1] - table[i]);
    }
    basis[2][w] = 1 - basis[0][w] - basis[1][w];
  }
  return basis;
}

} // namespace nacre
