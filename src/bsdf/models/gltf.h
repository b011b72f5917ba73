#pragma once
// The material of glTF 2.0, metallic-roughness, with its ratified extensions of the surface: ior, specular,
// clearcoat, sheen, transmission, anisotropy, iridescence; and diffuse_transmission (release candidate).
// Without a volume a transmitting surface is thin. Volume, dispersion and emission are not values of a BSDF.
// Not reciprocal where a clearcoat lies (its share depends on the viewer's angle) and gains energy at grazing
// angles: the share of diffuse light is taken with V.H, not with the albedo of the layer above, a
// simplification for real time. Source: glTF 2.0 specification (Khronos 2021), appendix B, and the
// extensions' own formulas.

#include "bsdf/charlie_albedo.h"
#include "bsdf/lobe_choice.h"
#include "bsdf/microfacet_reflection.h"
#include "bsdf/models/microfacet_sheen.h"
#include "core/warp.h"
#include "optics/fresnel_approximations.h"
#include "optics/ggx_albedo.h"
#include "optics/thin_film.h"

namespace nacre {

template <class R, int C>
struct Gltf : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  R metallic, roughness, ior, specular, anisotropy, anisotropy_rotation, clearcoat, clearcoat_roughness,
      sheen_roughness;
  R transmission, diffuse_transmission, iridescence, iridescence_ior, iridescence_thickness;
  Color base_color, specular_color, sheen_color, diffuse_transmission_color, wavelength;

