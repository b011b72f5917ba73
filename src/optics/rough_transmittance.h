#pragma once
// Share of light that passes a rough dielectric interface, single scattering: what a coat lets through to its
// base.

#include "core/dual.h"
#include "core/pack_table.h"
#include "optics/microfacet.h"

#include <array>
#include <type_traits>
#include <vector>

namespace nacre {

/// A table over (cos theta, alpha, eta) of the directional albedo of transmission, from outside, and over
/// (alpha, eta) of the diffuse reflectance from inside, both single scattering: together with reflection they
/// fall short of 1 by what further bounces would carry. Trilinear; nodes in sqrt(cos), sqrt(alpha) and
/// sqrt(eta - eta_lo).
/// Made by quadrature on first use. Errors of quadrature and interpolation together (test): outside 0.002 on
/// average and below 0.015 for cos theta > 0.05, up to 0.04 nearer to grazing at small alpha; inside below
/// 0.008.
class RoughTransmittance {
public:
  static constexpr int n_cos = 32, n_alpha = 12, n_eta = 16;
  static constexpr double eta_lo = 1.05, eta_hi = 2.5;

  /// The table of a distribution: Ggx or Beckmann.
  template <template <class> class Distribution>
  static const RoughTransmittance& table();

  /// @param cos_theta in [0, 1], alpha in [0, 1], eta in [eta_lo, eta_hi] (clamped)
  template <class R>
  R outside(const R& cos_theta, const R& alpha, const R& eta) const {
    const Axis<R> c = axis<R>(safe_sqrt(cos_theta), n_cos), a = axis<R>(safe_sqrt(alpha), n_alpha),
                  e = eta_axis(eta);
    const auto along_cos = [&](const value_t<R>& ia, const value_t<R>& ie) {
      const value_t<R> row = (ie * value_t<R>(float(n_alpha)) + ia) * value_t<R>(float(n_cos)) + c.index;
      return mix(R(gather(outside_.data(), row)), R(gather(outside_.data(), row + value_t<R>(1))),
                 c.fraction);
    };
    if constexpr (std::is_same_v<R, Pack>)
      if (uniform(alpha) && uniform(eta)) return along_blended_row(c, a, e);
    const value_t<R> one(1);
    return mix(mix(along_cos(a.index, e.index), along_cos(a.index + one, e.index), a.fraction),
               mix(along_cos(a.index, e.index + one), along_cos(a.index + one, e.index + one), a.fraction),
               e.fraction);
  }
  /// Reflectance from inside for diffuse light, hemispherical average.
  template <class R>
  R diffuse_reflectance_inside(const R& alpha, const R& eta) const {
    const Axis<R> a = axis<R>(safe_sqrt(alpha), n_alpha), e = eta_axis(eta);
    const auto at = [&](const value_t<R>& ia, const value_t<R>& ie) {
      if constexpr (std::is_same_v<R, Pack>)
        if (uniform(alpha) && uniform(eta))
          return Pack(inside_[std::size_t(lane(ie, 0)) * n_alpha + std::size_t(lane(ia, 0))]);
      return R(gather(inside_.data(), ie * value_t<R>(float(n_alpha)) + ia));
    };
    const value_t<R> one(1);
    return mix(mix(at(a.index, e.index), at(a.index + one, e.index), a.fraction),
               mix(at(a.index, e.index + one), at(a.index + one, e.index + one), a.fraction), e.fraction);
  }

private:
  template <class R>
  struct Axis {
    value_t<R> index; ///< whole number, at most n - 2
    R fraction;       ///< in [0, 1]
  };
  template <class R>
  static Axis<R> axis(const R& x, int n) { // x >= 0
    // Not clamp: at the upper end of its domain a parameter keeps its derivative from inside.
    const R scaled = select(x > R(1.000001f), R(1), x) * R(float(n - 1));
    const value_t<R> index = min(floor(value(scaled)), value_t<R>(float(n - 2)));
    return {index, scaled - R(index)};
  }
  template <class R>
  static Axis<R> eta_axis(const R& eta) {
    return axis<R>(safe_sqrt((eta - R(float(eta_lo))) * R(float(1 / (eta_hi - eta_lo)))), n_eta);
  }
  static bool uniform(const Pack& x) { return all(x == Pack(lane(x, 0))); }
  /// One interface for all lanes, as a plot or fit has it: its row over cos theta is blended first, which
  /// leaves two values to fetch instead of eight.
  Pack along_blended_row(const Axis<Pack>& c, const Axis<Pack>& a, const Axis<Pack>& e) const {
    const float* row =
        &outside_[(std::size_t(lane(e.index, 0)) * n_alpha + std::size_t(lane(a.index, 0))) * n_cos];
    static_assert(n_cos % pack_width == 0);
    std::array<Pack, n_cos / pack_width> blended;
    for (std::size_t k = 0; k < blended.size(); ++k) {
      const auto along_alpha = [&](const float* r) {
        return mix(load(r + k * pack_width), load(r + n_cos + k * pack_width), a.fraction);
      };
      blended[k] = mix(along_alpha(row), along_alpha(row + n_alpha * n_cos), e.fraction);
    }
    return mix(lookup(blended, c.index), lookup(blended, c.index + Pack(1)), c.fraction);
  }
  template <class R>
  static R mix(const R& a, const R& b, const R& t) {
    return a + t * (b - a);
  }

  template <template <class> class Distribution>
  static RoughTransmittance compute();

  std::vector<float> outside_, inside_;
};

} // namespace nacre
