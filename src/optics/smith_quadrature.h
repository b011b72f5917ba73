#pragma once
// Smith's masking by quadrature, for distributions whose Lambda has no closed form.

#include "core/vec.h"

#include <array>

namespace nacre {

/// Gauss-Legendre nodes and weights on (0, 1), and the same carried by maps t(x): to (0, infinity) by
/// (x / (1 - x))^2 for what spans one or two decades about 1 and by (x / (1 - x))^3 for many, to (0, 1) by
/// x^3. All are flat at 0, where the integrand of masking begins with a power 3/2.
struct SmithNodes {
  static constexpr int count = 32;
  struct Mapped {
    std::array<double, count> t, weight;
  };
  std::array<double, count> x, weight;
  Mapped narrow, wide, bounded;
};
const SmithNodes& smith_nodes();

/// Lambda cos of an isotropic distribution of slopes, the projected area of the facets that face away:
///   the integral over slopes of max(0, s r cos(phi) - z) P22(r^2) r dr dphi
/// with the azimuth in closed form and the radius by fixed nodes beyond r = z / s, where facets begin to face
/// away. Source: Heitz 2014, eq. 43 and 68 (with Lambda from G1), after Smith 1967.
/// @param slope_density  P22 as a function of the squared slope r^2
/// @param s, z           horizontal and vertical part of a direction above the surface (of any length)
/// @param length         of the range of slopes as a function of where it starts; the scale of it for maps to
///                       (0, infinity)
template <class R, class SlopeDensity, class Length>
R smith_lambda_cos(const SlopeDensity& slope_density, const R& s, const R& z, const SmithNodes::Mapped& nodes,
                   const Length& length) {
  const R sin = max(s, R(1e-3f) * max(z, R(1e-20f))); // beyond slope 1000, 1e-6 is left
  const R start = z / sin, range = length(start);
  R sum = R(0);
  for (int i = 0; i < SmithNodes::count; ++i) {
    const R r = start + range * constant<R>(nodes.t[i]);
    const R c = min(start / max(r, R(1e-20f)), R(0.999999f)); // beyond, acos has no derivative and no weight
    const R kernel = sin * r * sqrt(R(1) - c * c) - z * acos(c);
    sum = sum + constant<R>(nodes.weight[i]) * kernel * r * slope_density(R(r * r));
  }
  return R(2) * range * sum;
}

} // namespace nacre
