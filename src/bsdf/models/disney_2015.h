#pragma once
// Disney's principled BSDF: the model of 2012 with refraction, for solids, and for thin surfaces (leaves,
// paper, soap) as a second model. Subsurface scattering, which the paper integrates as a diffusion profile,
// is not a matter of a BSDF; its limit of short paths is the diffuse lobe here. Reciprocal, with the eta^2 of
// transmission, and positive; like its ancestor a sum of lobes that gains energy where sheen, clearcoat or
// gloss lie over white diffuse. Source: Burley 2015, Extending the Disney BRDF to a BSDF with Integrated
// Subsurface Scattering, sections 2 (diffuse, eq. 4), 3 (transmission) and 5 (thin surfaces).

#include "bsdf/disney.h"
#include "bsdf/facet_refraction.h"
#include "bsdf/lobe_choice.h"
#include "core/warp.h"
#include "optics/fresnel.h"
#include "optics/ggx_albedo.h"

namespace nacre {

/// @tparam thin  a sheet without inside, the same from both sides
template <class R, int C, bool thin>
struct Disney2015Bsdf : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color base_color;
  R metallic, eta, roughness, specular_tint, anisotropic, sheen, sheen_tint, clearcoat, clearcoat_gloss;
  R spec_trans, flatness = R(0), diff_trans = R(0);

  static constexpr std::string_view name = thin ? "disney_2015_thin" : "disney_2015";
  static constexpr std::string_view source = "Burley 2015, sections 2, 3 and 5";
  static constexpr std::string_view summary =
      thin ? "Disney's principled BSDF for thin surfaces" : "Disney's principled BSDF with refraction";
  // 3.11 and, with the flat diffuse shape, 4.13 at grazing angles: sheen tinted by pure blue and clearcoat on
  // top of diffuse and gloss, added with no account of each other.
  static constexpr Laws laws{.transmits = true, .thin = thin, .energy_gain = thin ? 3.3 : 2.3};
  static constexpr auto parameters() {
    using M = Disney2015Bsdf;
    const auto solid = std::tuple{
        Parameter{&M::base_color, "base_color", "1", 0, 1, 0.5, "colour of diffuse, metal or glass, linear"},
        Parameter{&M::metallic, "metallic", "1", 0, 1, 0, "0: dielectric, 1: metal; a blend between"},
        Parameter{&M::eta, "eta", "1", 1.05, 2.5, 1.5, "index of the dielectric / index outside"},
        Parameter{&M::roughness, "roughness", "1", 0, 1, 0.5, "of diffuse and specular; alpha is its square"},
        Parameter{&M::specular_tint, "specular_tint", "1", 0, 1, 0, "hue of base_color in specular", false},
        Parameter{&M::anisotropic, "anisotropic", "1", 0, 1, 0, "stretch of the highlight along the tangent"},
        Parameter{&M::sheen, "sheen", "1", 0, 1, 0, "grazing reflection of cloth"},
        Parameter{&M::sheen_tint, "sheen_tint", "1", 0, 1, 0.5, "hue of base_color in sheen", false},
        Parameter{&M::clearcoat, "clearcoat", "1", 0, 1, 0, "second specular lobe of index 1.5"},
        Parameter{&M::clearcoat_gloss, "clearcoat_gloss", "1", 0, 1, 1, "0: satin coat, 1: gloss", false},
        Parameter{&M::spec_trans, "spec_trans", "1", 0, 1, 0, "share of diffuse that is clear", false}};
    if constexpr (thin)
      return std::tuple_cat(
          solid,
          std::tuple{
              Parameter{&M::flatness, "flatness", "1", 0, 1, 0, "share of a flatter diffuse shape", false},
              Parameter{&M::diff_trans, "diff_trans", "1", 0, 2, 0,
                        "0: all diffuse light is reflected, 1: half goes through, 2: all", false}});
    else
      return solid;
  }

