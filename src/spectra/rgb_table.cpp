// The table of sigmoid spectra for textures.

#include "core/parallel.h"
#include "spectra/detail/sigmoid_fitter.h"
#include "spectra/rgb.h"

#include <algorithm>
#include <atomic>
#include <thread>

namespace nacre {
namespace {

constexpr int n = 64; // nodes along each axis

double smoothstep(double x) { return x * x * (3 - 2 * x); }

std::size_t node(int largest, int z, int y, int x) {
  return ((static_cast<std::size_t>(largest) * n + z) * n + y) * n + x;
}

// The interval of `axis` that holds `v` in [0, 1], and where within it.
std::pair<int, float> locate(const std::vector<float>& axis, float v) {
  const auto after = std::upper_bound(axis.begin() + 1, axis.end() - 1, v);
  const int i = static_cast<int>(after - axis.begin()) - 1;
  return {i, (v - axis[i]) / (axis[i + 1] - axis[i])};
}

} // namespace

RgbToSpectrumTable::RgbToSpectrumTable() : scale_(n), ratio_(n), coefficient_(std::size_t{3} * n * n * n) {
  // Fine near black and white, where the coefficients run away (the paper, section 5), and, beyond the paper,
  // near gray and near saturation, where they do too.
  for (int i = 0; i < n; ++i) {
    const double f = smoothstep(static_cast<double>(i) / (n - 1));
    scale_[i] = static_cast<float>(smoothstep(f));
    ratio_[i] = static_cast<float>(f);
  }

  const auto& fitter = detail::SigmoidFitter::instance();
  const auto fill_plane = [&](int largest, int y) {
    // Continuation: every fit starts from its neighbour's solution, so neighbours stay close to each other.
    constexpr int middle = n / 2;
    detail::Coefficients at_middle{};
    for (int x = 0; x < n; ++x) {
      const auto fit_at = [&](int z, detail::Coefficients& c) {
        RGB rgb;
        const double top = static_cast<double>(scale_[z]);
        rgb[largest] = top;
        rgb[(largest + 1) % 3] = top * static_cast<double>(ratio_[x]);
        rgb[(largest + 2) % 3] = top * static_cast<double>(ratio_[y]);
        fitter.fit(rgb, c);
        coefficient_[node(largest, z, y, x)] = {static_cast<float>(c[0]), static_cast<float>(c[1]),
                                                static_cast<float>(c[2])};
      };
      fit_at(middle, at_middle);
      detail::Coefficients c = at_middle;
      for (int z = middle + 1; z < n; ++z)
        fit_at(z, c);
      c = at_middle;
      for (int z = middle - 1; z >= 0; --z)
        fit_at(z, c);
    }
  };

  // Own threads rather than the shared loop: the first caller may itself be inside such a loop, and a pool
  // that hands it other work of that loop while it waits would enter this function again.
  std::atomic<int> next{0};
  const auto work = [&] {
    for (int i = next++; i < 3 * n; i = next++)
      fill_plane(i / n, i % n);
  };
  std::vector<std::thread> others;
  for (int i = 1; i < thread_count(); ++i)
    others.emplace_back(work);
  work();
  for (auto& thread : others)
    thread.join();
}

const RgbToSpectrumTable& RgbToSpectrumTable::instance() {
  static const RgbToSpectrumTable table;
  return table;
}

SigmoidPolynomial RgbToSpectrumTable::operator()(std::array<float, 3> rgb) const {
  for (float& v : rgb)
    v = v > 0 ? std::min(v, 1.0f) : 0.0f;
  if (rgb[0] == rgb[1] && rgb[1] == rgb[2])
    return {0, 0, detail::constant_sigmoid(static_cast<double>(rgb[0]))};

  const int largest = static_cast<int>(std::max_element(rgb.begin(), rgb.end()) - rgb.begin());
  const float top = rgb[largest];
  const auto [k, fz] = locate(scale_, top);
  const auto [i, fx] = locate(ratio_, rgb[(largest + 1) % 3] / top);
  const auto [j, fy] = locate(ratio_, rgb[(largest + 2) % 3] / top);
  std::array<float, 3> c{};
  for (int corner = 0; corner < 8; ++corner) {
    const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
    const float weight = (dx ? fx : 1 - fx) * (dy ? fy : 1 - fy) * (dz ? fz : 1 - fz);
    const auto& at = coefficient_[node(largest, k + dz, j + dy, i + dx)];
    for (int a = 0; a < 3; ++a)
      c[a] += weight * at[a];
  }
  return {c[0], c[1], c[2]};
}

} // namespace nacre
