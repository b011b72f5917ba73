#pragma once
// The most complete reflectance model of physical optics that computer graphics has used: a Gaussian random
// surface of height deviation sigma and correlation length tau, by Kirchhoff's diffraction. The mirror image
// fades as sigma grows against the wavelength (a delta lobe that `sample` alone knows), the light it loses
// spreads into a lobe as wide as wavelength / tau or sigma / tau, whichever is wider; at grazing angles the
// visible heights are fewer and the surface turns smooth. Reciprocal, positive. Diffuse light from below is
// not included: add a lobe. Source: He, Torrance, Sillion and Greenberg 1991, A Comprehensive Physical Model
// for Light Reflection, eq. 71 to 84 (unpolarised), with the exponential that eq. 25 lacks in print (Smith
// 1967; authors' errata).

#include "bsdf/half_sum.h"
#include "bsdf/microfacet_reflection.h"
#include "core/warp.h"
#include "optics/fresnel.h"
#include "optics/he_series.h"

namespace nacre {

template <class R, int C>
struct He : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color eta, k;
  R sigma, tau;
  Color wavelength, specular_reflectance;

  static constexpr std::string_view name = "he";
  static constexpr std::string_view source = "He et al. 1991, eq. 71 to 84";
  static constexpr std::string_view summary = "diffraction by a random rough surface: mirror and spread lobe";
  // With factor 1 and a perfect reflector the albedo reaches 1.044, at 78 degrees for sigma = wavelength / 8,
  // tau = 2 wavelengths: the tangent-plane approximation wants slopes and curvatures small (He et al. 1991,
  // section 3). The factor is that of published fits, which go to 2e9 where the fitted index comes near
  // to 1.
  static constexpr Laws laws{.energy_gain = 1e10 * 1.045};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&He::eta, "eta", "1", 0.01, 20, 1.5, "real part of the index / index outside"},
        Parameter{&He::k, "k", "1", 0, 30, 0.0, "imaginary part of the index, absorption"},
        Parameter{&He::sigma, "sigma", "um", 1e-3, 10, 0.2, "standard deviation of heights"},
        Parameter{&He::tau, "tau", "um", 0.2, 110, 3.0, "correlation length of heights"},
        Parameter{&He::wavelength, "wavelength", "um", 0.3, 1, 0.55,
                  "in the medium outside; in RGB by default those of the primaries of sRGB", false},
        Parameter{&He::specular_reflectance, "specular_reflectance", "1", 0, 1e10, 1.0,
                  "factor on the reflection; 1 is physical", false}};
  }

  /// The incoherent part, eq. 71 and 78, f = F G S D / (pi cos_o cos_i).
  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const HalfSum<R> half(wo, wi);
    const Slant o(half.cos_o, wo), i(half.cos_i, wi);
    const R visible = shadowing_over_cos(o) * shadowing_over_cos(i), seen_sigma = effective_sigma(o, i);
    const R cos2_om = R(0.25f) * half.squared(), cos_om = sqrt(cos2_om);
    const R tangential = sqr(half.H.x) + sqr(half.H.y); // v_xy^2 in units of the wave number
    Color f;
    for (int c = 0; c < C; ++c) {
      // The geometric factor of eq. 76 is (v.v / v_z)^2 for unit vectors s and p, and g contains v_z^2:
      // together they stay finite at grazing angles.
      const R wave = wave_number(c), height = wave * seen_sigma, length = wave * tau;
      const R g = sqr(height * half.H.z); // eq. 79
      const R GD = sqr(length * height * cos2_om) * he_series(g, R(R(0.25f) * sqr(length) * tangential));
      f[c] = specular_reflectance[c] * fresnel_conductor(cos_om, eta[c], k[c]) * GD * visible *
             constant<R>(inv_pi);
    }
    return select(half.valid, f, Color());
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const Mirror mirror(*this, wo);
    return select(same_upper_side(wo, wi), (R(1) - mirror.probability) * mirror.lobes.pdf(wo, wi), R(0));
  }
  /// The mirror image, or the lobe of visible normals of the same width as the spread light.
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const auto up = wo.z > R(0);
    const Mirror mirror(*this, wo);
    const R p = mirror.probability;
    const auto coherent = u_lobe < p;
    const R u_spread = clamp((u_lobe - p) / max(R(1) - p, R(1e-6f)), R(0), R(1));
    const Vec3<R> wi = select(coherent, Vec3<R>{-wo.x, -wo.y, wo.z}, mirror.lobes.sample(wo, u_spread, u));
    const Color f = select(coherent, mirror.f, eval(wo, wi));
    return {wi, select(up, f, Color()), select(up, select(coherent, p, pdf(wo, wi)), R(0)),
            mask_t<R>(coherent & up)};
  }

