#pragma once
// A material evaluated at the nodes of the MERL grid, as a measurement without noise: what other models are
// compared with, and fitted to.

#include "measured/material_spec.h"
#include "measured/measured_bsdf.h"

namespace nacre {

class EvaluatedMaterial final : public MeasuredBsdf {
public:
  /// All 90 theta_h, and every n-th theta_d and phi_d of 90 and 180. The pairs of directions of a material
  /// that is not isotropic are turned about the normal, each by another angle.
  EvaluatedMaterial(const MaterialSpec& material, int theta_d_step, int phi_d_step);

  std::string kind() const override { return "evaluated material"; }
  std::vector<std::pair<std::string, std::string>> facts() const override { return {}; }
  const Channels& channels() const override { return channels_; }
  bool is_isotropic() const override { return isotropic_; }
  bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const override;
  MeasuredSamples samples() const override { return samples_; }

private:
  Bsdf<double, 3> bsdf_;
  Channels channels_ = Channels::rgb();
  bool isotropic_;
  MeasuredSamples samples_;
  std::vector<std::shared_ptr<const MeasuredBsdf>> kept_; ///< measurements that bsdf_ points to
};

/// Whether turning both directions about the normal changes f, at some pairs of directions.
bool is_isotropic(const Bsdf<double, 3>& bsdf);

} // namespace nacre