  Color eval(const Vec3<R>& wo_any, const Vec3<R>& wi_any) const {
    const auto [wo, wi] = oriented(wo_any, wi_any);
    return select(wo.z > R(0), reflected(wo, wi), reflected_inside(wo, wi)) + transmitted(wo, wi);
  }
  R pdf(const Vec3<R>& wo_any, const Vec3<R>& wi_any) const {
    const auto [wo, wi] = oriented(wo_any, wi_any);
    const R side = select(wo.z < R(0), R(-1), R(1));
    const auto& p = choice(wo).probability;
    const auto cosine = [&](const Vec3<R>& o, const Vec3<R>& w) {
      return R(select(same_upper_side(o, w), w.z * constant<R>(inv_pi), R(0)));
    };
    const R mirrored = facet_reflection_pdf(distribution(), wo * side, wi * side) * mirror_share(wo, wi);
    R through(0);
    if constexpr (thin) {
      through = p[2] * facet_reflection_pdf(blurred(), wo, flipped(wi));
    } else {
      const auto facets = refract_through_facets(distribution(), wo, wi, eta);
      const R F = fresnel_dielectric(facets.cos_outside, eta).reflectance;
      through = p[1] * facets.pdf * (R(1) - mirror_share(F, facets.cos_outside, wo.z > R(0)));
    }
    return p[0] * cosine(wo, wi) + p[1] * mirrored + through + p[3] * coat().pdf(wo, wi) +
           p[4] * cosine(wo, flipped(wi));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo_any, const R& u_lobe, const Vec2<R>& u) const {
    const Vec3<R> wo = oriented(wo_any, wo_any).first;
    const R side = select(wo.z < R(0), R(-1), R(1));
    const Vec3<R> wm = distribution().sample_visible(wo * side, u) * side;
    const Vec3<R> mirrored = reflect(wo, wm), cosine = square_to_cosine_hemisphere(u);
    Vec3<R> wi = cosine;
    auto through = mask_t<R>(false);
    choice(wo).for_each_chosen(u_lobe, [&](int lobe, const mask_t<R>& here, const R& u_rest) {
      if (lobe == 1) {
        const auto refracts = here & (u_rest >= mirror_share(wo, mirrored));
        wi = select(here, select(refracts, refract_in_facet(wo, wm, eta), mirrored), wi);
        through = through | refracts;
      } else if (lobe == 3) {
        wi = select(here, coat().sample(wo, u), wi);
      } else {
        wi = select(here, flipped(lobe == 4 ? cosine : reflect(wo, blurred().sample_visible(wo, u))), wi);
        through = through | here;
      }
    });
    // A facet may send light to the side that its lobe does not belong to: no sample.
    const auto right_side = (through & (wi.z * wo.z < R(0))) | ((!through) & (wi.z * wo.z > R(0)));
    if constexpr (thin) wi = select(wo_any.z < R(0), flipped(wi), wi);
    const R p = select(right_side, pdf(wo_any, wi), R(0));
    return {wi, select(p > R(0), eval(wo_any, wi), Color()), p, mask_t<R>(false)};
  }

private:
  static Vec3<R> flipped(const Vec3<R>& w) { return {w.x, w.y, -w.z}; }
  static std::pair<Vec3<R>, Vec3<R>> oriented(const Vec3<R>& wo, const Vec3<R>& wi) {
    if constexpr (!thin) return {wo, wi};
    const auto below = wo.z < R(0);
    return {select(below, flipped(wo), wo), select(below, flipped(wi), wi)};
  }
  Ggx<R> distribution() const { return disney::facets(roughness, anisotropic); }
  /// Two refractions in a sheet blur less than a reflection: section 5, roughness (0.65 eta - 0.35).
  Ggx<R> blurred() const {
    return disney::facets(R(clamp(R((constant<R>(0.65) * eta - constant<R>(0.35)) * roughness), R(0), R(1))),
                          anisotropic);
  }
  disney::Clearcoat<R> coat() const { return {clearcoat, clearcoat_gloss}; }

  /// Exact for a dielectric, Schlick's for its tinted share and for metal.
  Color fresnel(const R& cos_m) const {
    const R FH = disney::schlick_weight(cos_m), f0 = sqr((eta - R(1)) / (eta + R(1)));
    const R exact = fresnel_dielectric(clamp(cos_m, R(0), R(1)), eta).reflectance;
    return zip(disney::tint(base_color), base_color, [&](const R& hue, const R& base) {
      const R dielectric =
          disney::lerp(exact, disney::lerp(R(f0 * hue), R(1), FH), specular_tint); // hue may exceed 1
      return R(disney::lerp(min(dielectric, R(1)), disney::lerp(base, R(1), FH), metallic));
    });
  }
  /// Eq. 4: Lambert with its Fresnel factors, flattened in thin surfaces, and retro-reflection.
  R diffuse_shape(const R& cos_o, const R& cos_i, const R& cos_d) const {
    const R FL = disney::schlick_weight(cos_i), FV = disney::schlick_weight(cos_o);
    const R RR = R(2) * roughness * cos_d * cos_d;
    const R retro = RR * (FL + FV + FL * FV * (RR - R(1)));
    R lambert = (R(1) - R(0.5f) * FL) * (R(1) - R(0.5f) * FV);
    if constexpr (thin) {
      const R Fss90 = R(0.5f) * RR;
      const R Fss = disney::lerp(R(1), Fss90, FL) * disney::lerp(R(1), Fss90, FV);
      // 1 / (cos + cos) grows beyond bounds at grazing angles, and its square beyond float: held at 1e6
      const R flat = R(1.25f) * (Fss * (R(1) / max(cos_i + cos_o, R(1e-6f)) - R(0.5f)) + R(0.5f));
      lambert = disney::lerp(lambert, flat, flatness);
    }
    return lambert + retro;
  }