private:
  R wave_number(int c) const { return constant<R>(2 * pi) / wavelength[c]; }
  /// Sine and cosine of a direction's angle to the normal.
  struct Slant {
    R cos_theta, sin_theta;
    Slant(const R& cosine, const Vec3<R>& w)
        : cos_theta(cosine), sin_theta(safe_sqrt(R(sqr(w.x) + sqr(w.y)))) {}
  };
  /// tau cot(theta) / (2 sigma), at most 10: beyond, no height hides another.
  R steepness(const Slant& w) const {
    const R s = R(2) * sigma * w.sin_theta, t = tau * w.cos_theta;
    return t / max(s, R(0.1f) * t);
  }
  /// S(theta) / cos(theta), eq. 24 and 25.
  R shadowing_over_cos(const Slant& w) const {
    const R a = steepness(w), seen = R(0.5f) * (R(1) + erf(a));
    return seen /
           (w.cos_theta * seen + constant<R>(1 / std::sqrt(pi)) * sigma * w.sin_theta / tau * exp(-a * a));
  }
  /// Standard deviation of the heights that both directions see, eq. 80 to 83. With W = (z0 / sigma)^2 the
  /// implicit equation for z0 reads W exp(W) = (K_o + K_i)^2 / (8 pi): Lambert's function.
  R effective_sigma(const Slant& o, const Slant& i) const {
    const auto K = [&](const Slant& w) { return w.sin_theta / w.cos_theta * (R(1) - erf(steepness(w))); };
    return sigma / sqrt(R(1) + lambert_w(R(sqr(K(o) + K(i)) * constant<R>(1 / (8 * pi)))));
  }

  /// What sampling needs: the spread light by two widths of Beckmann's normals, one as wide as the light
  /// where it peaks, one for its tails, and a little cosine for surfaces as rough as the wavelength is long.
  struct Lobes {
    R narrow, wide, p_cosine;
    R p_narrow() const { return constant<R>(2 / 3.0) * (R(1) - p_cosine); }
    R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
      const R n = facet_reflection_pdf(Beckmann<R>{narrow, narrow}, wo, wi);
      const R w = facet_reflection_pdf(Beckmann<R>{wide, wide}, wo, wi);
      return p_narrow() * (n + R(0.5f) * w) + p_cosine * constant<R>(inv_pi) * max(wi.z, R(0));
    }
    Vec3<R> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
      const R alpha = select(u_lobe < p_narrow(), narrow, wide);
      const Vec3<R> mirrored = reflect(wo, Beckmann<R>{alpha, alpha}.sample_visible(wo, u));
      return select(u_lobe < R(1) - p_cosine, mirrored, square_to_cosine_hemisphere(u));
    }
  };
  /// The coherent part, eq. 72, F exp(-g) S^2 in the mirror direction, and the lobes about it.
  struct Mirror {
    Color f;       ///< delta lobe: its weight / cos
    R probability; ///< of choosing it
    Lobes lobes;
    Mirror(const He& he, const Vec3<R>& wo) {
      const Slant o(max(select(wo.z > R(0), wo.z, R(1)), R(1e-9f)), wo);
      const R seen_sigma = he.effective_sigma(o, o), S_over_cos = he.shadowing_over_cos(o);
      const R slope = R(2) * he.sigma / he.tau;
      R kept(0), all(1e-20f), width2(0);
      for (int c = 0; c < C; ++c) {
        const R wave = he.wave_number(c), g = sqr(R(2) * wave * seen_sigma * o.cos_theta);
        const R F = he.specular_reflectance[c] * fresnel_conductor(o.cos_theta, he.eta[c], he.k[c]);
        f[c] = F * exp(-g) * sqr(S_over_cos) * o.cos_theta;
        kept = kept + F * exp(-g), all = all + F;
        // Terms m of the series are Gaussians of slope, alpha^2 = 4 m / (k tau v_z)^2; m is Poisson's of mean
        // g, from 1 on. Near the horizon most light leaves more steeply than wo: by the facets' slope, or by
        // as much as diffraction turns it there.
        const R cos_i = max(o.cos_theta, min(R(0.5f) * slope + R(1) / sqrt(wave * he.tau), R(0.5f)));
        const R spread_g = sqr(wave * he.sigma * (o.cos_theta + cos_i)), g_safe = max(spread_g, R(0.01f));
        const R m = select(spread_g > R(0.01f), g_safe / (R(1) - exp(-g_safe)), R(1) + R(0.5f) * spread_g);
        width2 = width2 + R(4) * m / sqr(wave * he.tau * (o.cos_theta + cos_i)) * constant<R>(1.0 / C);
      }
      // Near the horizon the lobe reaches directions that see more of the heights than the mirror image does,
      // and holds more light than that loses.
      probability = kept / (kept + max(all - kept, R(0.1f) * all));
      lobes.narrow = sqrt(clamp(width2, R(1e-6f), R(1)));
      lobes.wide = sqrt(clamp(R(3) * width2, R(1e-6f), R(1)));
      lobes.p_cosine = R(0.25f) * max(lobes.narrow - R(0.2f), R(0)); // only wide lobes need it
    }
  };
};

} // namespace nacre