  static constexpr std::string_view name = "gltf";
  static constexpr std::string_view source =
      "glTF 2.0 specification, appendix B, and KHR_materials extensions";
  static constexpr std::string_view summary = "glTF 2.0 metallic-roughness with its extensions";
  // 1.92 measured: a smooth white dielectric at the horizon; 2 is the limit.
  static constexpr Laws laws{.reciprocal = false, .transmits = true, .thin = true, .energy_gain = 1};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&Gltf::base_color, "base_color", "1", 0, 1, 1, "colour of diffuse or metal, linear"},
        Parameter{&Gltf::metallic, "metallic", "1", 0, 1, 1, "0: dielectric, 1: metal; a blend between"},
        Parameter{&Gltf::roughness, "roughness", "1", 0, 1, 1, "alpha is its square"},
        Parameter{&Gltf::ior, "ior", "1", 1, 3, 1.5, "index of the dielectric"},
        Parameter{&Gltf::specular, "specular", "1", 0, 1, 1, "factor on the dielectric's reflection", false},
        Parameter{&Gltf::specular_color, "specular_color", "1", 0, 1, 1,
                  "factor on its reflectance at normal incidence", false},
        Parameter{&Gltf::anisotropy, "anisotropy", "1", 0, 1, 0, "spread of the highlight along the tangent"},
        Parameter{&Gltf::anisotropy_rotation, "anisotropy_rotation", "rad", 0, 2 * pi, 0,
                  "of that direction from the tangent, towards the bitangent", false},
        Parameter{&Gltf::clearcoat, "clearcoat", "1", 0, 1, 0, "share of a clear coat of index 1.5"},
        Parameter{&Gltf::clearcoat_roughness, "clearcoat_roughness", "1", 0, 1, 0, "alpha is its square"},
        Parameter{&Gltf::sheen_color, "sheen_color", "1", 0, 1, 0, "of the fibres on top; black: none",
                  false},
        Parameter{&Gltf::sheen_roughness, "sheen_roughness", "1", 0, 1, 0, "of the fibres", false},
        Parameter{&Gltf::transmission, "transmission", "1", 0, 1, 0, "share of diffuse that goes through",
                  false},
        Parameter{&Gltf::diffuse_transmission, "diffuse_transmission", "1", 0, 1, 0,
                  "share of diffuse that leaves on the other side", false},
        Parameter{&Gltf::diffuse_transmission_color, "diffuse_transmission_color", "1", 0, 1, 1, "its colour",
                  false},
        Parameter{&Gltf::iridescence, "iridescence", "1", 0, 1, 0, "coverage of a thin film", false},
        Parameter{&Gltf::iridescence_ior, "iridescence_ior", "1", 1, 3, 1.3, "index of the film", false},
        Parameter{&Gltf::iridescence_thickness, "iridescence_thickness", "nm", 0, 1200, 400, "of the film",
                  false},
        Parameter{&Gltf::wavelength, "wavelength", "nm", 300, 900, 550,
                  "at which each channel sees the film; in RGB by default those of the primaries of sRGB",
                  false}};
  }

  Color eval(const Vec3<R>& wo_any, const Vec3<R>& wi_any) const {
    const auto [wo, wi_side] = oriented(wo_any, wi_any);
    const auto through = wi_side.z < R(0);
    const Vec3<R> wi = select(through, flipped(wi_side), wi_side);
    const auto facets = reflect_from_facets(distribution(), wo, wi, R(1));
    const Color F_d = fresnel(dielectric_f0(), facets.cos_m), F_m = fresnel(base_color, facets.cos_m);
    const R below = R(1) - specular * max_component(F_d);
    const Color color = select(through, diffuse_transmission_color, base_color);
    const R diffuse = constant<R>(inv_pi) * (R(1) - transmission) *
                      select(through, diffuse_transmission, R(1) - diffuse_transmission);
    const R glass = select(through, transmission * facets.value, R(0));
    const R mirror = select(through, R(0), facets.value);
    const R coat_share = clearcoat * fresnel_schlick(clamp(wo.z, R(0), R(1)), constant<R>(0.04));
    const R coat = select(through, R(0), reflect_from_facets(coat_distribution(), wo, wi, R(1)).value);
    const R fibers = select(through, R(0), sheen().eval(wo, wi)[0]), under_sheen = sheen_scaling(wo, wi);
    Color f;
    for (int i = 0; i < C; ++i) {
      const R insulator = below * (diffuse * color[i] + glass * base_color[i]) + specular * F_d[i] * mirror;
      const R material = insulator + metallic * (F_m[i] * mirror - insulator);
      const R cloth = sheen_color[i] * fibers + under_sheen * material;
      f[i] = cloth + coat_share * (coat - cloth);
    }
    return select(facets.valid, f, Color());
  }
  R pdf(const Vec3<R>& wo_any, const Vec3<R>& wi_any) const {
    const auto [wo, wi] = oriented(wo_any, wi_any);
    const Vec3<R> mirrored = flipped(wi);
    const auto& p = choice(wo).probability;
    const auto cosine = [&](const Vec3<R>& w) {
      return R(select(same_upper_side(wo, w), w.z * constant<R>(inv_pi), R(0)));
    };
    return p[0] * cosine(wi) + p[1] * facet_reflection_pdf(distribution(), wo, wi) +
           p[2] * facet_reflection_pdf(distribution(), wo, mirrored) + p[3] * cosine(mirrored) +
           p[4] * facet_reflection_pdf(coat_distribution(), wo, wi) + p[5] * sheen().pdf(wo, wi);
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo_any, const R& u_lobe, const Vec2<R>& u) const {
    const Vec3<R> wo = oriented(wo_any, wo_any).first;
    const Vec3<R> mirrored = reflect(wo, distribution().sample_visible(wo, u));
    const Vec3<R> cosine = square_to_cosine_hemisphere(u);
    Vec3<R> wi = cosine;
    auto through = mask_t<R>(false);
    choice(wo).for_each_chosen(u_lobe, [&](int lobe, const mask_t<R>& here, const R& u_rest) {
      const Vec3<R> w = lobe == 1   ? mirrored
                        : lobe == 2 ? flipped(mirrored)
                        : lobe == 3 ? flipped(cosine)
                        : lobe == 4 ? reflect(wo, coat_distribution().sample_visible(wo, u))
                                    : sheen().sample(wo, u_rest, u).wi;
      wi = select(here, w, wi);
      if (lobe == 2 || lobe == 3) through = through | here;
    });
    // A facet may send light to the side that its lobe does not belong to: no sample.
    const auto right_side = (through & (wi.z < R(0))) | ((!through) & (wi.z > R(0)));
    wi = turned(anisotropy_rotation, select(wo_any.z < R(0), flipped(wi), wi));
    const R p = select(right_side, pdf(wo_any, wi), R(0));
    return {wi, select(p > R(0), eval(wo_any, wi), Color()), p, mask_t<R>(false)};
  }

