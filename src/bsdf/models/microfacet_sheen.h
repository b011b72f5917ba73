#pragma once
// Sheen from fibres that stand upright, as microfacets whose normals crowd at the horizon: f = color D V.
// Three published pairs of distribution and visibility.
//  - `charlie`: D = (2 + 1/r) sin^(1/r) / (2 pi), masked by Smith's Lambda as the authors fitted it, with
//  their
//    softened terminator, which breaks reciprocity (switch). Estevez and Kulla 2017, Production Friendly
//    Microfacet Sheen BRDF, eq. 2-4 and table 1.
//  - `charlie_neubelt`: the same D with V = 1 / (4 (cos_i + cos_o - cos_i cos_o)), as in real-time renderers
//    and glTF's KHR_materials_sheen. Neubelt and Pettineo 2013, Crafting a Next-Gen Material Pipeline for The
//    Order: 1886.
//  - `ashikhmin_velvet`: D = (1 + 4 exp(-cot^2 / s^2) / sin^4) / (pi (1 + 4 s^2)) with that V. Ashikhmin and
//    Premoze 2007, Distribution-based BRDFs; normalised as in Neubelt and Pettineo 2013.
// Every D has a projected area of 1. Positive. Charlie's D with Neubelt's V gains energy near grazing
// angles when narrow, twice the light at r = 0.05.

#include "bsdf/hemisphere_lobes.h"
#include "bsdf/microfacet_reflection.h"

namespace nacre {

/// Estevez and Kulla's D, 1/sr, at the sine of the half vector's angle.
template <class R>
R charlie_distribution(const R& sine2, const R& roughness) {
  const R n = R(1) / roughness;
  return (R(2) + n) * constant<R>(0.5 * inv_pi) * pow(max(sine2, R(1e-20f)), R(R(0.5f) * n));
}
/// Their fit of Smith's Lambda, at the cosine of a direction in (0, 1].
template <class R>
R charlie_lambda(const R& cosine, const R& roughness) {
  const R smooth = sqr(R(1) - roughness);
  const auto between = [&](double at_0, double at_1) {
    return constant<R>(at_1) + smooth * constant<R>(at_0 - at_1);
  };
  const R a = between(25.3245, 21.5473), b = between(3.32435, 3.82987), c = between(0.16801, 0.19823),
          d = between(-1.27393, -1.97760), e = between(-4.85967, -4.32054);
  const auto L = [&](const R& x) { return R(a / (R(1) + b * pow(max(x, R(1e-20f)), c)) + d * x + e); };
  // Mirrored about 60 degrees, where the fit ends.
  const auto steep = cosine < R(0.5f);
  const R x = select(steep, cosine, R(R(1) - cosine)), l = L(x);
  return exp(select(steep, l, R(R(2) * L(R(0.5f)) - l)));
}
template <class R>
R velvet_distribution(const R& sine2, const R& spread) {
  const R s2 = max(sine2, R(1e-4f)); // where the exponential is nothing, and overflows nothing
  const R s = spread * spread, cot2 = (R(1) - s2) / s2;
  return (R(1) + R(4) * exp(-min(cot2 / s, R(80))) / (s2 * s2)) * constant<R>(inv_pi) / (R(1) + R(4) * s);
}
template <class R>
R neubelt_visibility(const R& cos_o, const R& cos_i) {
  // from the horizon to the horizon: 1e-20 is smaller than any of its values in a float frame
  return R(0.25f) / max(cos_o + cos_i - cos_o * cos_i, R(1e-20f));
}

/// What the three share: the half vector and the sampling. M is the model, with d(sine2) and v(cos_o, cos_i).
template <class M, class R, int C>
struct SheenLobe : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const auto [wm, valid] = UpperHalfVector<R>(wo, wi);
    const R f = model().d(sin2_theta(wm)) * model().v(select(valid, wo.z, R(1)), select(valid, wi.z, R(1)));
    return select(valid, model().color * f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const R p = cosine_probability();
    return select(same_upper_side(wo, wi),
                  p * max(wi.z, R(0)) * constant<R>(inv_pi) + (R(1) - p) * horizon(wo).pdf(wi), R(0));
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const Vec3<R> wi =
        select(u_lobe < cosine_probability(), square_to_cosine_hemisphere(u), horizon(wo).sample(u));
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  const M& model() const { return static_cast<const M&>(*this); }
  R cosine_probability() const { return model().cosine_share(); }
  /// Half vectors below the horizon are most of D, so wi is drawn, not wm: with the power of (1 - cos_i) that
  /// D's fall has for a viewer at the normal, a flatter one for a viewer at the horizon, who also sees the
  /// lobe turned to his own side.
  HorizonLobe<R> horizon(const Vec3<R>& wo) const {
    const R n = model().power(), flat = R(0.3f) * sqrt(n), c = clamp(wo.z, R(0), R(1));
    return {flat + c * c * (R(0.5f) * n - flat), wo};
  }
};

template <class R, int C>
struct Charlie : SheenLobe<Charlie<R, C>, R, C> {
  using typename ModelBase<R, C>::Color;
  Color color;
  R roughness, softened;

