#include "measured/marginal_warp.h"

#include "core/error.h"

#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

struct Between {
  std::size_t index;
  double fraction;
};
Between between(std::span<const float> nodes, double x) {
  if (nodes.size() < 2 || !(x > double(nodes.front()))) return {0, 0};
  if (x >= double(nodes.back())) return {nodes.size() - 2, 1};
  const auto i = std::size_t(std::upper_bound(nodes.begin(), nodes.end(), x) - nodes.begin()) - 1;
  return {i, (x - double(nodes[i])) / (double(nodes[i + 1]) - double(nodes[i]))};
}

/// t in [0, 1] where the integral over [0, t] of the line from a to b is `area`. Without cancellation.
double invert_line(double a, double b, double area) {
  const double root = std::sqrt(std::max(0.0, a * a + 2 * area * (b - a)));
  return a + root > 0 ? std::min(2 * area / (a + root), 1.0) : 0.0;
}

/// The last node in [0, n - 2] whose value is at most x, of values that ascend from 0.
template <class F>
std::size_t last_at_most(std::size_t n, double x, F value) {
  std::size_t low = 0, high = n - 1;
  while (high - low > 1) {
    const std::size_t middle = (low + high) / 2;
    (value(middle) <= x ? low : high) = middle;
  }
  return low;
}

} // namespace

SliceBlend blend_slices(std::span<const float> a_nodes, double a, std::span<const float> b_nodes, double b) {
  const Between i = between(a_nodes, a), j = between(b_nodes, b);
  SliceBlend blend;
  blend.count = 0;
  for (std::size_t di = 0; di < 2; ++di)
    for (std::size_t dj = 0; dj < 2; ++dj) {
      const double w = (di ? i.fraction : 1 - i.fraction) * (dj ? j.fraction : 1 - j.fraction);
      if (w == 0) continue;
      blend.slice[blend.count] = (i.index + di) * b_nodes.size() + j.index + dj;
      blend.weight[blend.count++] = w;
    }
  return blend;
}

MarginalWarp::MarginalWarp(std::size_t width, std::size_t height, std::span<const float> values)
    : width_(width), height_(height), density_(values.begin(), values.end()) {
  const std::size_t slice_size = width * height;
  if (width < 2 || height < 2 || values.empty() || values.size() % slice_size != 0)
    throw Error(fmt::format("a warp's table needs slices of 2 x 2 nodes or more, found {} values for {} x {}",
                            values.size(), height, width));
  for (const float v : values)
    if (!(v >= 0 && std::isfinite(v))) throw Error(fmt::format("a warp's table holds {}", v));
  const std::size_t slices = values.size() / slice_size;
  conditional_.resize(values.size());
  marginal_.resize(slices * height);
  const double dx = 1.0 / double(width - 1), dy = 1.0 / double(height - 1);
  for (std::size_t s = 0; s < slices; ++s) {
    float* density = &density_[s * slice_size];
    double* conditional = &conditional_[s * slice_size];
    double* marginal = &marginal_[s * height];
    const auto accumulate = [&] {
      for (std::size_t y = 0; y < height; ++y) {
        const float* d = density + y * width;
        double* c = conditional + y * width;
        c[0] = 0;
        for (std::size_t x = 1; x < width; ++x)
          c[x] = c[x - 1] + 0.5 * dx * (double(d[x - 1]) + double(d[x]));
      }
      marginal[0] = 0;
      for (std::size_t y = 1; y < height; ++y)
        marginal[y] =
            marginal[y - 1] + 0.5 * dy * (conditional[y * width - 1] + conditional[(y + 1) * width - 1]);
      return marginal[height - 1];
    };
    const double integral = accumulate();
    for (std::size_t i = 0; i < slice_size; ++i)
      density[i] = integral > 0 ? float(double(density[i]) / integral) : 1.0f;
    // Again over the rounded densities, and exactly 1 at the end.
    const double rounded = accumulate();
    for (std::size_t i = 0; i < slice_size; ++i)
      conditional[i] /= rounded;
    for (std::size_t y = 0; y < height; ++y)
      marginal[y] /= rounded;
  }
}

