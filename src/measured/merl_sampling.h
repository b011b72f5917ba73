#pragma once
// Sampling of tabulated reflectance: for some directions wo, a density over half vectors proportional to the
// light reflected, blended between them, and a cosine lobe against what the table of densities cannot see.

#include "core/pack.h"
#include "core/vec.h"
#include "measured/rusinkiewicz.h"

#include <array>
#include <vector>

namespace nacre {

class MerlTable;

/// The half vectors that reflect wo to somewhere above the surface, as a rectangle. A half vector has angle
/// theta in [0, theta_max) to the normal and azimuth phi_max(theta) v, v in (-1, 1), from wo's. A density on
/// the rectangle loses nothing below the horizon.
template <class R>
struct HalfVectorChart {
  R theta_o, cos_o;

  explicit HalfVectorChart(const Vec3<R>& wo)
      : theta_o(angle_of(R(sqrt(wo.x * wo.x + wo.y * wo.y)), wo.z)), cos_o(wo.z) {}

  R theta_max() const { return constant<R>(pi / 4) + theta_o * R(0.5f); }
  /// wi = reflect(wo, wh) has wi.z = 0 where cos phi = -cot theta_o cot 2 theta. As an arc tangent, whose
  /// square root is 0 where every azimuth or none is above the horizon.
  R phi_max(const R& theta) const {
    const R twice = theta + theta;
    const R root = safe_sqrt(R(-cos(twice + theta_o) * cos(twice - theta_o)));
    return max(angle_of(R(root + R(1e-30f)), R(-cos_o * cos(twice))), R(1e-6f)); // + : never both 0
  }
  /// Cosine and sine of wo's azimuth; (1, 0) for wo on the normal.
  static Vec2<R> azimuth(const Vec3<R>& wo) {
    const R r2 = wo.x * wo.x + wo.y * wo.y;
    const auto on_normal = r2 < R(1e-24f);
    const R inv = R(1) / sqrt(select(on_normal, R(1), r2));
    return {select(on_normal, R(1), wo.x * inv), select(on_normal, R(0), wo.y * inv)};
  }
};

/// The densities of one table. wo nodes are spaced theta_o = pi/2 (1 - (1 - n)^2), dense towards grazing. At
/// each, cells bounded by theta = theta_max (i / n_theta)^2 and |v| = j / n_v have a probability, spread
/// evenly over theta's solid angle and over v. Between nodes the densities blend linearly: a mixture, so that
/// `pdf` is exact.
class MerlSampling {
public:
  static constexpr int n_wo = 48, n_theta = 90, n_v = 24;

  explicit MerlSampling(const MerlTable& table);

  /// Density of wi per solid angle, 1/sr; both directions above the surface. R = float, double or Pack.
  template <class R>
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const;
  /// wi for uniform numbers in [0, 1). R = float or double. Rounding at the horizon can leave wi.z <= 0.
  template <class R>
  Vec3<R> sample(const Vec3<R>& wo, R u_lobe, const Vec2<R>& u) const;
  /// Share of the cosine lobe at a node of wo: that of 0.1, 0.2 .. 0.9 which gave the least variance.
  float cosine_share(int node) const { return cosine_share_[node]; }

private:
  template <class R>
  static R node_position(const R& theta_o) {
    return (R(1) - safe_sqrt(R(1) - theta_o * constant<R>(2 / pi))) * R(static_cast<float>(n_wo - 1));
  }
  /// Largest whole number <= x (x >= 0) that is below n; n - 1 for a NaN, which must not become an index.
  template <class R>
  static R whole_below(const R& x, int n) {
    const R last(static_cast<float>(n - 1));
    return select(x < last, floor(x), last);
  }
  void build_node(const MerlTable& table, int node);

  std::vector<float> cosine_share_; ///< [wo]
  std::vector<float> probability_;  ///< [wo][theta][v], of both signs of v together; sums to 1 over a node
  std::vector<float> row_cdf_;      ///< [wo][theta]: probability of this row and those before
  std::vector<float> cell_cdf_;     ///< [wo][theta][v]: likewise within the row, ends at 1
};

/// sin^2(b / 2) - sin^2(a / 2) without cancellation: half the solid angle between two polar angles, over 2
/// pi.
template <class R>
R half_versine_between(const R& a, const R& b) {
  return sin((a + b) * R(0.5f)) * sin((b - a) * R(0.5f));
}

template <class R>
R MerlSampling::pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
  const HalfVectorChart<R> chart(wo);
  const Vec3<R> s = wo + wi;
  const R s_length = max(length(s), R(1e-20f));
  const R theta = angle_of(R(sqrt(s.x * s.x + s.y * s.y)), s.z), theta_max = chart.theta_max();
  const Vec2<R> x = chart.azimuth(wo);
  const R across = abs(x.x * s.y - x.y * s.x), along = x.x * s.x + x.y * s.y;
  const auto no_azimuth = (across + abs(along)) < R(1e-30f);
  const R phi = angle_of(across, R(select(no_azimuth, R(1), along))), phi_max = chart.phi_max(theta);

  const R inv_n = constant<R>(1.0 / n_theta);
  const R i = whole_below(sqrt(theta / theta_max) * R(n_theta), n_theta);
  const R j = whole_below(phi / phi_max * R(n_v), n_v);
  const R lower = theta_max * sqr(i * inv_n), upper = theta_max * sqr((i + R(1)) * inv_n);

  const R position = node_position(chart.theta_o), node = min(floor(position), R(n_wo - 2)),
          t = position - node;
  const R index = (node * R(n_theta) + i) * R(n_v) + j; // below 2^24: exact in float
  const R probability = gather(probability_.data(), index) * (R(1) - t) +
                        gather(probability_.data() + n_theta * n_v, index) * t;
  // dwh = 2 d(sin^2(theta/2)) dphi; both signs of phi share a cell's probability; dwh / dwi = 1 / (4 wo.wh)
  // and wo.wh = |wo + wi| / 2.
  const R cell_area = R(4) * half_versine_between(lower, upper) * phi_max * constant<R>(1.0 / n_v);
  const R density = probability / (cell_area * R(2) * s_length);
  const R share =
      gather(cosine_share_.data(), node) * (R(1) - t) + gather(cosine_share_.data() + 1, node) * t;
  return share * wi.z * constant<R>(inv_pi) + (R(1) - share) * density;
}

} // namespace nacre
