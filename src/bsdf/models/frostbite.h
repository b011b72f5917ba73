#pragma once
// The shading model of Frostbite: Disney's diffuse renormalised so that it gains little energy together with
// the specular lobe, and GGX with correlated masking. Reciprocal and positive. Source: Lagarde and de
// Rousiers 2014, Moving Frostbite to Physically Based Rendering 3.0, SIGGRAPH course notes, section 3.1:
// listing 1 (renormalised diffuse) and 2 (F90, correlated Smith).

#include "bsdf/lobe_choice.h"
#include "bsdf/microfacet_reflection.h"
#include "core/warp.h"
#include "optics/fresnel_approximations.h"
#include "optics/ggx_albedo.h"

namespace nacre {

template <class R, int C>
struct Frostbite : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color base_color;
  R metallic, roughness, reflectance;

  static constexpr std::string_view name = "frostbite";
  static constexpr std::string_view source = "Lagarde and de Rousiers 2014, section 3.1";
  static constexpr std::string_view summary = "Frostbite: renormalised Disney diffuse and GGX";
  static constexpr Laws laws{.energy_gain = 0.25}; // 1.23 measured: at roughness 1 and the horizon
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&Frostbite::base_color, "base_color", "1", 0, 1, 0.5, "colour of diffuse or metal, linear"},
        Parameter{&Frostbite::metallic, "metallic", "1", 0, 1, 0, "0: dielectric, 1: metal; a blend between"},
        Parameter{&Frostbite::roughness, "roughness", "1", 0, 1, 0.5, "1 - smoothness; alpha is its square"},
        Parameter{&Frostbite::reflectance, "reflectance", "1", 0, 1, 0.5,
                  "16 % of its square is the dielectric's at normal incidence"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto facets = reflect_from_facets(distribution(), wo, wi, R(0));
    const R c = clamp(facets.cos_m, R(0), R(1));
    const R diffuse = (R(1) - metallic) * constant<R>(inv_pi) * diffuse_shape(wo, wi, c);
    const Color f = zip(base_color, f0(), [&](const R& base, const R& normal) {
      return R(diffuse * base + fresnel_schlick_vanishing(c, normal) * facets.value);
    });
    return select(facets.valid, f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto& p = choice(wo).probability;
    const R cosine = select(same_upper_side(wo, wi), wi.z * constant<R>(inv_pi), R(0));
    return p[0] * cosine + p[1] * facet_reflection_pdf(distribution(), wo, wi);
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const Vec3<R> mirrored = reflect(wo, distribution().sample_visible(wo, u));
    const Vec3<R> wi = select(u_lobe < choice(wo).probability[0], square_to_cosine_hemisphere(u), mirrored);
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

  /// The microsurface, for the validator and plots.
  Ggx<R> distribution() const { return {alpha(), alpha()}; }

private:
  /// Below 0.001 float cannot tell facets apart.
  R alpha() const { return max(roughness * roughness, R(0.001f)); }
  Color f0() const {
    const R dielectric = constant<R>(0.16) * reflectance * reflectance;
    return base_color.map([&](const R& base) { return R(dielectric + metallic * (base - dielectric)); });
  }
  /// Listing 1: Disney's diffuse with energy bias 0 to 0.5 and factor 1 to 1 / 1.51 as roughness grows.
  R diffuse_shape(const Vec3<R>& wo, const Vec3<R>& wi, const R& c) const {
    const R bias = R(0.5f) * roughness, factor = R(1) + roughness * constant<R>(1 / 1.51 - 1);
    const R f90 = bias + R(2) * c * c * roughness;
    return factor * fresnel_schlick(R(clamp(wi.z, R(0), R(1))), R(1), f90) *
           fresnel_schlick(R(clamp(wo.z, R(0), R(1))), R(1), f90);
  }
  LobeChoice<R, 2> choice(const Vec3<R>& wo) const {
    const auto E = GgxAlbedo::table().reflector(R(clamp(wo.z, R(0), R(1))), alpha());
    const R f = average(f0());
    return LobeChoice<R, 2>({(R(1) - metallic) * average(base_color), E.schlick(f, R(min(R(50) * f, R(1))))});
  }
};

} // namespace nacre
