#include "measured/channels.h"

#include "core/error.h"
#include "spectra/cie.h"
#include "spectra/illuminants.h"
#include "spectra/rgb.h"

#include <algorithm>
#include <fmt/format.h>

namespace nacre {
namespace {

/// Channel below a wavelength and the fraction of the way to the next; the last value holds beyond the ends.
std::pair<std::size_t, double> between(const std::vector<double>& nodes, double x) {
  if (nodes.size() < 2 || x <= nodes.front()) return {0, 0.0};
  if (x >= nodes.back()) return {nodes.size() - 2, 1.0};
  const std::size_t i = std::size_t(std::upper_bound(nodes.begin(), nodes.end(), x) - nodes.begin()) - 1;
  return {i, (x - nodes[i]) / (nodes[i + 1] - nodes[i])};
}

} // namespace

Channels Channels::grey() { return {}; }

Channels Channels::rgb() {
  Channels c;
  c.count_ = 3;
  return c;
}

Channels Channels::spectral(std::vector<double> wavelengths_nm) {
  const std::size_t n = wavelengths_nm.size();
  if (n < 1 || n > std::size_t(max_count))
    throw Error(fmt::format("a measurement has 1 to {} wavelengths, found {}", max_count, n));
  for (std::size_t i = 0; i < n; ++i)
    if (!(wavelengths_nm[i] > 0 && wavelengths_nm[i] < 1e9 &&
          (i == 0 || wavelengths_nm[i] > wavelengths_nm[i - 1])))
      throw Error(
          fmt::format("wavelengths are positive and increase, found {} at place {}", wavelengths_nm[i], i));
  Channels c;
  c.count_ = int(n);
  c.wavelengths_nm_ = std::move(wavelengths_nm);
  // Each channel's tent over wavelengths, seen by the observer under D65; scaled so that white is (1, 1, 1).
  std::vector<XYZ> seen(n, XYZ{});
  XYZ white{};
  for (int nm = int(lambda_min_nm); nm <= int(lambda_max_nm); ++nm) {
    const auto cmf = cie_1931(float(nm));
    const double light = double(illuminant_d65()(float(nm)));
    const auto [i, t] = between(c.wavelengths_nm_, nm);
    for (std::size_t k = 0; k < 3; ++k) {
      const double w = light * double(cmf[k]);
      white[k] += w;
      seen[i][k] += w * (1 - t);
      if (t > 0) seen[i + 1][k] += w * t;
    }
  }
  const RGB white_rgb = xyz_to_srgb * white;
  for (const XYZ& xyz : seen) {
    const RGB rgb = xyz_to_srgb * xyz;
    c.rgb_weights_.push_back({rgb[0] / white_rgb[0], rgb[1] / white_rgb[1], rgb[2] / white_rgb[2]});
  }
  return c;
}

std::array<double, 3> Channels::to_rgb(std::span<const float> f) const {
  if (!is_spectral()) return {f[0], f[count_ == 3 ? 1 : 0], f[count_ == 3 ? 2 : 0]};
  std::array<double, 3> rgb{};
  for (std::size_t i = 0; i < rgb_weights_.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      rgb[k] += rgb_weights_[i][k] * double(f[i]);
  return rgb;
}

SampledSpectrum Channels::at(std::span<const float> f, const Wavelengths& w) const {
  if (is_rgb()) {
    const auto basis = rgb_basis(w);
    return basis[0] * f[0] + basis[1] * f[1] + basis[2] * f[2];
  }
  SampledSpectrum s(f[0]);
  if (is_spectral() && count_ > 1)
    for (int k = 0; k < 4; ++k) {
      const auto [i, t] = between(wavelengths_nm_, double(w.lambda_nm[std::size_t(k)]));
      s[k] = float((1 - t) * double(f[i]) + t * double(f[i + 1]));
    }
  return s;
}

} // namespace nacre
