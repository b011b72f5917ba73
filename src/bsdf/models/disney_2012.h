#pragma once
// Disney's "principled" BRDF: eleven intuitive parameters for nearly everything opaque, the ancestor of all
// production models. Diffuse with Fresnel and retro-reflection, GGX, sheen, clearcoat. Reciprocal and
// positive, but a sum of lobes that do not know of each other, so it gains energy: Burley chose plausible
// over physical, "we want a principled model, not necessarily a strictly physical one". Source: Burley 2012,
// section 5, exactly as in the public disney.brdf, except that base_color is linear here (there: a
// power 2.2).

#include "bsdf/disney.h"
#include "bsdf/lobe_choice.h"
#include "core/warp.h"
#include "optics/ggx_albedo.h"

namespace nacre {

template <class R, int C>
struct Disney2012 : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color base_color;
  R metallic, subsurface, specular, roughness, specular_tint, anisotropic, sheen, sheen_tint, clearcoat,
      clearcoat_gloss;

  static constexpr std::string_view name = "disney_2012";
  static constexpr std::string_view source = "Burley 2012, section 5 and disney.brdf";
  static constexpr std::string_view summary = "Disney's principled BRDF: one opaque model for all";
  // 2.99 at grazing angles: sheen tinted by pure blue (over its luminance: 10) and clearcoat on top of white
  // diffuse, which are added with no account of each other; 1.86 with grey.
  static constexpr Laws laws{.energy_gain = 2.0};
  static constexpr auto parameters() {
    using M = Disney2012;
    return std::tuple{
        Parameter{&M::base_color, "base_color", "1", 0, 1, 0.5, "colour of diffuse or metal, linear"},
        Parameter{&M::metallic, "metallic", "1", 0, 1, 0, "0: dielectric, 1: metal; a blend between"},
        Parameter{&M::subsurface, "subsurface", "1", 0, 1, 0, "share of a flatter diffuse shape", false},
        Parameter{&M::specular, "specular", "1", 0, 1, 0.5, "8 % of it is the reflectance of the dielectric"},
        Parameter{&M::roughness, "roughness", "1", 0, 1, 0.5, "of diffuse and specular; alpha is its square"},
        Parameter{&M::specular_tint, "specular_tint", "1", 0, 1, 0, "hue of base_color in specular", false},
        Parameter{&M::anisotropic, "anisotropic", "1", 0, 1, 0, "stretch of the highlight along the tangent"},
        Parameter{&M::sheen, "sheen", "1", 0, 1, 0, "grazing reflection of cloth"},
        Parameter{&M::sheen_tint, "sheen_tint", "1", 0, 1, 0.5, "hue of base_color in sheen", false},
        Parameter{&M::clearcoat, "clearcoat", "1", 0, 1, 0, "second specular lobe of index 1.5"},
        Parameter{&M::clearcoat_gloss, "clearcoat_gloss", "1", 0, 1, 1, "0: satin coat, 1: gloss", false}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto facets = reflect_from_facets(distribution(), wo, wi, R(1));
    const R FH = disney::schlick_weight(facets.cos_m);
    const R diffuse = constant<R>(inv_pi) * diffuse_shape(wo, wi, facets.cos_m) * (R(1) - metallic);
    const R fuzz = FH * sheen * (R(1) - metallic);
    const Color f0 = reflectance(), cloth = disney::partly(sheen_tint, disney::tint(base_color));
    const R coat = disney::Clearcoat<R>{clearcoat, clearcoat_gloss}.eval(wo, wi);
    Color f;
    for (int i = 0; i < C; ++i)
      f[i] = diffuse * base_color[i] + fuzz * cloth[i] + disney::lerp(f0[i], R(1), FH) * facets.value + coat;
    return select(facets.valid, f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto& p = choice(wo).probability;
    const R cosine = select(same_upper_side(wo, wi), wi.z * constant<R>(inv_pi), R(0));
    return p[0] * cosine + p[1] * facet_reflection_pdf(distribution(), wo, wi) +
           p[2] * disney::Clearcoat<R>{clearcoat, clearcoat_gloss}.pdf(wo, wi);
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    Vec3<R> wi = square_to_cosine_hemisphere(u);
    choice(wo).for_each_chosen(u_lobe, [&](int lobe, const mask_t<R>& here, const R&) {
      wi = select(here,
                  lobe == 1 ? reflect(wo, distribution().sample_visible(wo, u))
                            : disney::Clearcoat<R>{clearcoat, clearcoat_gloss}.sample(wo, u),
                  wi);
    });
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  Ggx<R> distribution() const { return disney::facets(roughness, anisotropic); }
  /// Reflectance at normal incidence, Cspec0.
  Color reflectance() const {
    const Color hue = disney::partly(specular_tint, disney::tint(base_color));
    return zip(hue, base_color, [&](const R& h, const R& b) {
      return R(disney::lerp(R(constant<R>(0.08) * specular * h), b, metallic));
    });
  }
  /// Diffuse with retro-reflection (section 5.3), blended with the approximation of Hanrahan and Krueger's
  /// subsurface scattering.
  R diffuse_shape(const Vec3<R>& wo, const Vec3<R>& wi, const R& cos_d) const {
    const R FL = disney::schlick_weight(wi.z), FV = disney::schlick_weight(wo.z);
    const R Fss90 = cos_d * cos_d * roughness, Fd90 = R(0.5f) + R(2) * Fss90;
    const R Fd = disney::lerp(R(1), Fd90, FL) * disney::lerp(R(1), Fd90, FV);
    const R Fss = disney::lerp(R(1), Fss90, FL) * disney::lerp(R(1), Fss90, FV);
    // 1 / (cos + cos) grows beyond bounds at grazing angles, and its square beyond float: held at 1e6
    const R ss = R(1.25f) * (Fss * (R(1) / max(wi.z + wo.z, R(1e-6f)) - R(0.5f)) + R(0.5f));
    return disney::lerp(Fd, ss, subsurface);
  }
  LobeChoice<R, 3> choice(const Vec3<R>& wo) const {
    const Ggx<R> d = distribution();
    const R c = clamp(wo.z, 0.0f, 1.0f);
    const auto E = GgxAlbedo::table().reflector(c, sqrt(d.alpha_x * d.alpha_y));
    const R cloth = average(disney::partly(sheen_tint, disney::tint(base_color)));
    // Sheen's albedo, seen from steep to grazing, is some 0.1 to 0.6
    const R diffuse =
        (R(1) - metallic) *
        (average(base_color) + sheen * cloth * (constant<R>(0.1) + R(0.5f) * disney::schlick_weight(c)));
    return LobeChoice<R, 3>({diffuse, E.schlick(average(reflectance()), R(1)),
                             disney::Clearcoat<R>{clearcoat, clearcoat_gloss}.albedo(c)});
  }
};

} // namespace nacre