  Color reflected(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto facets = reflect_from_facets(distribution(), wo, wi, R(1));
    const R co = select(facets.valid, wo.z, R(1)), ci = select(facets.valid, wi.z, R(1));
    const R kept = thin ? R(1) - R(0.5f) * diff_trans : R(1);
    const R diffuse = (R(1) - metallic) * (R(1) - spec_trans) * kept * constant<R>(inv_pi) *
                      diffuse_shape(co, ci, facets.cos_m);
    const R fuzz = (R(1) - metallic) * sheen * disney::schlick_weight(facets.cos_m);
    const R gloss = coat().eval(wo, wi);
    const Color F = fresnel(facets.cos_m), cloth = disney::partly(sheen_tint, disney::tint(base_color));
    Color f;
    for (int i = 0; i < C; ++i)
      f[i] = diffuse * base_color[i] + fuzz * cloth[i] + F[i] * facets.value + gloss;
    return select(facets.valid, f, Color());
  }
  /// From below there is glass alone: opaque matter has no inside.
  Color reflected_inside(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto facets = reflect_from_facets(distribution(), -wo, -wi, R(1));
    const R F = fresnel_dielectric(-facets.cos_m, eta).reflectance;
    return select(facets.valid, Color((R(1) - metallic) * spec_trans * F * facets.value), Color());
  }
  Color transmitted(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R clear = (R(1) - metallic) * spec_trans;
    if constexpr (!thin) {
      // The root: light passes the surface on its way in and out.
      const auto facets = refract_through_facets(distribution(), wo, wi, eta);
      const R T = R(1) - fresnel_dielectric(facets.cos_outside, eta).reflectance;
      return base_color.map([&](const R& b) { return R(safe_sqrt(b) * (clear * T * facets.value)); });
    } else {
      const auto facets = reflect_from_facets(blurred(), wo, flipped(wi), R(1));
      // wo . wm as half the length of their sum: exact where T vanishes, from horizon to horizon
      const R c = clamp(R(R(0.5f) * length(wo + flipped(wi))), R(0), R(1));
      const R T = R(1) - fresnel_dielectric(c, eta).reflectance;
      const R diffuse = (R(1) - metallic) * (R(1) - spec_trans) * R(0.5f) * diff_trans * constant<R>(inv_pi);
      return select(facets.valid, base_color * (clear * T * facets.value + diffuse), Color());
    }
  }
  /// How often a facet of glass that mirrors wi to wo, both on one side, is taken to reflect; always in a
  /// sheet, whose transmission has facets of its own.
  R mirror_share(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R c = clamp(R(R(0.5f) * length(wo + wi)), R(0), R(1)); // wo . wm
    const auto above = wo.z > R(0);
    const auto fresnel_there = fresnel_dielectric(R(select(above, c, -c)), eta);
    return mirror_share(fresnel_there.reflectance, c, above);
  }
  R mirror_share(const R& F, const R& c, const mask_t<R>& above) const {
    if constexpr (thin) return R(1);
    const R insulator = R(1) - metallic, clear = insulator * spec_trans, base = average(base_color);
    const R metal = metallic * disney::lerp(base, R(1), disney::schlick_weight(c));
    const R mirror = select(above, metal + insulator * F, clear * F);
    return mirror / max(mirror + clear * (R(1) - F) * safe_sqrt(base), R(1e-9f));
  }
  /// Lobes: diffuse with sheen, facets, transmission of a sheet, clearcoat, diffuse through.
  LobeChoice<R, 5> choice(const Vec3<R>& wo) const {
    const GgxAlbedo& t = GgxAlbedo::table();
    const auto above = wo.z > R(0);
    const R c = clamp(wo.z, R(0), R(1)), c_in = clamp(-wo.z, R(0), R(1));
    const Ggx<R> d = distribution();
    const R alpha = sqrt(d.alpha_x * d.alpha_y), base = average(base_color), insulator = R(1) - metallic;
    const R cloth = average(disney::partly(sheen_tint, disney::tint(base_color)));
    const R diffuse = insulator * (R(1) - spec_trans) * base, clear = insulator * spec_trans;
    const R lost = thin ? R(0.5f) * diff_trans : R(0);
    const R fuzz = insulator * sheen * cloth * (R(0.1f) + R(0.5f) * disney::schlick_weight(c));
    const R mirror = metallic * t.reflector(c, alpha).schlick(base, R(1)) +
                     insulator * t.dielectric_reflection(c, alpha, eta);
    const R through = clear * t.dielectric_transmission(c, alpha, eta) * (thin ? base : safe_sqrt(base));
    const R inside = R(1) / eta, none(0);
    const R glass_inside = clear * (t.dielectric_reflection(c_in, alpha, inside) +
                                    t.dielectric_transmission(c_in, alpha, inside) * safe_sqrt(base));
    return LobeChoice<R, 5>({select(above, diffuse * (R(1) - lost) + fuzz, none),
                             select(above, thin ? mirror : mirror + through, glass_inside),
                             thin ? through : none, select(above, coat().albedo(c), none),
                             select(above, diffuse * lost, none)});
  }
};

template <class R, int C>
using Disney2015 = Disney2015Bsdf<R, C, false>;
template <class R, int C>
using Disney2015Thin = Disney2015Bsdf<R, C, true>;

} // namespace nacre
