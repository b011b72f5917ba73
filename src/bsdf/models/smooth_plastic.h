#pragma once
// A polished clear coat over a diffuse base: glossy paint, glazed ceramic, plastic. Mirror reflection
// outside; below, all orders of bounces between the Lambertian base and the underside of the coat. Keeps all
// laws. Source: Saunderson 1942, Calculation of the Color of Pigmented Plastics; the angular form as in
// Ashikhmin et al. and Mitsuba's `plastic`: (1 - F_i)(1 - F_o) / eta^2 for the two passages of the interface.

#include "bsdf/model.h"
#include "core/warp.h"
#include "optics/fresnel.h"

namespace nacre {

template <class R, int C>
struct SmoothPlastic : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color diffuse_reflectance, specular_reflectance;
  R eta, nonlinear;

  static constexpr std::string_view name = "smooth_plastic";
  static constexpr std::string_view source = "Saunderson 1942";
  static constexpr std::string_view summary = "polished clear coat over a diffuse base";
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&SmoothPlastic::diffuse_reflectance, "diffuse_reflectance", "1", 0, 1, 0.5,
                  "albedo of the base"},
        Parameter{&SmoothPlastic::specular_reflectance, "specular_reflectance", "1", 0, 1, 1.0,
                  "factor on the mirror reflection; 1 is physical", false},
        Parameter{&SmoothPlastic::eta, "eta", "1", 1.05, 2.5, 1.5, "index of the coat / index outside"},
        Parameter{&SmoothPlastic::nonlinear, "nonlinear", "1", 0, 1, 1.0,
                  "1: base colour saturates by bounces below the coat, 0: their colour shift is left out",
                  false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto up = same_upper_side(wo, wi);
    const R transmitted = (R(1) - fresnel(wo)) * (R(1) - fresnel(wi));
    return select(up, base() * (transmitted * constant<R>(inv_pi)), Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R diffuse = (R(1) - specular_probability(wo)) * wi.z * constant<R>(inv_pi);
    return select(same_upper_side(wo, wi), diffuse, R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const auto up = wo.z > R(0);
    const R p = specular_probability(wo);
    const auto mirror = u_lobe < p;
    const Vec3<R> wi = select(mirror, Vec3<R>{-wo.x, -wo.y, wo.z}, square_to_cosine_hemisphere(u));
    const Color f =
        select(mirror, specular_reflectance * (fresnel(wo) / select(up, wo.z, R(1))), eval(wo, wi));
    return {wi, select(up, f, Color()), select(up, select(mirror, p, pdf(wo, wi)), R(0)), mirror};
  }

private:
  R fresnel(const Vec3<R>& w) const { return fresnel_dielectric(w.z, eta).reflectance; }
  /// Albedo of the base as seen from outside, without the two passages.
  Color base() const {
    const R inside = fresnel_dielectric_average_inside(eta), inv_eta2 = R(1) / (eta * eta);
    return diffuse_reflectance.map(
        [&](const R& d) { return R(d * inv_eta2 / (R(1) - inside * (R(1) + nonlinear * (d - R(1))))); });
  }
  R specular_probability(const Vec3<R>& wo) const {
    const R F = fresnel(wo), specular = F * average(specular_reflectance);
    const R diffuse = (R(1) - F) * average(diffuse_reflectance);
    return specular / max(specular + diffuse, R(1e-6f));
  }
};

} // namespace nacre
