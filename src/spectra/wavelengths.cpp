#include "spectra/wavelengths.h"

#include <cmath>

namespace nacre {
namespace {

constexpr double slope = 0.0072, centre_nm = 538; // 1/nm, nm
// tanh of the ends of the range: the distribution function is linear in tanh(slope (lambda - centre)).
const double tanh_first = std::tanh(slope * (static_cast<double>(lambda_min_nm) - centre_nm));
const double tanh_span = std::tanh(slope * (static_cast<double>(lambda_max_nm) - centre_nm)) - tanh_first;

} // namespace

float wavelength_pdf(float lambda_nm) {
  if (!(lambda_nm >= lambda_min_nm && lambda_nm <= lambda_max_nm)) return 0;
  const double c = std::cosh(slope * (static_cast<double>(lambda_nm) - centre_nm));
  return static_cast<float>(slope / (tanh_span * c * c));
}

Wavelengths sample_wavelengths(float u) {
  Wavelengths w;
  for (int i = 0; i < 4; ++i) {
    double rotated = static_cast<double>(u) + 0.25 * i;
    if (rotated >= 1) rotated -= 1;
    // atanh(t) = log((1 + t) / (1 - t)) / 2, and 1 / cosh^2 of it is 1 - t^2.
    const double t = tanh_first + rotated * tanh_span;
    const double lambda_nm = centre_nm + std::log((1 + t) / (1 - t)) * (0.5 / slope);
    w.lambda_nm[i] = std::clamp(static_cast<float>(lambda_nm), lambda_min_nm, lambda_max_nm);
    w.pdf[i] = static_cast<float>(slope / tanh_span * (1 - t * t));
  }
  return w;
}

Wavelengths hero_only(const Wavelengths& wavelengths) {
  // Already alone: dividing again would change the estimate.
  if (wavelengths.pdf[1] == 0 && wavelengths.pdf[2] == 0 && wavelengths.pdf[3] == 0) return wavelengths;
  return {wavelengths.lambda_nm, {wavelengths.pdf[0] / 4, 0, 0, 0}};
}

} // namespace nacre
