#include "measured/measured_albedo.h"

#include "measured/half_vector_chart.h"

namespace nacre {

DirectionalAlbedo directional_albedo(const MeasuredBsdf& measured, const Vec3d& wo, int n_theta, int n_v) {
  const double outer = wo.z < 0 ? -1 : 1;
  const Vec3d up{wo.x, wo.y, std::abs(wo.z)};
  const HalfVectorChart<double> chart(up);
  const Vec2d azimuth = chart.azimuth(up);
  const bool reflects = measured.sides().contain({0, 0, outer}, {0, 0, outer});
  const bool transmits = measured.sides().contain({0, 0, outer}, {0, 0, -outer});
  DirectionalAlbedo sum;
  const auto add = [&](std::array<double, 3>& to, const Vec3d& wi, double weight) {
    const auto f = measured.rgb(wo, wi);
    for (std::size_t c = 0; c < 3; ++c)
      to[c] += f[c] * weight;
  };
  for (int i = 0; i < n_theta; ++i) {
    // theta = theta_max x^2 crowds the nodes towards the normal, as tables do.
    const double x = (i + 0.5) / n_theta, theta = chart.theta_max() * sqr(x);
    const double phi_max = chart.phi_max(theta);
    const double half_angle = std::sin(theta) * 2 * x * chart.theta_max() / n_theta * 2 * phi_max / n_v;
    for (int j = 0; j < n_v; ++j) {
      const Vec3d h = spherical_direction(theta, ((j + 0.5) / n_v * 2 - 1) * phi_max);
      const Vec3d wh{h.x * azimuth.x - h.y * azimuth.y, h.x * azimuth.y + h.y * azimuth.x, h.z};
      const Vec3d wi = reflect(up, wh);
      const double weight = wi.z * 4 * dot(up, wh) * half_angle;
      if (!(wi.z > 0)) continue;
      if (reflects) add(sum.reflected, {wi.x, wi.y, outer * wi.z}, weight);
      if (transmits) add(sum.transmitted, {wi.x, wi.y, -outer * wi.z}, weight);
    }
  }
  return sum;
}

} // namespace nacre
