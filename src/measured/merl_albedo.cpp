#include "measured/merl_albedo.h"

#include "measured/half_vector_chart.h"

namespace nacre {

std::array<double, 3> directional_albedo(const MerlTable& table, double theta_o) {
  constexpr int n_theta = 720, n_v = 128;
  const Vec3d wo = spherical_direction(theta_o, 0.0);
  const HalfVectorChart<double> chart(wo);
  Spectrum<double, 3> sum;
  for (int i = 0; i < n_theta; ++i) {
    // theta = theta_max x^2 crowds the nodes towards the normal, as the table does.
    const double x = (i + 0.5) / n_theta, theta = chart.theta_max() * sqr(x);
    const double phi_max = chart.phi_max(theta);
    const double half_angle = std::sin(theta) * 2 * x * chart.theta_max() / n_theta * 2 * phi_max / n_v;
    for (int j = 0; j < n_v; ++j) {
      const Vec3d wh = spherical_direction(theta, ((j + 0.5) / n_v * 2 - 1) * phi_max), wi = reflect(wo, wh);
      if (wi.z > 0) sum += table.interpolate(half_difference(wo, wi)) * (wi.z * 4 * dot(wo, wh) * half_angle);
    }
  }
  return sum.c;
}

} // namespace nacre
