#pragma once
// OpenPBR Surface: the common production model of the Academy Software Foundation. A mix of metal and of a
// dielectric over diffuse, subsurface or glass, under a thin film, a coat and fuzz. Layers by albedo scaling
// with tabulated albedos, which keeps energy; that scaling and the fuzz are not reciprocal. Not a
// matter of a BSDF: volumes (subsurface is diffuse here, transmission_color a tint of the interface, as for
// transmission_depth = 0), dispersion, emission, opacity, normal maps. Source: OpenPBR Surface 1.1
// specification, the sections "Model" and "Reduction to a mixture of lobes".

#include "bsdf/facet_refraction.h"
#include "bsdf/lobe_choice.h"
#include "bsdf/microfacet_reflection.h"
#include "bsdf/models/eon.h"
#include "bsdf/models/zeltner_sheen.h"
#include "bsdf/openpbr_base.h"
#include "core/warp.h"

namespace nacre {

/// @tparam thin  geometry_thin_walled: a sheet with the same air on both sides
template <class R, int C, bool thin>
struct OpenPbrSurface : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  R base_weight, base_diffuse_roughness, base_metalness;
  R specular_weight, specular_roughness, specular_roughness_anisotropy, eta;
  R transmission_weight, subsurface_weight, subsurface_scatter_anisotropy;
  R coat_weight, coat_roughness, coat_roughness_anisotropy, coat_ior, coat_darkening;
  R fuzz_weight, fuzz_roughness, thin_film_weight, thin_film_thickness, thin_film_ior;
  Color base_color, specular_color, transmission_color, subsurface_color, coat_color, fuzz_color, wavelength;

  static constexpr std::string_view name = thin ? "openpbr_thin" : "openpbr";
  static constexpr std::string_view source = "OpenPBR Surface 1.1, Academy Software Foundation 2024";
  static constexpr std::string_view summary =
      thin ? "OpenPBR Surface, thin-walled" : "OpenPBR Surface: one production model for all";
  // 1.09 is reached by anisotropic metal that reflects all, at grazing angles: the albedos of anisotropic
  // facets are taken from isotropic ones. Isotropic: 1.005, the error of the tables.
  static constexpr Laws laws{.reciprocal = false, .transmits = true, .thin = thin, .energy_gain = 0.1};
  static constexpr auto parameters() {
    using M = OpenPbrSurface;
    return std::tuple{
        Parameter{&M::base_weight, "base_weight", "1", 0, 1, 1, "factor on base_color", false},
        Parameter{&M::base_color, "base_color", "1", 0, 1, 0.8, "of diffuse, or of metal at the normal"},
        Parameter{&M::base_diffuse_roughness, "base_diffuse_roughness", "1", 0, 1, 0, "0: Lambert", false},
        Parameter{&M::base_metalness, "base_metalness", "1", 0, 1, 0, "0: dielectric, 1: metal"},
        Parameter{&M::specular_weight, "specular_weight", "1", 0, 1, 1,
                  "factor on the dielectric's reflectance at the normal, and on metal", false},
        Parameter{&M::specular_color, "specular_color", "1", 0, 1, 1,
                  "tint of the dielectric's reflection; of metal at 82 degrees"},
        Parameter{&M::specular_roughness, "specular_roughness", "1", 0, 1, 0.3, "alpha is its square"},
        Parameter{&M::specular_roughness_anisotropy, "specular_roughness_anisotropy", "1", 0, 1, 0,
                  "stretch of the highlight along the tangent"},
        Parameter{&M::eta, "eta", "1", 1.01, 3, 1.5, "specular_ior: index of the dielectric / index outside"},
        Parameter{&M::transmission_weight, "transmission_weight", "1", 0, 1, 0, "share that is glass", false},
        Parameter{&M::transmission_color, "transmission_color", "1", 0, 1, 1, "tint of transmitted light",
                  false},
        Parameter{&M::subsurface_weight, "subsurface_weight", "1", 0, 1, 0, "share of subsurface", false},
        Parameter{&M::subsurface_color, "subsurface_color", "1", 0, 1, 0.8, "its albedo", false},
        Parameter{&M::subsurface_scatter_anisotropy, "subsurface_scatter_anisotropy", "1", -1, 1, 0,
                  "thin-walled: -1 reflects the subsurface light, 1 lets it through", false},
        Parameter{&M::coat_weight, "coat_weight", "1", 0, 1, 0, "coverage of the coat"},
        Parameter{&M::coat_color, "coat_color", "1", 0, 1, 1, "its transmittance in and out at the normal",
                  false},
        Parameter{&M::coat_roughness, "coat_roughness", "1", 0, 1, 0, "alpha is its square"},
        Parameter{&M::coat_roughness_anisotropy, "coat_roughness_anisotropy", "1", 0, 1, 0,
                  "stretch of the coat's highlight", false},
        Parameter{&M::coat_ior, "coat_ior", "1", 1.05, 3, 1.6, "index of the coat", false},
        Parameter{&M::coat_darkening, "coat_darkening", "1", 0, 1, 1,
                  "1: bounces under the coat darken and saturate the base as they do, 0: not", false},
        Parameter{&M::fuzz_weight, "fuzz_weight", "1", 0, 1, 0, "coverage of the fuzz"},
        Parameter{&M::fuzz_color, "fuzz_color", "1", 0, 1, 1, "colour of the fuzz", false},
        Parameter{&M::fuzz_roughness, "fuzz_roughness", "1", 0, 1, 0.5, "0: fibres upright, 1: dust", false},
        Parameter{&M::thin_film_weight, "thin_film_weight", "1", 0, 1, 0, "coverage of the film", false},
        Parameter{&M::thin_film_thickness, "thin_film_thickness", "um", 0, 2, 0.5, "of the film", false},
        Parameter{&M::thin_film_ior, "thin_film_ior", "1", 1, 3, 1.4, "index of the film", false},
        Parameter{&M::wavelength, "wavelength", "nm", 300, 900, 550,
                  "at which each channel sees the film; in RGB by default those of the primaries of sRGB",
                  false}};
  }

