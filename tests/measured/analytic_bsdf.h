#pragma once
// Models of the list as measurements, for tests of formats.

#include "measured/material_spec.h"
#include "measured/measured_bsdf.h"

#include <algorithm>
#include <cmath>

namespace nacre {

/// A material in RGB, or in wavelengths as a smooth mixture of its R, G and B.
class AnalyticBsdf final : public MeasuredBsdf {
public:
  AnalyticBsdf(const std::string& material, bool isotropic, std::vector<double> wavelengths_nm = {})
      : bsdf_(make_bsdf<double>(parse_material(material))), isotropic_(isotropic),
        channels_(wavelengths_nm.empty() ? Channels::rgb() : Channels::spectral(wavelengths_nm)) {}

  std::string kind() const override { return "a model of the list"; }
  std::vector<std::pair<std::string, std::string>> facts() const override { return {}; }
  const Channels& channels() const override { return channels_; }
  bool is_isotropic() const override { return isotropic_; }
  bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const override {
    std::fill(f.begin(), f.end(), 0.0f);
    if (!(wo.z > 0 && wi.z > 0)) return false;
    const auto rgb = bsdf_.eval(wo, wi);
    if (!channels_.is_spectral()) {
      for (std::size_t c = 0; c < 3; ++c)
        f[c] = float(rgb[int(c)]);
      return true;
    }
    for (std::size_t c = 0; c < f.size(); ++c) {
      const double t = std::clamp((channels_.wavelengths_nm()[c] - 450) / 150, 0.0, 1.0); // blue to red
      f[c] = float(t * rgb[0] + (1 - t) * rgb[2]);
    }
    return true;
  }
  MeasuredSamples samples() const override { return {}; }

private:
  Bsdf<double, 3> bsdf_;
  bool isotropic_;
  Channels channels_;
};

} // namespace nacre
