#include "fit/residuals.h"

#include "bsdf/model_functions.h"

#include <numeric>

namespace nacre {
namespace {

/// Directions evaluated at once: their values and derivatives fit the first-level cache.
constexpr std::size_t block = 256;

/// The parameters of a lobe as its model of one channel takes them.
std::vector<double> channel_values(const LobeSpec& lobe, int channel) {
  std::vector<double> values;
  for (const auto& v : lobe.values)
    values.push_back(v[std::size_t(channel)]);
  return values;
}

} // namespace

Residuals::Residuals(const Observations& observations, Metric metric, const ParameterLayout& layout)
    : at_(observations), metric_(metric), layout_(layout) {
  set_num_residuals(int(3 * at_.count));
  mutable_parameter_block_sizes()->push_back(layout.size());
  const double sum = std::accumulate(at_.weight.begin(), at_.weight.end(), 0.0);
  for (const double w : at_.weight)
    root_weight_.push_back(std::sqrt(w / (3 * sum)));
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t n = 0; n < at_.count; ++n)
      compressed_[c].push_back(compress(metric, double(at_.f[c][n]) * at_.wi[2][n]));
}

bool Residuals::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const double* coordinates = parameters[0];
  const std::size_t width = std::size_t(layout_.size()), rows = 3 * at_.count;
  double* jacobian = jacobians ? jacobians[0] : nullptr;
  if (jacobian) std::fill(jacobian, jacobian + rows * width, 0.0);
  const MaterialSpec material = layout_.material({coordinates, width});
  for (int channel = 0; channel < 3; ++channel)
    for (std::size_t begin = 0; begin < at_.count; begin += block) {
      const std::size_t first = std::size_t(channel) * at_.count + begin;
      evaluate_block(material, coordinates, channel, begin, std::min(block, at_.count - begin),
                     residuals + first, jacobian ? jacobian + first * width : nullptr);
    }
  return std::all_of(residuals, residuals + rows, [](double r) { return std::isfinite(r); });
}

void Residuals::evaluate_block(const MaterialSpec& material, const double* coordinates, int channel,
                               std::size_t begin, std::size_t n, double* residuals, double* jacobian) const {
  const std::size_t width = std::size_t(layout_.size());
  const std::size_t padded = (n + pack_width - 1) / pack_width * pack_width;
  std::array<float, block> f;
  std::array<double, block> sum{};
  std::vector<float> df;
  for (std::size_t l = 0; l < material.lobes.size(); ++l) {
    const LobeSpec& lobe = material.lobes[l];
    const ModelDerivatives& derivatives = model_derivatives(lobe.model);
    if (jacobian) df.resize(std::size_t(derivatives.count) * padded);
    derivatives.evaluate(channel_values(lobe, channel), at_.from(begin), padded, f.data(),
                         jacobian ? df.data() : nullptr);
    for (std::size_t i = 0; i < n; ++i)
      sum[i] += lobe.weight * f[i];
    if (!jacobian) continue;
    const float* column = df.data();
    const ModelInfo& model = model_infos()[std::size_t(lobe.model)];
    for (std::size_t p = 0; p < model.parameters.size(); ++p) {
      if (!model.parameters[p].fitted) continue;
      const int slot = layout_.index(int(l), int(p), channel);
      const double scale = lobe.weight * layout_[slot].slope(coordinates[slot]);
      for (std::size_t i = 0; i < n; ++i)
        jacobian[i * width + std::size_t(slot)] += scale * column[i]; // tied parameters add up
      column += padded;
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double cos_i = at_.wi[2][begin + i], root = root_weight_[begin + i], x = sum[i] * cos_i;
    residuals[i] = root * (compress(metric_, x) - compressed_[std::size_t(channel)][begin + i]);
    if (!jacobian) continue;
    const double outer = root * compress_slope(metric_, x) * cos_i;
    for (std::size_t k = 0; k < width; ++k)
      jacobian[i * width + k] *= outer;
  }
}

std::optional<int> Residuals::invisible_lobe(const std::vector<double>& coordinates) const {
  const MaterialSpec material = layout_.material(coordinates);
  const std::size_t n = (at_.count + pack_width - 1) / pack_width * pack_width;
  const auto zero = [](const std::vector<float>& v) {
    return std::all_of(v.begin(), v.end(), [](float x) { return x == 0; });
  };
  for (std::size_t l = 0; l < material.lobes.size(); ++l) {
    const ModelDerivatives& derivatives = model_derivatives(material.lobes[l].model);
    std::vector<float> f(n), df(n * std::size_t(derivatives.count));
    derivatives.evaluate(channel_values(material.lobes[l], 0), at_.from(0), n, f.data(), df.data());
    if (zero(f) && zero(df)) return int(l);
  }
  return {};
}

} // namespace nacre
