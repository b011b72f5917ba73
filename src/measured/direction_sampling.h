#pragma once
// Directions for measurements whose format has no sampling of its own.

#include "measured/measured_bsdf.h"

namespace nacre {

/// A cosine lobe on each side that the measurement reflects or transmits to.
class DirectionSampling {
public:
  explicit DirectionSampling(const MeasuredBsdf& measured) : sides_(measured.sides()) {}
  double pdf(const Vec3d& wo, const Vec3d& wi) const;
  Vec3d sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const;

private:
  /// Share of the directions that stay on wo's side.
  double stays(const Vec3d& wo) const;
  MeasuredSides sides_;
};

} // namespace nacre
