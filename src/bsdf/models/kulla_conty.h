#pragma once
// Energy compensation by tables: what single scattering from GGX facets loses comes back as a diffuse lobe in
// proportion to what both directions lose. Reciprocal; white facets lose nothing, and no noise; the lobe's
// shape is not that of real later bounces, which favour the mirror direction
// (docs/models/multiple-bounces.md). Source: Kulla and Conty 2017, Revisiting Physically Based Shading at
// Imageworks, after Kelemen and Szirmay-Kalos 2001; colour: Hill 2018's F_avg^2 form of the
// geometric series of bounces.

#include "bsdf/models/rough_conductor.h"
#include "bsdf/models/rough_dielectric.h"
#include "core/warp.h"
#include "optics/ggx_albedo.h"

namespace nacre {

template <class R, int C>
struct KullaContyConductor : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color eta, k;
  R alpha;

  static constexpr std::string_view name = "kulla_conty_conductor";
  static constexpr std::string_view source = "Kulla and Conty 2017; Walter et al. 2007, eq. 20";
  static constexpr std::string_view summary =
      "rough metal, GGX facets, lost energy returned as a diffuse lobe";
  /// The gain is the error of the albedo table, at grazing angles on the smoothest surfaces.
  static constexpr Laws laws{.energy_gain = 0.009};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&KullaContyConductor::eta, "eta", "1", 0.01, 20, 1.0, "real part of the complex index"},
        Parameter{&KullaContyConductor::k, "k", "1", 0, 30, 6.0, "imaginary part of the index, absorption"},
        Parameter{&KullaContyConductor::alpha, "alpha", "1", 1e-3, 1, 0.5, "roughness"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R kept = GgxAlbedo::table().reflector_average(alpha).one, lost = max(R(1) - kept, R(1e-6f));
    const R lobe = this->lost(wo) * this->lost(wi) / lost * constant<R>(inv_pi);
    // Each bounce multiplies by F_avg; 1 - kept of the light goes on to another.
    const Color tint = zip(eta, k, [&](const R& n, const R& kappa) {
      const R F = fresnel_conductor_average(n, kappa);
      return R(F * F * kept / (R(1) - F * lost));
    });
    return single().eval(wo, wi) + select(same_upper_side(wo, wi), tint * lobe, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R p = lost(wo), diffuse = select(same_upper_side(wo, wi), wi.z * constant<R>(inv_pi), R(0));
    return (R(1) - p) * single().pdf(wo, wi) + p * diffuse;
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const Vec3<R> mirrored = reflect(wo, Ggx<R>{alpha, alpha}.sample_visible(wo, u));
    const Vec3<R> wi = select(u_lobe < lost(wo), square_to_cosine_hemisphere(u), mirrored);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

  /// The microsurface, for the validator and plots.
  Ggx<R> distribution() const { return {alpha, alpha}; }

private:
  GgxConductor<R, C> single() const { return {{}, eta, k, alpha, alpha, Color(R(1)), R(0)}; }
  R lost(const Vec3<R>& w) const {
    return max(R(1) - GgxAlbedo::table().perfect(R(max(w.z, R(0))), alpha), R(0));
  }
};

/// Reflects and transmits. What is lost on one side of the surface returns on both; the shares follow from
/// average Fresnel transmittance as far as reciprocity allows.
template <class R, int C>
struct KullaContyDielectric : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  R eta, alpha;

  static constexpr std::string_view name = "kulla_conty_dielectric";
  static constexpr std::string_view source = "Kulla and Conty 2017; Walter et al. 2007, eq. 20, 21";
  static constexpr std::string_view summary =
      "ground glass, GGX facets, lost energy returned as diffuse lobes";
  /// The gain is the error of the albedo table, largest beside the critical angle of smooth glass.
  static constexpr Laws laws{.transmits = true, .energy_gain = 0.05};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&KullaContyDielectric::eta, "eta", "1", 0.25, 4, 1.5, "index inside / index outside"},
        Parameter{&KullaContyDielectric::alpha, "alpha", "1", 1e-3, 1, 0.5, "roughness"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R eta_ti = select(wo.z < R(0), R(1) / eta, eta);
    const Shares s = shares(eta_ti);
    const auto valid = scatters(wo, wi);
    const R reflected = (R(1) - s.through) * lost(wi, eta_ti) / s.lost_here;
    const R transmitted = s.through * lost(wi, R(R(1) / eta_ti)) / (s.lost_there * sqr(eta_ti));
    const R lobe =
        lost(wo, eta_ti) * constant<R>(inv_pi) * select(wo.z * wi.z > R(0), reflected, transmitted);
    return single().eval(wo, wi) + Color(select(valid, lobe, R(0)));
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R eta_ti = select(wo.z < R(0), R(1) / eta, eta), p = lost(wo, eta_ti);
    const R through = shares(eta_ti).through;
    const R side = select(wo.z * wi.z > R(0), R(R(1) - through), through);
    const R diffuse = select(scatters(wo, wi), side * abs(wi.z) * constant<R>(inv_pi), R(0));
    return (R(1) - p) * single().pdf(wo, wi) + p * diffuse;
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const R eta_ti = select(wo.z < R(0), R(1) / eta, eta), p = lost(wo, eta_ti);
    const auto diffuse = (u_lobe < p) & !no_interface();
    const R rest = clamp(R((u_lobe - p) / max(R(1) - p, R(1e-6f))), R(0), R(0.99999994f));
    const auto one = single().sample(wo, select(no_interface(), u_lobe, rest), u);
    const R up = select(wo.z < R(0), R(-1), R(1));
    const R side = select(u_lobe < p * shares(eta_ti).through, R(-up), up);
    const Vec3<R> d = square_to_cosine_hemisphere(u),
                  wi = select(diffuse, Vec3<R>{d.x, d.y, d.z * side}, one.wi);
    const auto delta = one.is_delta;
    // A refracted or mirrored ray on the wrong side is no sample of that lobe.
    const auto failed = (!diffuse) & !(one.pdf > R(0));
    return {wi, select(delta, one.f, select(failed, Color(), eval(wo, wi))),
            select(delta, one.pdf, select(failed, R(0), pdf(wo, wi))), delta};
  }

