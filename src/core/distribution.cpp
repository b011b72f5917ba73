#include "core/distribution.h"

#include "core/error.h"

#include <fmt/format.h>

namespace nacre {
namespace {

constexpr double grid = 0x1p24;
constexpr std::size_t max_cells = std::size_t{1} << 22;

/// Fills `cumulative` (values.size() + 1 numbers) with multiples of 2^-24 from 0 to 1 that rise by at least
/// one multiple at positive values and not at all at zeros. Returns the sum of the values.
template <class T>
double accumulate(std::span<const T> values, std::span<float> cumulative) {
  const std::size_t n = values.size();
  double total = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(values[i] >= 0 && std::isfinite(values[i])))
      throw Error(fmt::format("distribution: value {} is {}, expected a finite number >= 0", i, values[i]));
    total += values[i];
  }
  if (!std::isfinite(total)) throw Error("distribution: the sum of the values overflows");

  const bool uniform = total == 0;
  const auto positive = [&](std::size_t i) { return uniform || values[i] > 0; };
  double sum = 0, at = 0;
  cumulative[0] = 0;
  for (std::size_t i = 0; i < n; ++i) {
    sum += values[i];
    const double share = uniform ? static_cast<double>(i + 1) / static_cast<double>(n) : sum / total;
    at = std::max(std::round(share * grid), at + (positive(i) ? 1 : 0));
    cumulative[i + 1] = static_cast<float>(std::min(at, grid) / grid);
  }
  // The smallest cells may have pushed the end beyond 1; as there are fewer than 2^24 cells they can make
  // room again.
  double ceiling = grid;
  for (std::size_t i = n; i-- > 0;) {
    ceiling -= positive(i) ? 1 : 0;
    if (cumulative[i] * grid <= ceiling) ceiling = cumulative[i] * grid;
    cumulative[i] = static_cast<float>(ceiling / grid);
  }
  return total;
}

int cell_of(float x, int n) { return std::clamp(static_cast<int>(x * static_cast<float>(n)), 0, n - 1); }

Distribution1D::Sample invert(std::span<const float> cumulative, float u) {
  const int n = static_cast<int>(cumulative.size()) - 1;
  u = std::clamp(u, 0.0f, 0x1.fffffep-1f);
  // The first bound above u ends the cell, so the cell has positive width.
  const auto end = std::upper_bound(cumulative.begin() + 1, cumulative.end(), u);
  const int index = static_cast<int>(end - cumulative.begin()) - 1;
  const float begin = cumulative[index], width = cumulative[index + 1] - begin;
  float x = (static_cast<float>(index) + (u - begin) / width) / static_cast<float>(n);
  x = std::min(x, 0x1.fffffep-1f);
  // Rounding may carry x over a border; back into its cell, so that pdf(x) agrees.
  while (cell_of(x, n) > index)
    x = std::nextafter(x, 0.0f);
  while (cell_of(x, n) < index)
    x = std::nextafter(x, 1.0f);
  return {x, width * static_cast<float>(n), index};
}

float density(std::span<const float> cumulative, float x) {
  if (!(x >= 0 && x <= 1)) return 0;
  const int n = static_cast<int>(cumulative.size()) - 1, i = cell_of(x, n);
  return (cumulative[i + 1] - cumulative[i]) * static_cast<float>(n);
}

template <class T>
double build_line(std::span<const T> values, std::vector<float>& cumulative) {
  if (values.empty() || values.size() > max_cells)
    throw Error(fmt::format("distribution: {} values, expected 1 to {}", values.size(), max_cells));
  cumulative.resize(values.size() + 1);
  return accumulate(values, std::span<float>(cumulative)) / static_cast<double>(values.size());
}

} // namespace

Distribution1D::Distribution1D(std::span<const float> values) : integral_(build_line(values, cumulative_)) {}
Distribution1D::Distribution1D(std::span<const double> values) : integral_(build_line(values, cumulative_)) {}

Distribution1D::Sample Distribution1D::sample(float u) const { return invert(cumulative_, u); }
float Distribution1D::pdf(float x) const { return density(cumulative_, x); }

struct Distribution2D::Built {
  int width;
  std::vector<float> cumulative;
  std::vector<double> row_means;
};

Distribution2D::Built Distribution2D::build(std::span<const float> values, int width, int height) {
  const auto fits = [](int n) { return n >= 1 && static_cast<std::size_t>(n) <= max_cells; };
  if (!fits(width) || !fits(height))
    throw Error(
        fmt::format("distribution: {} x {} cells, expected 1 to {} each way", width, height, max_cells));
  const std::size_t w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  if (values.size() != w * h)
    throw Error(fmt::format("distribution: {} values for {} x {} cells", values.size(), width, height));
  Built built{width, std::vector<float>((w + 1) * h), std::vector<double>(h)};
  for (std::size_t y = 0; y < h; ++y) {
    const std::span<float> row(&built.cumulative[y * (w + 1)], w + 1);
    built.row_means[y] = accumulate(values.subspan(y * w, w), row) / static_cast<double>(w);
  }
  return built;
}

Distribution2D::Distribution2D(Built&& built)
    : width_(built.width), cumulative_(std::move(built.cumulative)),
      rows_(std::span<const double>(built.row_means)) {}
Distribution2D::Distribution2D(std::span<const float> values, int width, int height)
    : Distribution2D(build(values, width, height)) {}

std::span<const float> Distribution2D::row(int y) const {
  const std::size_t n = static_cast<std::size_t>(width_) + 1;
  return {&cumulative_[static_cast<std::size_t>(y) * n], n};
}

Distribution2D::Sample Distribution2D::sample(Vec2f u) const {
  const Distribution1D::Sample v = rows_.sample(u.y), along = invert(row(v.index), u.x);
  return {{along.x, v.x}, along.pdf * v.pdf};
}

float Distribution2D::pdf(Vec2f uv) const {
  const float rows = rows_.pdf(uv.y);
  return rows > 0 ? rows * density(row(cell_of(uv.y, height())), uv.x) : 0;
}

} // namespace nacre
