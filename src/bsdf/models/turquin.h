#pragma once
// Energy compensation by scaling: single scattering from GGX facets, brightened until nothing is lost to the
// viewer. The cheapest way, without noise, and the lobe keeps its shape; not reciprocal, because the factor
// depends on wo alone: 1 + F0 (1 - E) / E for metals, 1 / E for glass.
// Source: Turquin 2019, Practical Multiple Scattering Compensation for Microfacet Models.

#include "bsdf/models/rough_conductor.h"
#include "bsdf/models/rough_dielectric.h"
#include "optics/ggx_albedo.h"

namespace nacre {

template <class R, int C>
struct TurquinConductor : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color eta, k;
  R alpha;

  static constexpr std::string_view name = "turquin_conductor";
  static constexpr std::string_view source = "Turquin 2019; Walter et al. 2007, eq. 20";
  static constexpr std::string_view summary = "rough metal, GGX facets, scaled by the energy that is lost";
  /// The gain is the error of the albedo table, at grazing angles on the smoothest surfaces.
  static constexpr Laws laws{.reciprocal = false, .energy_gain = 0.009};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&TurquinConductor::eta, "eta", "1", 0.01, 20, 1.0, "real part of the complex index"},
        Parameter{&TurquinConductor::k, "k", "1", 0, 30, 6.0, "imaginary part of the index, absorption"},
        Parameter{&TurquinConductor::alpha, "alpha", "1", 1e-3, 1, 0.5, "roughness"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R E = GgxAlbedo::table().perfect(R(max(wo.z, R(0))), alpha), missing = (R(1) - E) / E;
    const Color scale = zip(eta, k, [&](const R& n, const R& kappa) {
      return R(R(1) + fresnel_conductor(R(1), n, kappa) * missing);
    });
    return scale * single().eval(wo, wi);
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const { return single().pdf(wo, wi); }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& /*u_lobe*/, const Vec2<R>& u) const {
    const Vec3<R> wi = reflect(wo, Ggx<R>{alpha, alpha}.sample_visible(wo, u));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

  /// The microsurface, for the validator and plots.
  Ggx<R> distribution() const { return {alpha, alpha}; }

private:
  GgxConductor<R, C> single() const { return {{}, eta, k, alpha, alpha, Color(R(1)), R(0)}; }
};

template <class R, int C>
struct TurquinDielectric : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  R eta, alpha;

  static constexpr std::string_view name = "turquin_dielectric";
  static constexpr std::string_view source = "Turquin 2019; Walter et al. 2007, eq. 20, 21";
  static constexpr std::string_view summary = "ground glass, GGX facets, scaled by the energy that is lost";
  /// The gain is the error of the albedo table, largest beside the critical angle of smooth glass.
  static constexpr Laws laws{.reciprocal = false, .transmits = true, .energy_gain = 0.05};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&TurquinDielectric::eta, "eta", "1", 0.25, 4, 1.5, "index inside / index outside"},
        Parameter{&TurquinDielectric::alpha, "alpha", "1", 1e-3, 1, 0.5, "roughness"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const { return single().eval(wo, wi) * scale(wo); }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const { return single().pdf(wo, wi); }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    auto s = single().sample(wo, u_lobe, u);
    s.f = select(s.is_delta, s.f, s.f * scale(wo));
    return s;
  }

private:
  GgxDielectric<R, C> single() const { return {{}, eta, alpha, alpha, Color(R(1)), Color(R(1)), R(0)}; }
  R scale(const Vec3<R>& wo) const {
    const R c = min(abs(wo.z), R(1)), eta_ti = select(wo.z < R(0), R(1) / eta, eta);
    const auto& table = GgxAlbedo::table();
    const R E =
        table.dielectric_reflection(c, alpha, eta_ti) + table.dielectric_transmission(c, alpha, eta_ti);
    return R(1) / max(E, R(1e-3f));
  }
};

} // namespace nacre
