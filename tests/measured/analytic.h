#pragma once
// Functions of known form to measure.

#include "core/random.h"
#include "core/vec.h"
#include "measured/measured_bsdf.h"

#include <cmath>

namespace nacre {

inline Vec3d at_degrees(double theta_deg, double phi_deg) {
  const double t = theta_deg * pi / 180, p = phi_deg * pi / 180;
  return {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
}

/// Lambert and a rough mirror: GGX over an ellipse, with the separable shadowing of Smith and no Fresnel.
struct Glossy {
  double alpha_x = 0.3, alpha_y = 0.3, diffuse = 0.1;

  double operator()(const Vec3d& wo, const Vec3d& wi) const {
    const Vec3d h = normalize(wo + wi);
    const double e = sqr(h.x / alpha_x) + sqr(h.y / alpha_y) + h.z * h.z;
    const double d = 1 / (pi * alpha_x * alpha_y * e * e);
    const auto g = [&](const Vec3d& w) {
      const double a2 = (sqr(w.x * alpha_x) + sqr(w.y * alpha_y)) / sqr(w.z);
      return 2 / (1 + std::sqrt(1 + a2));
    };
    return diffuse / pi + d * g(wo) * g(wi) / (4 * wo.z * wi.z);
  }
};

/// A direction in front, uniform over solid angle up to `max_theta_deg`; the n-th of a fixed row.
inline Vec3d random_direction(std::uint64_t n, double max_theta_deg) {
  const double z = 1 - (1 - std::cos(max_theta_deg * pi / 180)) * unit_double(hash(3, n, 0));
  const double phi = 2 * pi * unit_double(hash(3, n, 1)), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

inline double grey(const MeasuredBsdf& m, const Vec3d& wo, const Vec3d& wi) {
  std::vector<float> f(std::size_t(m.channels().count()));
  return m.evaluate(wo, wi, f) ? double(f[0]) : -1.0; // -1: a hole
}

} // namespace nacre
