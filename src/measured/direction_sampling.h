#pragma once
// Importance sampling of measured scattering: for some directions wo, densities over half vectors in
// proportion to the luminance scattered, blended between them, and a share of a cosine lobe against what the
// densities cannot see.
//
// Both directions are taken to the upper side first: light that passes through is mirrored at the surface, so
// that a straight passage has the half vector of a mirror. Each pair of sides that the measurement knows has
// its own densities. Blending is a mixture of the densities of the nodes about wo, so that `pdf` is exact.

#include "measured/half_vector_chart.h"
#include "measured/measured_bsdf.h"

#include <array>
#include <vector>

namespace nacre {

class DirectionSampling {
public:
  /// Evaluates the measurement some million times: 0.1 to 2 s.
  explicit DirectionSampling(const MeasuredBsdf& measured);

  /// Density of wi per solid angle, 1/sr; 0 for sides that are not measured. R = float, double or Pack.
  template <class R>
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const;
  /// wi for uniform numbers in [0, 1). R = float or double. A direction of pdf 0 where the side of wo is not
  /// measured; rounding at the horizon can leave wi on the wrong side, where pdf is 0 too.
  template <class R>
  Vec3<R> sample(const Vec3<R>& wo, R u_lobe, const Vec2<R>& u) const;

private:
  /// Nodes of wo: `azimuths` evenly about the normal, one if the data is isotropic, and `thetas` at theta_o =
  /// pi/2 (1 - (1 - n)^2), dense towards grazing. At each, cells bounded by theta = theta_max (i / rows)^2
  /// and evenly spaced v: of |v| where the data is isotropic, else of v. A cell's probability is spread
  /// evenly over theta's solid angle and over v.
  struct Resolution {
    int azimuths, thetas, rows, columns;
    int cells() const { return rows * columns; }
  };
  static constexpr Resolution isotropic{1, 48, 90, 24}, anisotropic{16, 24, 48, 32};

  /// An axis of nodes at a place between two of them.
  template <class R>
  struct Between {
    R node, next, fraction;
  };

  template <class R>
  Between<R> theta_nodes(const R& theta_o) const {
    const R last(static_cast<float>(n_.thetas - 1));
    const R at = (R(1) - safe_sqrt(R(1) - theta_o * constant<R>(2 / pi))) * last;
    const R node = whole_below(at, n_.thetas - 1);
    return {node, node + R(1), at - node};
  }
  template <class R>
  Between<R> azimuth_nodes(const Vec2<R>& azimuth) const {
    if (n_.azimuths == 1) return {R(0), R(0), R(0)};
    const R n(static_cast<float>(n_.azimuths)),
        turns = angle_of(azimuth.y, azimuth.x) * constant<R>(0.5 / pi);
    const R at = (turns - floor(turns)) * n, node = whole_below(at, n_.azimuths);
    return {node, select(node + R(1) < n, R(node + R(1)), R(0)), at - node};
  }
  /// Largest whole number <= x (x >= 0) that is below n; n - 1 for a NaN, which must not become an index.
  template <class R>
  static R whole_below(const R& x, int n) {
    const R last(static_cast<float>(n - 1));
    return select(x < last, floor(x), last);
  }
  /// Densities of an anisotropic surface stay where they are when wo turns by `delta` from their node: where
  /// all azimuths are above the horizon they turn back by delta, else they shift by it at v = 0 and not at
  /// all at the horizon.
  /// @return  how far, in v; and whether round the circle
  template <class R>
  static std::pair<R, mask_t<R>> shift_of(const R& delta, const R& phi_max) {
    const auto round = phi_max > R(3.1415f);
    return {select(round, R(delta * constant<R>(inv_pi)), clamp(R(delta / phi_max), -0.5f, 0.5f)), round};
  }
  /// Which densities serve: the passage, or -1.
  template <class R>
  R passage_of(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto front = wo.z > R(0);
    if (front_only_) return select(front & (wi.z > R(0)), R(0), R(-1));
    const auto stays = select(front, wi.z, R(-wi.z)) > R(0);
    const R index = select(front, R(0), R(2)) + select(stays, R(0), R(1));
    return select((abs(wo.z) > R(0)) & (abs(wi.z) > R(0)), gather(place_.data(), index), R(-1));
  }

  std::size_t node_index(std::size_t passage, int azimuth, int theta) const {
    return (passage * n_.azimuths + azimuth) * n_.thetas + theta;
  }
  /// `n` is n_, known to the compiler: the inner loop of whoever samples tables.
  template <Resolution n, class R>
  R pdf_with(const Vec3<R>& wo, const Vec3<R>& wi) const;
  /// wo at a node or between nodes, on the front.
  Vec3d direction_at(double azimuth, double theta) const;
  void build_azimuth(const MeasuredBsdf& measured, bool from_back, int azimuth);
  void set_cells(std::size_t node, std::span<const double> mass, double total);
  void copy_node(std::size_t from, std::size_t to);
  void choose_cosine_shares(const MeasuredBsdf& measured, bool from_back);

