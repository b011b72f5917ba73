#pragma once
// All orders of scattering in a deep medium of isotropic scatterers, exactly: thick fog, snow, milk under an
// index of 1. Reciprocal; keeps all energy at albedo 1. Source: Chandrasekhar 1960, Radiative Transfer,
// chapter IV; H by the integral of Fock 1944, as in Stibbs and Weir 1959.

#include "bsdf/hemisphere_lobes.h"
#include "bsdf/model.h"
#include "core/quadrature.h"

namespace nacre {

/// Chandrasekhar's H(mu) for isotropic scattering of single-scattering albedo c in [0, 1] and mu in (0, 1]:
/// ln H = -1/pi integral over psi in (0, pi/2) of ln(1 - c x cot x), tan x = tan(psi) / mu. Relative error
/// below 1e-5 (test).
/// Source: Stibbs and Weir 1959, On the H-functions for Isotropic Scattering, eq. 8, with psi in place of x
/// as variable, which takes the peak at small mu out of the integrand.
template <class R, int C>
Spectrum<R, C> chandrasekhar_h(const R& mu, const Spectrum<R, C>& c) {
  constexpr int n = 16;
  struct Node {
    double tangent, weight;
  };
  // psi = pi/2 t^3 gathers the nodes where the logarithm varies
  static const std::array<Node, n> nodes = [] {
    std::array<Node, n> a;
    const QuadratureRule rule = gauss_legendre(n, 0, 1);
    for (std::size_t i = 0; i < n; ++i) {
      const double t = rule.node[i];
      a[i] = {std::tan(pi / 2 * t * t * t), -1.5 * t * t * rule.weight[i]};
    }
    return a;
  }();
  Spectrum<R, C> ln;
  for (const Node& node : nodes) {
    const R tan_x = constant<R>(node.tangent) / mu;
    const auto small = tan_x < R(0.1f); // where 1 - x cot x needs its series
    const R safe = select(small, R(1), tan_x), t2 = tan_x * tan_x;
    const R left = select(small, t2 * (constant<R>(1.0 / 3) - t2 * (R(0.2f) - t2 * constant<R>(1.0 / 7))),
                          R(R(1) - atan(safe) / safe)); // 1 - x cot x
    ln = ln +
         c.map([&](const R& a) { return R(constant<R>(node.weight) * log(max(R(1) - a, R(0)) + a * left)); });
  }
  return ln.map([](const R& x) { return R(exp(x)); });
}

template <class R, int C>
struct Chandrasekhar : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color albedo;

  static constexpr std::string_view name = "chandrasekhar";
  static constexpr std::string_view source = "Chandrasekhar 1960, Radiative Transfer, chapter IV";
  static constexpr std::string_view summary = "multiple scattering in a deep isotropic medium, exact";
  static constexpr auto parameters() {
    return std::tuple{Parameter{&Chandrasekhar::albedo, "albedo", "1", 0, 1, 0.9,
                                "share of light scattered per collision"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    // Below 1e-6 H is 1 to 1e-5, and the tangents stay within float.
    const R o = max(select(up, wo.z, R(1)), R(1e-6f)), i = max(select(up, wi.z, R(1)), R(1e-6f));
    const Color h = chandrasekhar_h(o, albedo) * chandrasekhar_h(i, albedo);
    return select(up, albedo * h * (constant<R>(0.25 * inv_pi) / select(up, wo.z + wi.z, R(1))), Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return select(same_upper_side(wo, wi), diffusing_lobe(wo).pdf(wi), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = diffusing_lobe(wo).sample(u);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }
};

} // namespace nacre
