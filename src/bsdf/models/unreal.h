#pragma once
// The shading model of Unreal Engine 4: Lambert and GGX from base colour, metallic, roughness and specular,
// the pattern of real-time "physically based" materials. Reciprocal and positive; diffuse and specular are
// added, so a white smooth surface gains energy at grazing angles. Masking is Schlick's form with k = alpha /
// 2, near to Smith's; Fresnel Schlick's with a spherical Gaussian for the power. Source: Karis 2013, Real
// Shading in Unreal Engine 4, SIGGRAPH course notes, eq. 3 (D), 4 (G), 5 (F).

#include "bsdf/lobe_choice.h"
#include "bsdf/microfacet_reflection.h"
#include "core/warp.h"
#include "optics/ggx_albedo.h"

namespace nacre {

template <class R, int C>
struct Unreal : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color base_color;
  R metallic, roughness, specular, analytic_light;

  static constexpr std::string_view name = "unreal";
  static constexpr std::string_view source = "Karis 2013, eq. 3-5";
  static constexpr std::string_view summary = "Unreal Engine 4: Lambert and GGX for real time";
  static constexpr Laws laws{.energy_gain = 0.95}; // 1.87 measured: gloss over white diffuse at the horizon
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&Unreal::base_color, "base_color", "1", 0, 1, 0.5, "colour of diffuse or metal, linear"},
        Parameter{&Unreal::metallic, "metallic", "1", 0, 1, 0, "0: dielectric, 1: metal; a blend between"},
        Parameter{&Unreal::roughness, "roughness", "1", 0, 1, 0.5, "alpha is its square"},
        Parameter{&Unreal::specular, "specular", "1", 0, 1, 0.5, "8 % of it is the dielectric's reflectance"},
        Parameter{&Unreal::analytic_light, "analytic_light", "1", 0, 1, 1,
                  "1: roughness remapped to (1 + roughness) / 2 in masking, 0: not, as for image-based light",
                  false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto [wm, valid] = UpperHalfVector<R>(wo, wi);
    const R co = select(valid, wo.z, R(1)), ci = select(valid, wi.z, R(1));
    const R c = clamp(select(valid, dot(wo, wm), R(1)), R(0), R(1));
    // Eq. 4: k = (roughness + 1)^2 / 8, for image-based light alpha / 2; G / (4 cos cos), which stays finite
    const R remapped = sqr(roughness + R(1)) * R(0.125f), plain = R(0.5f) * alpha();
    const R k = plain + analytic_light * (remapped - plain);
    const R V = R(0.25f) / ((co * (R(1) - k) + k) * (ci * (R(1) - k) + k));
    const R power =
        exp(constant<R>(std::log(2.0)) * ((constant<R>(-5.55473) * c - constant<R>(6.98316)) * c));
    const R mirror = distribution().D(wm) * V, diffuse = (R(1) - metallic) * constant<R>(inv_pi);
    const Color f = zip(base_color, f0(), [&](const R& base, const R& normal) {
      return R(diffuse * base + (normal + (R(1) - normal) * power) * mirror);
    });
    return select(valid, f, Color());
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

private:
  /// Below 0.001 float cannot tell facets apart.
  R alpha() const { return max(roughness * roughness, R(0.001f)); }
  Ggx<R> distribution() const { return {alpha(), alpha()}; }
  Color f0() const {
    const R dielectric = constant<R>(0.08) * specular;
    return base_color.map([&](const R& base) { return R(dielectric + metallic * (base - dielectric)); });
  }
  LobeChoice<R, 2> choice(const Vec3<R>& wo) const {
    const auto E = GgxAlbedo::table().reflector(R(clamp(wo.z, R(0), R(1))), alpha());
    return LobeChoice<R, 2>({(R(1) - metallic) * average(base_color), E.schlick(average(f0()), R(1))});
  }
};

} // namespace nacre