  Resolution n_;
  bool front_only_;                ///< reflection on the front is all there is: nothing to look up
  std::array<float, 4> place_;     ///< [from_back][transmits]: which passage that is, -1: not measured
  std::vector<float> cosine_;      ///< [passage][node]: probability of the cosine lobe
  std::vector<float> lobe_;        ///< [passage][node]: of the cells together
  std::vector<float> probability_; ///< [passage][node][row][column]: of a cell
  std::vector<float> row_cdf_;     ///< [passage][node][row]: share of the cells of this row and those before
  std::vector<float> cell_cdf_;    ///< [passage][node][row][column]: likewise within the row, ends at 1
};

template <DirectionSampling::Resolution n, class R>
R DirectionSampling::pdf_with(const Vec3<R>& wo, const Vec3<R>& wi) const {
  const R passage = passage_of(wo, wi);
  const auto known = passage >= R(0);
  if (!any(known)) return R(0);
  const Vec3<R> o{wo.x, wo.y, abs(wo.z)}, s{wo.x + wi.x, wo.y + wi.y, o.z + abs(wi.z)};
  const HalfVectorChart<R> chart(o);
  const R s_length = max(length(s), R(1e-20f));
  const R theta = angle_of(R(sqrt(s.x * s.x + s.y * s.y)), s.z), theta_max = chart.theta_max();
  const Vec2<R> x = chart.azimuth(o);
  const R across = x.x * s.y - x.y * s.x, along = x.x * s.x + x.y * s.y;
  const auto no_azimuth = (abs(across) + abs(along)) < R(1e-30f);
  const R phi = angle_of(across, R(select(no_azimuth, R(1), along))), phi_max = chart.phi_max(theta);
  const R v = phi / phi_max;

  const R row = whole_below(sqrt(theta / theta_max) * R(static_cast<float>(n.rows)), n.rows);
  const R inv_rows(1 / static_cast<float>(n.rows)), columns(static_cast<float>(n.columns));
  const R lower = theta_max * sqr(row * inv_rows), upper = theta_max * sqr((row + R(1)) * inv_rows);

  const Between<R> thetas = theta_nodes(chart.theta_o), azimuths = azimuth_nodes(x);
  R cosine(0), lobe(0);
  const auto add = [&](const R& azimuth, const R& weight, const R& slope, const R& column) {
    for (int k = 0; k < 2; ++k) {
      // Below 2^24: exact in float.
      const R node = (max(passage, R(0)) * R(static_cast<float>(n.azimuths)) + azimuth) *
                         R(static_cast<float>(n.thetas)) +
                     (k == 0 ? thetas.node : thetas.next);
      const R w = weight * (k == 0 ? R(1) - thetas.fraction : thetas.fraction);
      const R cell = (node * R(static_cast<float>(n.rows)) + row) * columns + column;
      cosine = cosine + w * gather(cosine_.data(), node);
      lobe = lobe + w * slope * gather(probability_.data(), cell);
    }
  };
  if constexpr (n.azimuths == 1) {
    add(R(0), R(1), R(1), whole_below(abs(v) * columns, n.columns));
  } else {
    const R step = constant<R>(2 * pi / n.azimuths);
    for (int k = 0; k < 2; ++k) {
      const auto [shift, round] =
          shift_of(R((k == 0 ? azimuths.fraction : azimuths.fraction - R(1)) * step), phi_max);
      const R turned = v + shift, bent = v + shift * (R(1) - abs(v));
      const R at = select(round, R(turned - R(2) * floor((turned + R(1)) * R(0.5f))), bent);
      const R slope = select(round, R(1), select(v < R(0), R(R(1) + shift), R(R(1) - shift)));
      add(k == 0 ? azimuths.node : azimuths.next, k == 0 ? R(1) - azimuths.fraction : azimuths.fraction,
          slope, whole_below(max(R((at + R(1)) * R(0.5f) * columns), R(0)), n.columns));
    }
  }
  // dwh = 2 d(sin^2(theta/2)) dphi; a cell holds 2 / columns of v's range, or that of both signs; dwh / dwi =
  // 1 / (4 wo.wh) and wo.wh = |wo + wi| / 2.
  const R cell_angle =
      R(4) * half_versine_between(lower, upper) * phi_max * R(1 / static_cast<float>(n.columns));
  return select(known, cosine * abs(wi.z) * constant<R>(inv_pi) + lobe / (cell_angle * R(2) * s_length),
                R(0));
}

template <class R>
R DirectionSampling::pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
  return n_.azimuths == 1 ? pdf_with<isotropic>(wo, wi) : pdf_with<anisotropic>(wo, wi);
}

} // namespace nacre
