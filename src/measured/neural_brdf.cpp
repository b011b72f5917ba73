#include "measured/neural_brdf.h"

#include "core/error.h"
#include "core/pack.h"
#include "measured/merl_table.h"
#include "measured/rusinkiewicz.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace nacre {
namespace {

std::size_t padded(std::size_t n) { return (n + pack_width - 1) / pack_width * pack_width; }

/// exp of more overflows float in sums of a few values.
constexpr float max_exponent = 80;

} // namespace

NeuralBrdf::NeuralBrdf(const std::vector<Layer>& layers) : layers_(layers) {
  if (layers.empty() || layers.size() > max_layers)
    throw Error(fmt::format("a reflectance network has 1 to {} layers, found {}", max_layers, layers.size()));
  std::size_t width = inputs;
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const Layer& layer = layers[l];
    const bool last = l + 1 == layers.size();
    if (layer.inputs != width || layer.outputs < 1 || layer.outputs > max_width ||
        (last && layer.outputs != outputs))
      throw Error(fmt::format("layer {} of a reflectance network is {} x {}, expected {} x {}", l + 1,
                              layer.inputs, layer.outputs, width,
                              last ? std::to_string(outputs) : fmt::format("1 to {}", max_width)));
    if (layer.kernel.size() != layer.inputs * layer.outputs || layer.bias.size() != layer.outputs)
      throw Error(fmt::format(
          "layer {} of a reflectance network has {} weights and {} biases, expected {} and {}", l + 1,
          layer.kernel.size(), layer.bias.size(), layer.inputs * layer.outputs, layer.outputs));
    const std::size_t stride = padded(layer.outputs);
    std::vector<float> rows((layer.inputs + 1) * stride);
    std::copy(layer.bias.begin(), layer.bias.end(), rows.begin());
    for (std::size_t i = 0; i < layer.inputs; ++i)
      std::copy_n(&layer.kernel[i * layer.outputs], layer.outputs, &rows[(i + 1) * stride]);
    if (!std::all_of(rows.begin(), rows.end(), [](float x) { return std::abs(x) < 1e6f; }))
      throw Error(fmt::format("layer {} of a reflectance network: expected finite weights below 1e6", l + 1));
    rows_.push_back(std::move(rows));
    width = layer.outputs;
  }
}

std::vector<std::pair<std::string, std::string>> NeuralBrdf::facts() const {
  std::vector<std::size_t> widths{inputs};
  std::size_t numbers = 0;
  for (const Layer& l : layers_) {
    widths.push_back(l.outputs);
    numbers += l.kernel.size() + l.bias.size();
  }
  return {{"network", fmt::format("{}, {} weights", fmt::join(widths, "-"), numbers)},
          {"source", "Sztrajman et al. 2021, Neural BRDF Representation and Importance Sampling"}};
}

const Channels& NeuralBrdf::channels() const {
  static const Channels rgb = Channels::rgb();
  return rgb;
}

std::array<float, 3> NeuralBrdf::value(double theta_h, double theta_d, double phi_d) const {
  std::array<float, max_width + pack_width> first, second; // only what a layer wrote is read
  float *x = first.data(), *y = second.data();
  const double sin_d = std::sin(theta_d);
  x[0] = float(std::sin(theta_h)), x[1] = 0, x[2] = float(std::cos(theta_h));
  x[3] = float(sin_d * std::cos(phi_d)), x[4] = float(sin_d * std::sin(phi_d)),
  x[5] = float(std::cos(theta_d));
  for (std::size_t l = 0; l < layers_.size(); ++l) {
    const std::size_t n = layers_[l].inputs, stride = padded(layers_[l].outputs);
    const float* row = rows_[l].data();
    for (std::size_t at = 0; at < stride; at += pack_width) {
      Pack even = load(row + at), odd(0.0f); // two sums: half the chain of dependent additions
      std::size_t i = 0;
      for (; i + 1 < n; i += 2) {
        even = even + Pack(x[i]) * load(row + (i + 1) * stride + at);
        odd = odd + Pack(x[i + 1]) * load(row + (i + 2) * stride + at);
      }
      if (i < n) even = even + Pack(x[i]) * load(row + (i + 1) * stride + at);
      Pack sum = even + odd;
      if (l + 1 < layers_.size()) sum = max(sum, Pack(0.0f));
      store(y + at, sum);
    }
    std::swap(x, y);
  }
  std::array<float, 3> rgb;
  for (std::size_t c = 0; c < 3; ++c)
    rgb[c] = x[c] > 0 ? std::expm1(std::min(x[c], max_exponent)) : 0; // also where a sum overflowed to NaN
  return rgb;
}

bool NeuralBrdf::evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const {
  std::fill_n(f.begin(), 3, 0.0f);
  if (!(wo.z > 0 && wi.z > 0)) return false;
  const auto a = half_difference(wo, wi);
  // A network need not be periodic: what rounding puts just below the seam belongs to 0, not to pi.
  const auto rgb = value(a.theta_h, a.theta_d, a.phi_d < -1e-5 ? a.phi_d + pi : std::max(a.phi_d, 0.0));
  std::copy(rgb.begin(), rgb.end(), f.begin());
  return true;
}

MeasuredSamples NeuralBrdf::samples() const {
  constexpr int step_h = 2, step_d = 3, step_phi = 6;
  constexpr int n_h = MerlTable::original_theta_h, n_d = MerlTable::original_theta_d,
                n_phi = MerlTable::original_phi_d;
  const MerlTable grid(n_h, n_d, 1, std::vector<MerlTable::Cell>(std::size_t(n_h) * n_d));
  MeasuredSamples s;
  for (int i = 0; i < n_h; i += step_h)
    for (int j = 0; j < n_d; j += step_d) {
      const double weight = grid.node_weight(i, j, step_h, step_d);
      for (int k = 0; k < n_phi; k += step_phi) {
        const HalfDifference<double> a{grid.theta_h(i), grid.theta_d(j), pi * k / n_phi};
        const auto [wo, wi] = directions(a);
        if (!(wo.z > 0 && wi.z > 0)) continue;
        const auto rgb = value(a.theta_h, a.theta_d, a.phi_d);
        s.wo.push_back({float(wo.x), float(wo.y), float(wo.z)});
        s.wi.push_back({float(wi.x), float(wi.y), float(wi.z)});
        s.f.insert(s.f.end(), rgb.begin(), rgb.end());
        s.weight.push_back(weight);
      }
    }
  return s;
}

} // namespace nacre
