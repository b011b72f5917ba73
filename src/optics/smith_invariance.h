#pragma once
// All bounces among GGX mirror facets without noise: the rough surface as a half-space of facets, solved once
// by the principle of invariance.

#include "core/dual.h"
#include "core/pack.h"
#include "core/vec.h"

#include <array>
#include <vector>

namespace nacre {

/// Light after two and more bounces among perfect mirrors, f cos_o cos_i (1 + Lambda_o + Lambda_i), symmetric
/// in wo and wi.
template <class R>
struct LaterBounces {
  R second; ///< of the second bounce alone
  R third;  ///< of the third alone
  R all;    ///< of all after the first

  /// For facets that reflect less: the share `twice` at the first two bounces together, `rho` at each further
  /// one; the orders from the third on taken as a geometric series.
  R with_reflectance(const R& twice, const R& rho) const {
    const R rest = max(all - second, third), first = min(third, rest);
    const R falling = R(1) - first / max(rest, R(1e-20f)); // each order to the one before
    return twice * (second + rho * first / (R(1) - rho * falling + R(1e-6f)));
  }
};

/// Smith's surface is a half-space of facets in the depth e = -log C1(h) (see optics/smith_walk.h): a ray
/// going down meets 1 + Lambda of them per unit, one going up Lambda. Adding a thin layer on top changes
/// nothing (Ambartsumian 1943), so with T = f cos_o cos_i of mirror facets
///   (1 + Lambda_i + Lambda_o) T(i, o) = D(i + o) / 4 + int T(d, o) D(i - d) / (4 cos_d) dd
///                                                    + int T(i, d) D(o - d) / (4 cos_d) dd,
/// D at the normalised vector, d over the directions above the surface where that vector points upwards. A
/// facet can but lift a ray, so cos_d < cos_i in the first integral, < cos_o in the second, and the equation
/// is solved by one march in cosines, a Fourier mode in azimuth at a time. The invariance principle for
/// Smith's surfaces: Bitterli and d'Eon 2022, A Position-Free Path Integral for Homogeneous Slabs and
/// Multiple Scattering on Smith Microfacets; Cui et al. 2023, Multiple-Bounce Smith Microfacet BRDFs using
/// the Invariance Principle.
class SmithInvariance {
public:
  static constexpr int n_alpha = 17, n_cos = 25, n_phi = 17;

  /// Made on first use.
  static const SmithInvariance& table();

  /// Interpolated linearly in sqrt(alpha), sqrt(cos) and azimuth, then balanced: factors of wo and of wi see
  /// to it that with the first bounce white facets return all light, between the table's nodes too.
  /// @param wo, wi  above the surface; alpha in [0, 1], isotropic
  template <class R>
  LaterBounces<R> later_bounces(const Vec3<R>& wo, const Vec3<R>& wi, const R& alpha) const {
    const LaterBounces<R> raw =
        interpolate(wo, wi, alpha, R(azimuth(wo, wi) * constant<R>((n_phi - 1) * inv_pi)));
    const R factor = balance(wo, alpha) * balance(wi, alpha);
    return {raw.second * factor, raw.third * factor, raw.all * factor};
  }

private:
  static constexpr int n_balance_alpha = 49, n_balance_cos = 49;

  SmithInvariance();
  void solve();
  void balance();

  template <class R>
  struct Axis {
    value_t<R> index; ///< whole number, at most n - 2
    R fraction;       ///< in [0, 1]
  };
  template <class R>
  static Axis<R> axis(const R& x, int n) { // x >= 0
    // Not clamp: at the upper end of its domain a parameter keeps its derivative from inside.
    return cell(R(select(x > R(1.000001f), R(1), x) * R(float(n - 1))), n);
  }
  template <class R>
  static Axis<R> cell(const R& scaled, int n) {
    const value_t<R> index = min(floor(value(scaled)), value_t<R>(float(n - 2)));
    return {index, scaled - R(index)};
  }
  /// Between wo and wi in the plane of the surface, in [0, pi].
  template <class R>
  static R azimuth(const Vec3<R>& wo, const Vec3<R>& wi) {
    const R x = wo.x * wi.x + wo.y * wi.y, y = abs(wo.x * wi.y - wo.y * wi.x);
    const auto defined = abs(x) + y > R(1e-12f);
    return abs(atan2(select(defined, y, R(0)), select(defined, x, R(1))));
  }

  /// @param p  azimuth in nodes
  template <class R>
  LaterBounces<R> interpolate(const Vec3<R>& wo, const Vec3<R>& wi, const R& alpha,
                              const std::type_identity_t<R>& p) const {
    const R root_o = safe_sqrt(wo.z), root_i = safe_sqrt(wi.z);
    const Axis<R> axes[] = {axis<R>(safe_sqrt(alpha), n_alpha), axis<R>(root_o, n_cos),
                            axis<R>(root_i, n_cos), cell<R>(p, n_phi)};
    constexpr float stride[] = {float(n_cos * n_cos * n_phi), float(n_cos * n_phi), float(n_phi), 1};
    LaterBounces<R> sum{R(0), R(0), R(0)};
    for (int corner = 0; corner < 16; ++corner) {
      R weight = root_o * root_i; // of which the nodes are shares
      value_t<R> at(0);
      for (int k = 0; k < 4; ++k) {
        const bool upper = corner >> k & 1;
        weight = weight * (upper ? axes[k].fraction : R(R(1) - axes[k].fraction));
        at = at + (upper ? axes[k].index + value_t<R>(1) : axes[k].index) * value_t<R>(stride[k]);
      }
      sum.second = sum.second + weight * R(gather(orders_[0].data(), at));
      sum.third = sum.third + weight * R(gather(orders_[1].data(), at));
      sum.all = sum.all + weight * R(gather(orders_[2].data(), at));
    }
    return sum;
  }
  template <class R>
  R balance(const Vec3<R>& w, const R& alpha) const {
    const Axis<R> a = axis<R>(safe_sqrt(alpha), n_balance_alpha), c = axis<R>(safe_sqrt(w.z), n_balance_cos);
    const auto along_cos = [&](const value_t<R>& row) {
      const auto at = row * value_t<R>(float(n_balance_cos)) + c.index;
      const R low = R(gather(balance_.data(), at)), high = R(gather(balance_.data(), at + value_t<R>(1)));
      return R(low + c.fraction * (high - low));
    };
    const R low = along_cos(a.index), high = along_cos(a.index + value_t<R>(1));
    return low + a.fraction * (high - low);
  }

  std::array<std::vector<float>, 3> orders_; ///< second, third, all; over alpha, cos_o, cos_i, azimuth
  std::vector<float> balance_;               ///< over alpha, cos
};

} // namespace nacre