private:
  mask_t<R> no_interface() const { return abs(eta - R(1)) < R(1e-5f); }
  mask_t<R> scatters(const Vec3<R>& wo, const Vec3<R>& wi) const {
    return (wo.z != R(0)) & (wi.z != R(0)) & !no_interface();
  }
  GgxDielectric<R, C> single() const { return {{}, eta, alpha, alpha, Color(R(1)), Color(R(1)), R(0)}; }
  R lost(const Vec3<R>& w, const R& eta_ti) const {
    const R c = min(abs(w.z), R(1));
    const auto& table = GgxAlbedo::table();
    return clamp(R(R(1) - table.dielectric_reflection(c, alpha, eta_ti) -
                   table.dielectric_transmission(c, alpha, eta_ti)),
                 R(0), R(1));
  }
  R lost_average(const R& eta_ti) const {
    const auto& table = GgxAlbedo::table();
    return max(R(1) - table.dielectric_reflection_average(alpha, eta_ti) -
                   table.dielectric_transmission_average(alpha, eta_ti),
               R(1e-6f));
  }
  struct Shares {
    R lost_here, lost_there; ///< of diffuse light, on wo's side and on the other
    R through;               ///< of what is lost on wo's side, the part that returns on the other
  };
  /// f / eta_o^2 is symmetric if through / (eta_ti^2 lost_there) is the same seen from both sides: average
  /// Fresnel transmittance, for which T_o = eta_ti^2 T_i, times lost_there, scaled so that no share exceeds
  /// T.
  Shares shares(const R& eta_ti) const {
    const R here = lost_average(eta_ti), there = lost_average(R(R(1) / eta_ti));
    const auto rarer = eta_ti > R(1);
    const R n = select(rarer, eta_ti, R(1) / eta_ti);
    const R into_denser =
        R(1) - fresnel_average<R>([&](const R& mu) { return fresnel_dielectric(mu, n).reflectance; });
    const R T = select(rarer, into_denser, into_denser / sqr(n));
    return {here, there, T * there / max(here, there)};
  }
};

} // namespace nacre