  static constexpr std::string_view name = "charlie";
  static constexpr std::string_view source = "Estevez and Kulla 2017, eq. 2-4";
  static constexpr std::string_view summary = "sheen of cloth, upright fibres, fitted Smith masking";
  static constexpr Laws laws{.reciprocal = false};
  static constexpr auto parameters() {
    return std::tuple{Parameter{&Charlie::color, "color", "1", 0, 1, 1.0, "factor on the reflection"},
                      Parameter{&Charlie::roughness, "roughness", "1", 0.05, 1, 0.3,
                                "spread of the fibres; small is a narrow rim"},
                      Parameter{&Charlie::softened, "softened", "1", 0, 1, 1.0,
                                "1: the published softer terminator, 0: without it, reciprocal", false}};
  }
  R d(const R& sine2) const { return charlie_distribution(sine2, roughness); }
  R v(const R& cos_o, const R& cos_i) const {
    const R rim = sqr(sqr(sqr(R(1) - cos_i)));
    const R lambda_i = pow(charlie_lambda(cos_i, roughness), R(R(1) + softened * R(2) * rim));
    const R G = R(1) / (R(1) + charlie_lambda(cos_o, roughness) + lambda_i);
    return R(0.25f) * G / max(cos_o * cos_i, R(1e-20f));
  }
  R power() const { return R(1) / roughness; }
  R cosine_share() const { return R(0.3f); }
};

template <class R, int C>
struct CharlieNeubelt : SheenLobe<CharlieNeubelt<R, C>, R, C> {
  using typename ModelBase<R, C>::Color;
  Color color;
  R roughness;

  static constexpr std::string_view name = "charlie_neubelt";
  static constexpr std::string_view source = "Estevez and Kulla 2017, eq. 2; Neubelt and Pettineo 2013";
  static constexpr std::string_view summary = "sheen of cloth as in glTF, upright fibres";
  static constexpr Laws laws{.energy_gain = 0.86}; // measured at roughness 0.05, light at the horizon
  static constexpr auto parameters() {
    return std::tuple{Parameter{&CharlieNeubelt::color, "color", "1", 0, 1, 1.0, "factor on the reflection"},
                      Parameter{&CharlieNeubelt::roughness, "roughness", "1", 0.05, 1, 0.3,
                                "spread of the fibres; glTF's alpha, the square of its sheenRoughness"}};
  }
  R d(const R& sine2) const { return charlie_distribution(sine2, roughness); }
  R v(const R& cos_o, const R& cos_i) const { return neubelt_visibility(cos_o, cos_i); }
  R power() const { return R(1) / roughness; }
  R cosine_share() const { return R(0.3f); }
};

template <class R, int C>
struct AshikhminVelvet : SheenLobe<AshikhminVelvet<R, C>, R, C> {
  using typename ModelBase<R, C>::Color;
  Color color;
  R spread;

  static constexpr std::string_view name = "ashikhmin_velvet";
  static constexpr std::string_view source = "Ashikhmin and Premoze 2007; Neubelt and Pettineo 2013";
  static constexpr std::string_view summary = "velvet, an inverted Gaussian of upright fibres";
  static constexpr auto parameters() {
    return std::tuple{Parameter{&AshikhminVelvet::color, "color", "1", 0, 1, 1.0, "factor on the reflection"},
                      Parameter{&AshikhminVelvet::spread, "spread", "1", 0.05, 1, 0.4,
                                "spread of the fibres about the horizon, a slope"}};
  }
  R d(const R& sine2) const { return velvet_distribution(sine2, spread); }
  R v(const R& cos_o, const R& cos_i) const { return neubelt_visibility(cos_o, cos_i); }
  R power() const { return R(1.5f) / (spread * spread); }
  R cosine_share() const { return R(0.2f) + R(0.6f) / (R(1) + R(4) * spread); }
};

} // namespace nacre