MarginalWarp::Point MarginalWarp::sample(const Vec2d& u, const SliceBlend& b) const {
  const auto marginal = [&](std::size_t y) { return blended(marginal_, height_, y, b); };
  const std::size_t slice_size = width_ * height_;
  const double target = std::min(std::max(0.0, u.y), 1.0);
  const std::size_t y = last_at_most(height_, target, marginal);
  const double r0 = blended(conditional_, slice_size, (y + 1) * width_ - 1, b);
  const double r1 = blended(conditional_, slice_size, (y + 2) * width_ - 1, b);
  const double fy = invert_line(r0, r1, std::max(0.0, target - marginal(y)) * double(height_ - 1));

  const auto conditional = [&](std::size_t x) {
    return (1 - fy) * blended(conditional_, slice_size, y * width_ + x, b) +
           fy * blended(conditional_, slice_size, (y + 1) * width_ + x, b);
  };
  const double across = std::min(std::max(0.0, u.x), 1.0) * ((1 - fy) * r0 + fy * r1);
  const std::size_t x = last_at_most(width_, across, conditional);
  const auto column = [&](std::size_t i) {
    return (1 - fy) * blended(density_, slice_size, y * width_ + i, b) +
           fy * blended(density_, slice_size, (y + 1) * width_ + i, b);
  };
  const double c0 = column(x), c1 = column(x + 1);
  const double fx = invert_line(c0, c1, std::max(0.0, across - conditional(x)) * double(width_ - 1));
  return {{(double(x) + fx) / double(width_ - 1), (double(y) + fy) / double(height_ - 1)},
          (1 - fx) * c0 + fx * c1};
}

MarginalWarp::Point MarginalWarp::invert(const Vec2d& at, const SliceBlend& b) const {
  const BilinearCell c(at, width_, height_);
  const double dx = 1.0 / double(width_ - 1), dy = 1.0 / double(height_ - 1);
  double c0 = 0, c1 = 0, before = 0, r0 = 0, r1 = 0, below = 0;
  for (std::size_t k = 0; k < b.count; ++k) {
    const double w = b.weight[k], w0 = w * (1 - c.fy), w1 = w * c.fy;
    const std::size_t row = b.slice[k] * width_ * height_ + c.y * width_;
    const float* d = &density_[row + c.x];
    c0 += w0 * double(d[0]) + w1 * double(d[width_]);
    c1 += w0 * double(d[1]) + w1 * double(d[width_ + 1]);
    const double* integral = &conditional_[row];
    before += w0 * integral[c.x] + w1 * integral[width_ + c.x];
    r0 += w * integral[width_ - 1];
    r1 += w * integral[2 * width_ - 1];
    below += w * marginal_[b.slice[k] * height_ + c.y];
  }
  const double total = (1 - c.fy) * r0 + c.fy * r1;
  const double across = before + dx * c.fx * (c0 + 0.5 * c.fx * (c1 - c0));
  const double up = below + dy * c.fy * (r0 + 0.5 * c.fy * (r1 - r0));
  return {{total > 0 ? std::min(across / total, 1.0) : 0.0, std::min(up, 1.0)}, (1 - c.fx) * c0 + c.fx * c1};
}

double MarginalWarp::pdf(const Vec2d& at, const SliceBlend& b) const {
  const BilinearCell c(at, width_, height_);
  double sum = 0;
  for (std::size_t k = 0; k < b.count; ++k) {
    const float* d = &density_[b.slice[k] * width_ * height_ + c.y * width_ + c.x];
    sum += b.weight[k] * ((1 - c.fy) * ((1 - c.fx) * double(d[0]) + c.fx * double(d[1])) +
                          c.fy * ((1 - c.fx) * double(d[width_]) + c.fx * double(d[width_ + 1])));
  }
  return sum;
}

} // namespace nacre
