// Single fits and evaluation of sigmoid spectra.

#include "core/error.h"
#include "spectra/detail/sigmoid_fitter.h"
#include "spectra/rgb.h"

#include <algorithm>
#include <fmt/format.h>

namespace nacre {

float SigmoidPolynomial::max_value() const {
  float largest = std::max((*this)(lambda_min_nm), (*this)(lambda_max_nm));
  const float vertex = -c1 / (2 * c0); // infinite or NaN for a straight line
  if (vertex > -1 && vertex < 1) largest = std::max(largest, (*this)(centre_nm + vertex * half_width_nm));
  return largest;
}

SigmoidPolynomial fit_sigmoid(const std::array<float, 3>& rgb) {
  for (float v : rgb)
    if (!(v >= 0 && v <= 1))
      throw Error(
          fmt::format("reflectance ({}, {}, {}): each component must be in [0, 1]", rgb[0], rgb[1], rgb[2]));
  if (rgb[0] == rgb[1] && rgb[1] == rgb[2])
    return {0, 0, detail::constant_sigmoid(static_cast<double>(rgb[0]))};

  const RGB target{static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])};
  const auto& fitter = detail::SigmoidFitter::instance();
  // From the gray of the same luminance towards the target, in more steps when fewer fail.
  const double gray = std::clamp(srgb_luminance(target), 0.01, 0.99);
  detail::Coefficients best{};
  double best_error = std::numeric_limits<double>::infinity();
  constexpr double success = 1e-3;
  for (int steps = 1; steps <= 64 && best_error > success; steps *= 4) {
    detail::Coefficients c{0, 0, static_cast<double>(detail::constant_sigmoid(gray))};
    double error = 0;
    for (int i = 1; i <= steps; ++i) {
      const double f = static_cast<double>(i) / steps;
      error = fitter.fit(
          {gray + f * (target[0] - gray), gray + f * (target[1] - gray), gray + f * (target[2] - gray)}, c);
    }
    if (error < best_error) {
      best_error = error;
      best = c;
    }
  }
  return {static_cast<float>(best[0]), static_cast<float>(best[1]), static_cast<float>(best[2])};
}

} // namespace nacre
