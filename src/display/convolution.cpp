#include "display/convolution.h"

#include "core/parallel.h"

#include <algorithm>
#include <cmath>

namespace nacre {
namespace {

template <class F>
std::vector<double> sampled(int radius, F&& f) {
  std::vector<double> values;
  for (int k = -radius; k <= radius; ++k)
    values.push_back(f(static_cast<double>(k)));
  return values;
}

/// Divides positive weights by their sum and negative weights by the absolute value of theirs.
Kernel balanced(int radius, const std::vector<double>& values) {
  double positive = 0, negative = 0;
  for (double v : values)
    (v > 0 ? positive : negative) += v;
  Kernel kernel{radius, {}};
  for (double v : values)
    kernel.weights.push_back(static_cast<float>(v > 0 ? v / positive : v < 0 ? v / -negative : 0));
  return kernel;
}

} // namespace

Kernel gaussian_kernel(double deviation, int radius) {
  return balanced(radius,
                  sampled(radius, [&](double k) { return std::exp(-k * k / (2 * deviation * deviation)); }));
}
Kernel gaussian_slope_kernel(double deviation, int radius) {
  return balanced(
      radius, sampled(radius, [&](double k) { return -k * std::exp(-k * k / (2 * deviation * deviation)); }));
}
Kernel gaussian_curvature_kernel(double deviation, int radius) {
  const double variance = deviation * deviation;
  return balanced(radius, sampled(radius, [&](double k) {
                    return (k * k / variance - 1) * std::exp(-k * k / (2 * variance));
                  }));
}

std::vector<float> filter_rows(const std::vector<float>& in, int width, int height, const Kernel& kernel) {
  std::vector<float> out(in.size());
  const int radius = kernel.radius;
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t y) {
    const float* row = &in[y * width];
    float* result = &out[y * width];
    std::vector<float> padded(static_cast<std::size_t>(width) + 2 * radius, row[0]);
    std::copy(row, row + width, padded.begin() + radius);
    std::fill(padded.end() - radius, padded.end(), row[width - 1]);
    for (int k = 0; k <= 2 * radius; ++k) {
      const float weight = kernel.weights[k];
      const float* shifted = padded.data() + k;
      for (int x = 0; x < width; ++x)
        result[x] += weight * shifted[x];
    }
  });
  return out;
}

std::vector<float> filter_columns(const std::vector<float>& in, int width, int height, const Kernel& kernel) {
  std::vector<float> out(in.size());
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t y) {
    float* result = &out[y * width];
    for (int k = -kernel.radius; k <= kernel.radius; ++k) {
      const float weight = kernel.at(k);
      const int source = std::clamp(static_cast<int>(y) + k, 0, height - 1);
      const float* row = &in[static_cast<std::size_t>(source) * width];
      for (int x = 0; x < width; ++x)
        result[x] += weight * row[x];
    }
  });
  return out;
}

} // namespace nacre
