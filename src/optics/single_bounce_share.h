#pragma once
// How much of the light that meets a rough surface leaves it at the first bounce: what a random walk's
// sampling density must know to be normalised.

#include "core/dual.h"
#include "core/pack.h"
#include "optics/microfacet.h"

#include <vector>

namespace nacre {

template <class R>
struct BounceShare {
  R reflected, transmitted;
};

/// Tables for Smith surfaces, Ggx or Beckmann, on first use: perfect mirrors over (cos, alpha), dielectrics
/// over (cos, alpha, eta), linear in sqrt(cos), sqrt(alpha), (eta - 1) / (eta + 1). Coarser than GgxAlbedo,
/// errors up to 0.02, and made in a quarter of a second. For anisotropic facets ask with sqrt(alpha_x
/// alpha_y).
class SingleBounceShare {
public:
  static constexpr int n_cos = 20, n_alpha = 14, n_eta = 21;
  static constexpr double eta_max = 4;

  template <template <class> class Distribution>
  static const SingleBounceShare& table();

  /// @param cos_theta, alpha in [0, 1]
  template <class R>
  R mirror(const R& cos_theta, const R& alpha) const {
    return bilinear(mirror_, axis<R>(safe_sqrt(alpha), n_alpha), axis<R>(safe_sqrt(cos_theta), n_cos),
                    value_t<R>(0));
  }
  /// @param eta  index behind the surface / index before it, in [1 / eta_max, eta_max], else clamped
  template <class R>
  BounceShare<R> dielectric(const R& cos_theta, const R& alpha, const R& eta) const {
    constexpr double limit = (eta_max - 1) / (eta_max + 1);
    const Axis<R> c = axis<R>(safe_sqrt(cos_theta), n_cos), a = axis<R>(safe_sqrt(alpha), n_alpha),
                  e = axis<R>(R(0.5f) + constant<R>(0.5 / limit) * (eta - R(1)) / (eta + R(1)), n_eta);
    const auto slice = value_t<R>(float(n_alpha * n_cos)), at = e.index * slice;
    const auto from = [&](const std::vector<float>& t) {
      return mix(bilinear(t, a, c, at), bilinear(t, a, c, value_t<R>(at + slice)), e.fraction);
    };
    return {from(reflected_), from(transmitted_)};
  }

private:
  template <class R>
  struct Axis {
    value_t<R> index; ///< whole number, at most n - 2
    R fraction;       ///< in [0, 1]
  };
  template <class R>
  static Axis<R> axis(const R& x, int n) {
    // Not clamp: at the upper end of its domain a parameter keeps its derivative from inside.
    const R bounded = select(x > R(1.000001f), R(1), select(x < R(0), R(0), x)) * R(float(n - 1));
    const value_t<R> index = min(floor(value(bounded)), value_t<R>(float(n - 2)));
    return {index, bounded - R(index)};
  }
  template <class R>
  static R mix(const R& a, const R& b, const R& t) {
    return a + t * (b - a);
  }
  template <class R>
  static R bilinear(const std::vector<float>& table, const Axis<R>& a, const Axis<R>& c,
                    const value_t<R>& offset) {
    const auto row = [&](const value_t<R>& at) {
      return mix(R(gather(table.data(), at)), R(gather(table.data(), at + value_t<R>(1))), c.fraction);
    };
    const auto n = value_t<R>(float(n_cos)), at = offset + a.index * n + c.index;
    return mix(row(at), row(at + n), a.fraction);
  }

  template <template <class> class Distribution>
  static SingleBounceShare compute();

  std::vector<float> mirror_, reflected_, transmitted_;
};

} // namespace nacre
