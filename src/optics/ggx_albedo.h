#pragma once
// Directional albedos of GGX surfaces, single scattering: what layers over a rough coat, energy compensation
// and the choice among lobes need to know.

#include "core/dual.h"
#include "core/pack.h"
#include "optics/microfacet.h"

#include <array>
#include <vector>

namespace nacre {

/// Directional albedo, or its hemispherical average, of a reflector whose Fresnel term is
/// F(c) = 1, (1 - c)^5 and c (1 - c)^6, c = wo . wm: by linearity that of any Schlick (parts one and five)
/// and of Hoffman's F82-tint term (all three).
template <class R>
struct FresnelParts {
  R one, five, six;

  /// With F(c) = f0 + (f90 - f0) (1 - c)^5, Schlick 1994, eq. 15.
  R schlick(const R& f0, const R& f90) const { return f0 * (one - five) + f90 * five; }
};

/// Tables by quadrature, on first use: isotropic GGX with height-correlated masking and shadowing in
/// reflection (Heitz 2014, eq. 99) and the product of both G1 in transmission, like ggx_conductor and
/// ggx_dielectric with separable = 0. Linear between nodes in sqrt(cos), sqrt(alpha) and (eta - 1) / (eta +
/// 1). For anisotropic facets ask with alpha = sqrt(alpha_x alpha_y).
///
/// Errors against quadrature over half vectors, of reflectors and of reflection with eta >= 1 (test): 6e-4 on
/// average over grazing and smooth surfaces too; at most 2.5e-3 where cos or alpha exceeds 0.2, else 0.012
/// for cos >= 0.02. From inside (eta < 1) up to 0.05 beside the critical angle of smooth glass.
class GgxAlbedo {
public:
  static constexpr int n_cos = 64, n_alpha = 32, n_eta = 49;
  static constexpr double eta_max = 4; ///< eta of the dielectric lies in [1 / eta_max, eta_max], else clamped

  static const GgxAlbedo& table();

  /// Share of light from direction cos_theta that is reflected. cos_theta and alpha in [0, 1].
  template <class R>
  FresnelParts<R> reflector(const R& cos_theta, const R& alpha) const {
    const Axis<R> c = cos_axis(cos_theta), a = alpha_axis(alpha);
    const auto part = [&](int k) { return bilinear(reflector_[std::size_t(k)], n_cos, a, c); };
    return {part(0), part(1), part(2)};
  }
  /// The part `one` alone: E(cos_theta) of a perfect reflector.
  template <class R>
  R perfect(const R& cos_theta, const R& alpha) const {
    return bilinear(reflector_[0], n_cos, alpha_axis(alpha), cos_axis(cos_theta));
  }
  /// 2 int E(c) c dc over [0, 1]: the share of diffuse light that is reflected.
  template <class R>
  FresnelParts<R> reflector_average(const R& alpha) const {
    const Axis<R> a = alpha_axis(alpha);
    const auto part = [&](int k) { return linear(reflector_average_[std::size_t(k)], a); };
    return {part(0), part(1), part(2)};
  }

  /// Share that a dielectric reflects, exact Fresnel. @param eta index behind the surface / index before it
  template <class R>
  R dielectric_reflection(const R& cos_theta, const R& alpha, const R& eta) const {
    return trilinear(reflection_, eta_axis(eta), alpha_axis(alpha), cos_axis(cos_theta));
  }
  /// Share that a dielectric lets through. With reflection, what is missing to 1 needs further bounces.
  template <class R>
  R dielectric_transmission(const R& cos_theta, const R& alpha, const R& eta) const {
    return trilinear(transmission_, eta_axis(eta), alpha_axis(alpha), cos_axis(cos_theta));
  }
  template <class R>
  R dielectric_reflection_average(const R& alpha, const R& eta) const {
    return bilinear(reflection_average_, n_alpha, eta_axis(eta), alpha_axis(alpha));
  }
  template <class R>
  R dielectric_transmission_average(const R& alpha, const R& eta) const {
    return bilinear(transmission_average_, n_alpha, eta_axis(eta), alpha_axis(alpha));
  }

private:
  GgxAlbedo();

  template <class R>
  struct Axis {
    value_t<R> index; ///< whole number, at most n - 2
    R fraction;       ///< in [0, 1]
  };
  template <class R>
  static Axis<R> axis(const R& x, int n) {
    // Not clamp: on the bounds of its domain a parameter keeps its derivative from inside.
    const R bounded = select(x > R(1.000001f), R(1), select(x < R(-1e-6f), R(0), x));
    const R scaled = bounded * R(float(n - 1));
    const value_t<R> last(float(n - 2)), zero(0.0f);
    const value_t<R> index = max(min(floor(value(scaled)), last), zero);
    return {index, scaled - R(index)};
  }
  template <class R>
  static Axis<R> cos_axis(const R& cos_theta) {
    return axis<R>(safe_sqrt(cos_theta), n_cos);
  }
  template <class R>
  static Axis<R> alpha_axis(const R& alpha) {
    return axis<R>(safe_sqrt(alpha), n_alpha);
  }
  template <class R>
  static Axis<R> eta_axis(const R& eta) {
    constexpr double limit = (eta_max - 1) / (eta_max + 1);
    const R x = constant<R>(1 / limit) * (eta - R(1)) / (eta + R(1)), t = safe_sqrt(abs(x));
    return axis<R>(R(0.5f) + R(0.5f) * select(x < R(0), -t, t), n_eta);
  }

  template <class R>
  static R mix(const R& a, const R& b, const R& t) {
    return a + t * (b - a);
  }
  template <class R>
  static R linear(const std::vector<float>& table, const Axis<R>& x,
                  const value_t<R>& offset = value_t<R>(0)) {
    const value_t<R> at = offset + x.index;
    return mix(R(gather(table.data(), at)), R(gather(table.data(), at + value_t<R>(1))), x.fraction);
  }
  /// Rows of length n along the inner axis.
  template <class R>
  static R bilinear(const std::vector<float>& table, int n, const Axis<R>& outer, const Axis<R>& inner,
                    const value_t<R>& offset = value_t<R>(0)) {
    const value_t<R> row = offset + outer.index * value_t<R>(float(n));
    return mix(linear(table, inner, row), linear(table, inner, row + value_t<R>(float(n))), outer.fraction);
  }
  template <class R>
  static R trilinear(const std::vector<float>& table, const Axis<R>& eta, const Axis<R>& alpha,
                     const Axis<R>& cos) {
    const value_t<R> slice(float(n_alpha * n_cos)), at = eta.index * slice;
    return mix(bilinear(table, n_cos, alpha, cos, at), bilinear(table, n_cos, alpha, cos, at + slice),
               eta.fraction);
  }

  std::array<std::vector<float>, 3> reflector_, reflector_average_;
  std::vector<float> reflection_, transmission_, reflection_average_, transmission_average_;
};

} // namespace nacre