private:
  static Vec3<R> flipped(const Vec3<R>& w) { return {w.x, w.y, -w.z}; }
  /// The surface is the same from both sides; x is the direction along which the highlight is spread.
  std::pair<Vec3<R>, Vec3<R>> oriented(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto below = wo.z < R(0);
    return {turned(R(-anisotropy_rotation), select(below, flipped(wo), wo)),
            turned(R(-anisotropy_rotation), select(below, flipped(wi), wi))};
  }
  static Vec3<R> turned(const R& angle, const Vec3<R>& w) {
    if (!any(angle != R(0))) return w;
    const R c = cos(angle), s = sin(angle);
    return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
  }
  /// KHR_materials_anisotropy: alpha_t = mix(alpha, 1, strength^2). At least 0.001, which float can resolve.
  Ggx<R> distribution() const {
    const R alpha = max(roughness * roughness, R(0.001f));
    return {alpha + anisotropy * anisotropy * (R(1) - alpha), alpha};
  }
  Ggx<R> coat_distribution() const {
    const R alpha = max(clearcoat_roughness * clearcoat_roughness, R(0.001f));
    return {alpha, alpha};
  }
  /// alpha_g is the squared roughness; narrower fibres than 0.05 are not in the published fit.
  R sheen_alpha() const { return max(sheen_roughness * sheen_roughness, R(0.05f)); }
  Charlie<R, 1> sheen() const {
    Charlie<R, 1> s;
    s.color[0] = R(1);
    s.roughness = sheen_alpha();
    s.softened = R(0);
    return s;
  }
  /// min(1 - max(sheenColor) E(V), 1 - max(sheenColor) E(L))
  R sheen_scaling(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const CharlieAlbedo& E = CharlieAlbedo::table();
    const R alpha = sheen_alpha();
    const R most = max(E(R(clamp(wo.z, R(0), R(1))), alpha), E(R(clamp(wi.z, R(0), R(1))), alpha));
    return max(R(1) - max_component(sheen_color) * most, R(0));
  }
  Color dielectric_f0() const {
    const R f0 = sqr((ior - R(1)) / (ior + R(1)));
    return specular_color.map([&](const R& c) { return R(min(f0 * c, R(1))); });
  }
  /// Schlick's, or of a film on what has this reflectance at the normal: an index without absorption, as
  /// KHR_materials_iridescence has it for metals too.
  Color fresnel(const Color& f0, const R& cos_m) const {
    const R c = clamp(cos_m, R(0), R(1));
    Color F = f0.map([&](const R& f) { return R(fresnel_schlick(c, f)); });
    if (any(iridescence > R(0)))
      for (int i = 0; i < C; ++i) {
        const R root = min(safe_sqrt(f0[i]), R(0.99f)), index = (R(1) + root) / (R(1) - root);
        const R film = thin_film_reflectance(c, wavelength[i],
                                             ThinFilm<R>{iridescence_thickness, iridescence_ior, index})
                           .unpolarized();
        F[i] = F[i] + iridescence * (film - F[i]);
      }
    return F;
  }
  /// Lobes: diffuse, mirror, glass, diffuse through, clearcoat, sheen.
  LobeChoice<R, 6> choice(const Vec3<R>& wo) const {
    const R c = clamp(wo.z, R(0), R(1));
    const auto E = GgxAlbedo::table().reflector(c, sqrt(distribution().alpha_x * distribution().alpha_y));
    const R f0 = average(dielectric_f0()), insulator = R(1) - metallic, base = average(base_color);
    const R coat = clearcoat * fresnel_schlick(c, constant<R>(0.04)),
            cloth = average(sheen_color) * CharlieAlbedo::table()(c, sheen_alpha());
    const R below = (R(1) - coat) * max(R(1) - cloth, R(0)), rest = below * insulator * (R(1) - f0);
    const R film = iridescence * R(0.2f); // a film may reflect more than what it covers
    return LobeChoice<R, 6>(
        {rest * (R(1) - transmission) * (R(1) - diffuse_transmission) * base,
         below * (insulator * specular * (E.schlick(f0, R(1)) + film) + metallic * E.schlick(base, R(1))),
         rest * transmission * base * E.one,
         rest * (R(1) - transmission) * diffuse_transmission * average(diffuse_transmission_color), coat,
         (R(1) - coat) * cloth});
  }
};

} // namespace nacre
