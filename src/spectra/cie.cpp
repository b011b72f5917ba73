#include "spectra/cie.h"

#include "spectra/data/cie_1931.h"

#include <algorithm>
#include <vector>

namespace nacre {
namespace {

constexpr int step_nm = 5;

// Between two nodes of an equidistant table, at x in [0, 1) after f[2]: Sprague's quintic, which CIE 167:2005
// recommends for colour matching functions. At the ends of the table, where the functions are below 1e-3,
// linear.
double interpolate(const std::array<double, 95>& f, int i, double x) {
  if (x == 0) return f[i];
  if (i < 2 || i + 3 >= static_cast<int>(f.size())) return f[i] + x * (f[i + 1] - f[i]);
  const double* p = &f[i];
  const double a1 = 2 * p[-2] - 16 * p[-1] + 16 * p[1] - 2 * p[2];
  const double a2 = -p[-2] + 16 * p[-1] - 30 * p[0] + 16 * p[1] - p[2];
  const double a3 = -9 * p[-2] + 39 * p[-1] - 70 * p[0] + 66 * p[1] - 33 * p[2] + 7 * p[3];
  const double a4 = 13 * p[-2] - 64 * p[-1] + 126 * p[0] - 124 * p[1] + 61 * p[2] - 12 * p[3];
  const double a5 = -5 * p[-2] + 25 * p[-1] - 50 * p[0] + 50 * p[1] - 25 * p[2] + 5 * p[3];
  return std::max(0.0, p[0] + x * (a1 + x * (a2 + x * (a3 + x * (a4 + x * a5)))) / 24);
}

constexpr int node_count = static_cast<int>(lambda_max_nm - lambda_min_nm) + 1;

// 360, 361, ..., 830 nm and one node of padding.
std::vector<std::array<float, 3>> one_nm_table() {
  std::vector<std::array<float, 3>> table(node_count + 1);
  for (int n = 0; n < node_count; ++n)
    for (int c = 0; c < 3; ++c)
      table[n][c] = static_cast<float>(
          interpolate(data::cie_1931_5nm[c], n / step_nm, n % step_nm / static_cast<double>(step_nm)));
  return table;
}

} // namespace

std::array<float, 3> cie_1931(float lambda_nm) {
  static const auto table = one_nm_table();
  if (!(lambda_nm >= lambda_min_nm && lambda_nm <= lambda_max_nm)) return {0, 0, 0};
  const float x = lambda_nm - lambda_min_nm;
  const int i = static_cast<int>(x);
  const float t = x - static_cast<float>(i);
  std::array<float, 3> value;
  for (int c = 0; c < 3; ++c)
    value[c] = table[i][c] + t * (table[i + 1][c] - table[i][c]);
  return value;
}

XYZ to_xyz(const SampledSpectrum& radiance, const Wavelengths& wavelengths) {
  XYZ sum{};
  for (int i = 0; i < 4; ++i) {
    if (wavelengths.pdf[i] == 0) continue;
    const double weight =
        static_cast<double>(radiance[i]) / (4 * cie_y_integral_nm * static_cast<double>(wavelengths.pdf[i]));
    const auto cmf = cie_1931(wavelengths.lambda_nm[i]);
    for (int c = 0; c < 3; ++c)
      sum[c] += weight * static_cast<double>(cmf[c]);
  }
  return sum;
}

} // namespace nacre
