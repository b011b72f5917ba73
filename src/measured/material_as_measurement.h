#pragma once
// A material as if it had been measured: what any listed model or fit is converted, described and tabulated
// by.

#include "measured/material_spec.h"

namespace nacre {

/// Linear RGB. Evaluated exactly, in double; samples lie on a grid of half and difference angles, theta_h 36
/// (square-root spaced) x theta_d 18 x phi_d 18, of an anisotropic material at 16 azimuths, and light that
/// goes through mirrored at the surface. Whether it is isotropic and which sides it has is found by trying a
/// few hundred pairs of directions. A lobe of mirror directions alone, which no table can hold, is not seen.
class MaterialAsMeasurement final : public MeasuredBsdf {
public:
  /// @throws Error if the material scatters nothing that a table can hold
  explicit MaterialAsMeasurement(MaterialSpec material);

  std::string kind() const override { return "material of models"; }
  std::vector<std::pair<std::string, std::string>> facts() const override;
  const Channels& channels() const override;
  bool is_isotropic() const override { return isotropic_; }
  MeasuredSides sides() const override { return sides_; }
  bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const override;
  MeasuredSamples samples() const override;

private:
  MaterialSpec material_; ///< keeps what the lobes point to
  Bsdf<double, 3> bsdf_;
  MeasuredSides sides_{false, false, false, false};
  bool isotropic_ = true;
};

/// A measurement as it is, anything else as above. @throws Error
std::shared_ptr<const MeasuredBsdf> as_measurement(const MaterialSpec& material);

} // namespace nacre