  Color eval(const Vec3<R>& wo_any, const Vec3<R>& wi_any) const {
    const auto [wo, wi] = oriented(wo_any, wi_any);
    const View v = view(wo);
    const auto above = wo.z > R(0);
    Color f = select(above, reflected(v, wo, wi), reflected_inside(wo, wi));
    if constexpr (thin)
      f += through_sheet(v, wo, wi);
    else
      f += refracted(v, wo, wi);
    return f;
  }
  R pdf(const Vec3<R>& wo_any, const Vec3<R>& wi_any) const {
    const auto [wo, wi] = oriented(wo_any, wi_any);
    const auto above = wo.z > R(0);
    const auto& p = choice(view(wo), wo).probability;
    const Ggx<R> d = distribution();
    const R cosine = select(above & (wi.z > R(0)), wi.z * constant<R>(inv_pi), R(0));
    const R side = select(above, R(1), R(-1));
    R facets = facet_reflection_pdf(d, wo * side, wi * side) * mirror_share(wo, wi);
    if constexpr (thin) {
      facets = facets + facet_reflection_pdf(d, wo, flipped(wi)) * (R(1) - mirror_share(wo, flipped(wi)));
    } else {
      const auto refracted_facets = refract_through_facets(d, wo, wi, eta);
      const R share = mirror_share(refracted_facets.cos_outside, mask_t<R>(false), above);
      facets = facets + refracted_facets.pdf * (R(1) - share);
    }
    R sum = p[0] * cosine + p[1] * facets + p[2] * facet_reflection_pdf(coat_distribution(), wo, wi) +
            p[3] * fuzz().pdf(wo, wi);
    if constexpr (thin) sum = sum + p[4] * select(above & (wi.z < R(0)), -wi.z * constant<R>(inv_pi), R(0));
    return sum;
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo_any, const R& u_lobe, const Vec2<R>& u) const {
    const Vec3<R> wo = oriented(wo_any, wo_any).first;
    const R side = select(wo.z < R(0), R(-1), R(1));
    const Vec3<R> wm = distribution().sample_visible(wo * side, u) * side;
    const Vec3<R> mirrored = reflect(wo, wm), cosine = square_to_cosine_hemisphere(u);
    Vec3<R> wi = cosine;
    auto through = mask_t<R>(false);
    choice(view(wo), wo).for_each_chosen(u_lobe, [&](int lobe, const mask_t<R>& here, const R& u_rest) {
      if (lobe == 1) {
        const auto mirror = u_rest < mirror_share(wo, mirrored);
        wi = select(here, select(mirror, mirrored, thin ? flipped(mirrored) : refract_in_facet(wo, wm, eta)),
                    wi);
        through = through | (here & !mirror);
      } else if (lobe == 4) {
        wi = select(here, flipped(cosine), wi);
        through = through | here;
      } else {
        wi = select(here,
                    lobe == 2 ? reflect(wo, coat_distribution().sample_visible(wo, u))
                              : fuzz().sample(wo, R(0), u).wi,
                    wi);
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
  /// A thin wall is the same from both sides.
  static std::pair<Vec3<R>, Vec3<R>> oriented(const Vec3<R>& wo, const Vec3<R>& wi) {
    if constexpr (!thin) return {wo, wi};
    const auto below = wo.z < R(0);
    return {select(below, flipped(wo), wo), select(below, flipped(wi), wi)};
  }

  Ggx<R> distribution() const {
    return openpbr::facets(openpbr::roughened(specular_roughness, coat_roughness, coat_weight),
                           specular_roughness_anisotropy);
  }
  Ggx<R> coat_distribution() const { return openpbr::facets(coat_roughness, coat_roughness_anisotropy); }
  static R mean_alpha(const Ggx<R>& d) { return sqrt(d.alpha_x * d.alpha_y); }
  /// The published fit has no fuzz below a roughness of 2 / 31 and all from 3 / 31 on.
  ZeltnerSheen<R, 1> fuzz() const {
    ZeltnerSheen<R, 1> f;
    f.color[0] = R(1);
    f.roughness = max(fuzz_roughness, R(0.1f));
    return f;
  }
  R fuzz_coverage() const { return fuzz_weight * clamp(R(fuzz_roughness * R(31) - R(2)), R(0), R(1)); }

  R reflecting_index() const {
    return openpbr::reflecting_index(eta, coat_ior, coat_weight, specular_weight);
  }
  openpbr::Film<R, C> film() const {
    return {thin_film_weight, thin_film_thickness * R(1000),
            thin_film_ior / openpbr::lerp(R(1), coat_ior, coat_weight), wavelength};
  }
  openpbr::DielectricFacets<R, C> dielectric() const { return {reflecting_index(), film()}; }
  openpbr::MetalFacets<R, C> metal() const { return {base_color * base_weight, specular_color, film()}; }

  /// What a pair of directions shares with all others of the same wo.
  struct View {
    R below_fuzz;    ///< 1 - albedo of the fuzz
    R coat_albedo;   ///< of full coverage
    Color coat_pass; ///< transmittance of the coat from wo to the base, absorption alone
    Color darkening;
    R alpha, E, E_average; ///< of the dielectric without film
    Color beneath;         ///< share of light that gets below the dielectric
  };
  View view(const Vec3<R>& wo) const {
    const R c = clamp(wo.z, R(0), R(1)), n = reflecting_index();
    View v;
    v.below_fuzz = R(1) - fuzz_coverage() * fuzz().albedo(wo);
    v.coat_albedo = coat_albedo(c);
    v.coat_pass = coat_pass(c);
    v.darkening = darkening(c);
    v.alpha = mean_alpha(distribution());
    v.E = GgxAlbedo::table().dielectric_reflection(c, v.alpha, n);
    v.E_average = GgxAlbedo::table().dielectric_reflection_average(v.alpha, n);
    v.beneath = Color(R(1) - v.E);
    if (film().present()) {
      const R seen = GgxAlbedo::table().perfect(c, v.alpha), bare = fresnel_dielectric(c, n).reflectance;
      v.beneath = dielectric().largest_reflectance(c).map(
          [&](const R& F) { return R(clamp(R(1) - v.E - seen * (F - bare), R(0), R(1))); });
    }
    return v;
  }

  R coat_albedo(const R& c) const {
    return GgxAlbedo::table().dielectric_reflection(c, mean_alpha(coat_distribution()), coat_ior);
  }
  /// T^(1 / mu_t), section "Coat / View-dependent absorption".
  Color coat_pass(const R& c) const {
    const R mu = sqrt(R(1) - (R(1) - c * c) / sqr(coat_ior));
    return coat_color.map([&](const R& t) {
      const auto clear = t > R(0);
      return R(select(clear, pow(select(clear, t, R(1)), R(R(0.5f) / mu)), R(0)));
    });
  }
  /// Section "Coat / Darkening": lerp(1, Delta, C delta).
  Color darkening(const R& c) const {
    const R n = reflecting_index(), Fs = sqr((n - R(1)) / (n + R(1)));
    const R K_s = fresnel_dielectric(c, coat_ior).reflectance;
    const R K_r = fresnel_dielectric_average_inside(coat_ior);
    const R r = openpbr::roughened(specular_roughness, coat_roughness, coat_weight);
    const R K = openpbr::lerp(K_s, K_r, openpbr::lerp(openpbr::lerp(R(1), r, Fs), r, base_metalness));
    Color dark;
    for (int i = 0; i < C; ++i) {
      // Albedo at the normal. What goes through counts as kept: no bounce under the coat can absorb it.
      const R opaque = openpbr::lerp(base_weight * base_color[i], subsurface_color[i], subsurface_weight);
      const R below = openpbr::lerp(opaque, R(1), transmission_weight);
      const R base = openpbr::lerp(Fs + (R(1) - Fs) * below, specular_weight * base_weight * base_color[i],
                                   base_metalness);
      const R delta = (R(1) - K) / (R(1) - base * K);
      dark[i] = openpbr::lerp(R(1), delta, coat_weight * coat_darkening);
    }
    return dark;
  }

  /// What passes the coat once, at the outer cosine c, where its absorption is `pass` and its albedo `E`.
  Color through_coat(const Color& pass, const R& E) const {
    return pass.map([&](const R& t) { return R(openpbr::lerp(R(1), R(t * (R(1) - E)), coat_weight)); });
  }

  /// wo . wm in a form that is the same for wi and never negative: near the horizon the product rounds to
  /// either side of 0, on one of which Fresnel's term is that of light from within.
  static R front_cosine(const FacetReflection<R>& facets, const Vec3<R>& wo, const Vec3<R>& wi) {
    const Vec3<R> up{R(0), R(0), R(1)};
    return R(0.5f) * length(select(facets.valid, wo, up) + select(facets.valid, wi, up));
  }

  /// Both directions above.
  Color reflected(const View& v, const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto facets = reflect_from_facets(distribution(), wo, wi, R(0));
    const auto coat = reflect_from_facets(coat_distribution(), wo, wi, R(0));
    const auto valid = same_upper_side(wo, wi);
    const R ci = select(valid, wi.z, R(1)), co = select(valid, wo.z, R(1));
    const R coat_F = fresnel_dielectric(coat.cos_m, coat_ior).reflectance * coat.value * coat_weight;
    const Color in = coat_pass(clamp(ci, R(0), R(1)));
    const R fiber = fuzz_coverage() * fuzz().eval(wo, wi)[0];

    const R cos_m = front_cosine(facets, wo, wi);
    const Color F_metal = metal().reflectance(cos_m), F = dielectric().reflectance(cos_m);
    const Color bounced = metal_bounces(co, ci);
    const Color sheet = sheet_reflectance(F, cos_m);
    const Color diffuse = diffuse_reflection(wo, wi);
    const R under = (R(1) - GgxAlbedo::table().dielectric_reflection(clamp(ci, R(0), R(1)), v.alpha,
                                                                     reflecting_index())) /
                    (R(1) - v.E_average);
    Color f;
    for (int i = 0; i < C; ++i) {
      const R glass = thin ? openpbr::lerp(F[i], sheet[i], transmission_weight) : F[i];
      const R dielectric_base = specular_color[i] * glass * facets.value +
                                (R(1) - transmission_weight) * v.beneath[i] * under * diffuse[i];
      const R metal_base = specular_weight * (F_metal[i] * facets.value + bounced[i]);
      const R base = v.darkening[i] * openpbr::lerp(dielectric_base, metal_base, base_metalness);
      const R pass = openpbr::lerp(R(1), R(v.coat_pass[i] * in[i] * (R(1) - v.coat_albedo)), coat_weight);
      f[i] = fuzz_color[i] * fiber + v.below_fuzz * (coat_F + pass * base);
    }
    return select(valid, f, Color());
  }

  /// The diffuse and subsurface share of the opaque base, without what the dielectric above takes.
  Color diffuse_reflection(const Vec3<R>& wo, const Vec3<R>& wi) const {
    Eon<R, C> eon;
    eon.reflectance = base_color * base_weight;
    eon.roughness = base_diffuse_roughness;
    const R share = thin ? R(0.5f) * (R(1) - subsurface_scatter_anisotropy) : R(1);
    return zip(eon.eval(wo, wi), subsurface_color, [&](const R& diffuse, const R& s) {
      return R(openpbr::lerp(diffuse, R(share * s * constant<R>(inv_pi)), subsurface_weight));
    });
  }

  /// What single reflection from rough metal misses, spread over the hemisphere. Kulla and Conty 2017.
  Color metal_bounces(const R& co, const R& ci) const {
    const GgxAlbedo& t = GgxAlbedo::table();
    const R alpha = mean_alpha(distribution()), mean = t.reflector_average(alpha).one;
    const R missing = (R(1) - t.perfect(clamp(co, R(0), R(1)), alpha)) *
                      (R(1) - t.perfect(clamp(ci, R(0), R(1)), alpha)) /
                      max((R(1) - mean) * constant<R>(pi), R(1e-6f));
    return metal().average().map(
        [&](const R& F) { return R(missing * F * F * mean / (R(1) - F * (R(1) - mean))); });
  }

  /// From below, light meets the glass alone: opaque matter has no inside.
  Color reflected_inside(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto facets = reflect_from_facets(distribution(), -wo, -wi, R(0));
    const auto inside = fresnel_dielectric(-front_cosine(facets, wo, wi), eta);
    const Color F = dielectric().reflectance(abs(inside.cos_t));
    const auto total = inside.reflectance >= R(1);
    const R share = (R(1) - base_metalness) * transmission_weight * facets.value;
    return select(facets.valid, F.map([&](const R& f) { return R(share * select(total, R(1), f)); }),
                  Color());
  }

  /// Through the interface, either way; the coat and the fuzz take their toll on the outer side.
  Color refracted(const View& v, const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto facets = refract_through_facets(distribution(), wo, wi, eta);
    const Color F = dielectric().reflectance(facets.cos_outside);
    const auto above = wo.z > R(0);
    const R c = clamp(wi.z, R(0), R(1));
    const Color pass =
        through_coat(select(above, v.coat_pass, coat_pass(c)), select(above, v.coat_albedo, coat_albedo(c)));
    const R toll = select(above, v.below_fuzz, R(1) - fuzz_coverage() * fuzz().albedo(wi));
    const Color dark = select(above, v.darkening, darkening(c));
    Color f;
    for (int i = 0; i < C; ++i)
      f[i] = (R(1) - base_metalness) * transmission_weight * transmission_color[i] * (R(1) - F[i]) *
             facets.value * toll * dark[i] * pass[i];
    return f;
  }

  /// A ray's path in a sheet of the glass, relative to its thickness.
  R sheet_path(const R& cos_m) const { return R(1) / sqrt(R(1) - (R(1) - cos_m * cos_m) / sqr(eta)); }
  Color sheet_tint(const R& cos_m) const {
    const R path = sheet_path(clamp(cos_m, R(0), R(1)));
    return transmission_color.map([&](const R& t) {
      const auto clear = t > R(0);
      return R(select(clear, pow(select(clear, t, R(1)), path), R(0)));
    });
  }
  /// All bounces in the sheet, F + (1 - F)^2 t^2 F / (1 - F^2 t^2).
  Color sheet_reflectance(const Color& F, const R& cos_m) const {
    if constexpr (!thin) return F;
    return zip(F, sheet_tint(cos_m), [](const R& f, const R& t) {
      const R t2 = t * t;
      return R(f + sqr(R(1) - f) * t2 * f / max(R(1) - f * f * t2, R(1e-6f)));
    });
  }
  /// Of a thin wall: glass, its facets blurring as a mirror's do, and subsurface light let through. What
  /// leaves below meets no other layer.
  Color through_sheet(const View& v, const Vec3<R>& wo, const Vec3<R>& wi) const {
    const Vec3<R> mirrored = flipped(wi);
    const auto facets = reflect_from_facets(distribution(), wo, mirrored, R(0));
    const auto valid = same_upper_side(wo, mirrored);
    const R cos_m = front_cosine(facets, wo, mirrored);
    const Color F = dielectric().reflectance(cos_m), tint = sheet_tint(cos_m);
    const R under = (R(1) - GgxAlbedo::table().dielectric_reflection(clamp(mirrored.z, R(0), R(1)), v.alpha,
                                                                     reflecting_index())) /
                    (R(1) - v.E_average);
    const R leaf = R(0.5f) * (R(1) + subsurface_scatter_anisotropy) * subsurface_weight * under;
    const Color pass = through_coat(v.coat_pass, v.coat_albedo);
    Color f;
    for (int i = 0; i < C; ++i) {
      const R glass = sqr(R(1) - F[i]) * tint[i] / max(R(1) - sqr(F[i] * tint[i]), R(1e-6f)) * facets.value;
      const R leafy = leaf * v.beneath[i] * subsurface_color[i] * constant<R>(inv_pi);
      f[i] = (R(1) - base_metalness) * v.below_fuzz * v.darkening[i] * pass[i] *
             openpbr::lerp(leafy, glass, transmission_weight);
    }
    return select(valid, f, Color());
  }

  /// How often a facet of the base that mirrors wi to wo, both on one side, is taken to reflect.
  R mirror_share(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R c = clamp(R(R(0.5f) * length(wo + wi)), R(0), R(1)); // wo . wm
    const auto above = wo.z > R(0);
    const auto inside = fresnel_dielectric(-c, eta);
    return mirror_share(R(select(above, c, abs(inside.cos_t))), (!above) & (inside.reflectance >= R(1)),
                        above);
  }
  /// @param cos_outside  to the facet's normal, above the surface; no one's where `total` reflects
  R mirror_share(const R& cos_outside, const mask_t<R>& total, const mask_t<R>& above) const {
    const R F = select(total, R(1), average(dielectric().reflectance(cos_outside)));
    const R insulator = R(1) - base_metalness, glass = insulator * transmission_weight;
    const R mirror = base_metalness * specular_weight * average(metal().reflectance(cos_outside)) +
                     insulator * average(specular_color) * F *
                         (thin ? openpbr::lerp(R(1), R(R(2) / (R(1) + F)), transmission_weight) : R(1));
    const R reflects = select(above, mirror, glass * F);
    const R lets_through =
        glass * (R(1) - F) * average(transmission_color) * (thin ? R(1) / (R(1) + F) : R(1));
    return reflects / max(reflects + lets_through, R(1e-9f));
  }

  /// Lobes: diffuse, facets of the base, coat, fuzz, and of a thin wall diffuse transmission.
  LobeChoice<R, thin ? 5 : 4> choice(const View& v, const Vec3<R>& wo) const {
    const GgxAlbedo& t = GgxAlbedo::table();
    const auto above = wo.z > R(0);
    const R c = clamp(wo.z, R(0), R(1)), c_in = clamp(-wo.z, R(0), R(1));
    const R covered =
        v.below_fuzz * openpbr::lerp(R(1), R((R(1) - v.coat_albedo) * average(v.coat_pass)), coat_weight);
    const R insulator = R(1) - base_metalness, glass = insulator * transmission_weight;
    const R F0 = average(base_color) * base_weight * specular_weight;
    const R opaque =
        openpbr::lerp(base_weight * average(base_color), average(subsurface_color), subsurface_weight);
    const R metal_E = t.reflector(c, v.alpha).schlick(F0, R(1)) * average(specular_color) * specular_weight;
    const R bounces = base_metalness * F0 * (R(1) - t.perfect(c, v.alpha));
    const R beneath = average(v.beneath),
            transmitted_inside = t.dielectric_transmission(c_in, v.alpha, R(1) / eta);
    const R leaf = thin ? R(0.5f) * (R(1) + subsurface_scatter_anisotropy) * subsurface_weight : R(0);
    const R diffuse = insulator * (R(1) - transmission_weight) * opaque * beneath;
    const R specular = base_metalness * metal_E + insulator * (R(1) - beneath) * average(specular_color) *
                                                      (thin ? R(1) + transmission_weight : R(1));
    const R through = glass * beneath * average(transmission_color);
    const R none(0);
    const R inside =
        t.dielectric_reflection(c_in, v.alpha, R(1) / eta) + transmitted_inside * average(transmission_color);
    std::array<R, thin ? 5 : 4> albedo{select(above, covered * (diffuse * (R(1) - leaf) + bounces), none),
                                       select(above, covered * (specular + through), glass * inside),
                                       select(above, v.below_fuzz * coat_weight * v.coat_albedo, none),
                                       select(above, (R(1) - v.below_fuzz) * average(fuzz_color), none)};
    if constexpr (thin) albedo[4] = covered * diffuse * leaf;
    return LobeChoice < R, thin ? 5 : 4 > (albedo);
  }
};

template <class R, int C>
using OpenPbr = OpenPbrSurface<R, C, false>;
template <class R, int C>
using OpenPbrThin = OpenPbrSurface<R, C, true>;

} // namespace nacre
