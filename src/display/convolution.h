#pragma once
// Separable convolution of planes of floats. Beyond the border a plane repeats its outermost pixel.

#include <vector>

namespace nacre {

/// Weights for offsets -radius ... radius.
struct Kernel {
  int radius = 0;
  std::vector<float> weights;
  float at(int offset) const { return weights[static_cast<std::size_t>(offset + radius)]; }
};
/// exp(-k^2 / (2 deviation^2)) over offsets k, divided by its sum.
Kernel gaussian_kernel(double deviation, int radius);
/// First derivative of that Gaussian up to sign, scaled so that its positive weights sum to 1, its negative
/// ones to -1. Responds to a step.
Kernel gaussian_slope_kernel(double deviation, int radius);
/// Second derivative of that Gaussian, scaled likewise. Responds to a line or point.
Kernel gaussian_curvature_kernel(double deviation, int radius);

/// Correlation of every row, or every column, with the kernel: out(x) = sum over k of in(x + k) weight(k).
std::vector<float> filter_rows(const std::vector<float>& in, int width, int height, const Kernel& kernel);
std::vector<float> filter_columns(const std::vector<float>& in, int width, int height, const Kernel& kernel);

} // namespace nacre
