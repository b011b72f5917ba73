#pragma once
// Directional albedo of a measurement, by quadrature over half vectors.

#include "measured/measured_bsdf.h"

namespace nacre {

/// Shares of the light arriving from a direction that leave again, per channel of linear RGB.
struct DirectionalAlbedo {
  std::array<double, 3> reflected{}, transmitted{};
};

/// What is not measured scatters nothing. Midpoint rule over `n_theta` x `n_v` half vectors of each side
/// (half_vector_chart.h): by default three to a node of a MERL table's theta_h and more, good to some 0.1 %,
/// less well within a degree of grazing.
/// @param wo  unit, wo.z not 0
/// Source: Nicodemus et al. 1977, directional-hemispherical reflectance.
DirectionalAlbedo directional_albedo(const MeasuredBsdf& measured, const Vec3d& wo, int n_theta = 720,
                                     int n_v = 128);

} // namespace nacre
