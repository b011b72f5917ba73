#pragma once
// The substrate of OpenPBR: its roughness and indices under a coat, and its Fresnel terms.
// Source: OpenPBR Surface 1.1 (Academy Software Foundation 2024), sections named at each function.

#include "optics/fresnel_approximations.h"
#include "optics/ggx_albedo.h"
#include "optics/thin_film.h"

namespace nacre::openpbr {

template <class R>
R lerp(const R& a, const R& b, const std::type_identity_t<R>& t) {
  return a + t * (b - a);
}

/// Section "Microfacet model": alpha_t^2 + alpha_b^2 = 2 r^4, alpha_b / alpha_t = 1 - anisotropy; at least
/// 0.001, below which float cannot tell facets apart.
template <class R>
Ggx<R> facets(const R& roughness, const R& anisotropy) {
  const R b = R(1) - anisotropy, alpha = roughness * roughness * sqrt(R(2) / (R(1) + b * b));
  return {max(alpha, R(0.001f)), max(b * alpha, R(0.001f))};
}

/// Section "Coat / Roughening".
template <class R>
R roughened(const R& base, const R& coat, const R& coat_weight) {
  const R sum = sqr(sqr(base)) + R(2) * sqr(sqr(coat));
  return lerp(base, safe_sqrt(safe_sqrt(min(sum, R(1)))), coat_weight);
}

/// Section "Coat": index of the base relative to what lies above, inverted where the coat is the denser, as
/// light that came through the coat does not reach the angles of total reflection; then the reflectance at
/// normal incidence is multiplied by `weight`, section "Base substrate", eq. modulated_ior. At least 1.
template <class R>
R reflecting_index(const R& ior, const R& coat_ior, const R& coat_weight, const R& weight) {
  const R under_coat = max(ior / coat_ior, coat_ior / ior), ratio = lerp(ior, under_coat, coat_weight);
  const R e = safe_sqrt(weight) * (ratio - R(1)) / (ratio + R(1));
  return (R(1) + e) / (R(1) - e);
}

/// The film on the substrate; wavelengths in nm, one a channel.
template <class R, int C>
struct Film {
  R weight, thickness_nm, eta; ///< index relative to what lies above
  Spectrum<R, C> wavelength;

  /// Averaged over the film's phase.
  R incoherent(const R& cos_i, const R& eta_base) const {
    const auto top = fresnel_dielectric(cos_i, eta);
    const R F = top.reflectance, B = fresnel_dielectric(-top.cos_t, R(eta_base / eta)).reflectance;
    return F + sqr(R(1) - F) * B / max(R(1) - F * B, R(1e-6f));
  }
  bool present() const { return any(weight > R(0)); }
  R reflectance(int channel, const R& cos_i, const R& eta_base, const R& k_base) const {
    return thin_film_reflectance(cos_i, wavelength[channel], ThinFilm<R>{thickness_nm, eta, eta_base, k_base})
        .unpolarized();
  }
};

/// Fresnel of the dielectric, per channel with the film's colours, from the cosine above the interface.
template <class R, int C>
struct DielectricFacets {
  R eta;
  Film<R, C> film;

  Spectrum<R, C> reflectance(const R& cos_i) const {
    const R c = clamp(cos_i, R(0), R(1)), bare = fresnel_dielectric(c, eta).reflectance;
    Spectrum<R, C> F(bare);
    if (film.present())
      for (int i = 0; i < C; ++i)
        F[i] = lerp(bare, film.reflectance(i, c, eta, R(0)), film.weight);
    return F;
  }
  /// The larger of that and its average over phases: facets of a rough surface show one or the other, and
  /// what lies below must not shine through both.
  Spectrum<R, C> largest_reflectance(const R& cos_i) const {
    const R c = clamp(cos_i, R(0), R(1)), bare = fresnel_dielectric(c, eta).reflectance;
    const R mean = lerp(bare, film.incoherent(c, eta), film.weight);
    return reflectance(c).map([&](const R& F) { return R(max(F, mean)); });
  }
};

/// F82-tint, section "Metal"; under a film the complex index of the same colours (Gulbrandsen 2014), as the
/// section on the film suggests.
template <class R, int C>
struct MetalFacets {
  Spectrum<R, C> f0, tint;
  Film<R, C> film;

  Spectrum<R, C> reflectance(const R& cos_i) const {
    const R c = clamp(cos_i, R(0), R(1));
    // Dark tints of dark colours would reflect less than nothing.
    Spectrum<R, C> F =
        zip(f0, tint, [&](const R& f, const R& t) { return R(max(fresnel_f82_tint(c, f, t), R(0))); });
    if (film.present())
      for (int i = 0; i < C; ++i) {
        const ComplexIndex<R> n = complex_index(ArtisticMetal<R>{f0[i], tint[i]});
        F[i] = lerp(F[i], film.reflectance(i, c, n.eta, n.k), film.weight);
      }
    return F;
  }
  Spectrum<R, C> average() const {
    return zip(f0, tint, [](const R& f, const R& t) { return R(max(fresnel_f82_tint_average(f, t), R(0))); });
  }
};

} // namespace nacre::openpbr
