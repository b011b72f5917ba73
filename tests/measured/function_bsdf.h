#pragma once
// A measurement that is a formula, for tests of what is done with any measurement.

#include "measured/material_spec.h"

#include <functional>

namespace nacre {

class FunctionBsdf final : public MeasuredBsdf {
public:
  /// Linear RGB in 1/sr; negative red makes a hole.
  using Function = std::function<std::array<double, 3>(const Vec3d& wo, const Vec3d& wi)>;

  FunctionBsdf(Function f, bool isotropic = true, const MeasuredSides& sides = {})
      : f_(std::move(f)), isotropic_(isotropic), sides_(sides) {}

  std::string kind() const override { return "formula"; }
  std::vector<std::pair<std::string, std::string>> facts() const override { return {}; }
  const Channels& channels() const override {
    static const Channels rgb = Channels::rgb();
    return rgb;
  }
  bool is_isotropic() const override { return isotropic_; }
  MeasuredSides sides() const override { return sides_; }
  bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const override {
    std::fill_n(f.begin(), 3, 0.0f);
    if (!sides_.contain(wo, wi)) return false;
    const auto rgb = f_(wo, wi);
    if (rgb[0] < 0) return false;
    for (std::size_t c = 0; c < 3; ++c)
      f[c] = float(rgb[c]);
    return true;
  }
  /// A grid of 10 degrees.
  MeasuredSamples samples() const override {
    MeasuredSamples s;
    const auto add = [&](const Vec3d& wo, const Vec3d& wi) {
      std::array<float, 3> f;
      if (!evaluate(wo, wi, f)) return;
      s.wo.push_back(vec3<float>(wo)), s.wi.push_back(vec3<float>(wi));
      s.f.insert(s.f.end(), f.begin(), f.end());
      s.weight.push_back(1);
    };
    for (int o = 5; o < 180; o += 10)
      for (int i = 5; i < 180; i += 10)
        for (int phi = 0; phi < 360; phi += 10)
          add(spherical_direction(o * pi / 180, 0.0), spherical_direction(i * pi / 180, phi * pi / 180));
    return s;
  }

private:
  Function f_;
  bool isotropic_;
  MeasuredSides sides_;
};

inline FunctionBsdf function_of(const std::string& material, bool isotropic = true,
                                const MeasuredSides& sides = {}) {
  return FunctionBsdf([bsdf = make_bsdf<double>(parse_material(material))](
                          const Vec3d& wo, const Vec3d& wi) { return bsdf.eval(wo, wi).c; },
                      isotropic, sides);
}

} // namespace nacre
