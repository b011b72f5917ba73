#pragma once
// A hair: a rough dielectric cylinder of absorbing medium whose cuticle scales are tilted. Light is reflected
// (R), passes through (TT), passes after one inner reflection (TRT) or more (the rest). Each lobe is a
// product of a longitudinal M, an azimuthal N and an attenuation A. Keeps all energy without absorption, for
// every offset h. Local frame: x along the fibre, so f covers the whole sphere and is scaled to f |cos_i| =
// the fibre's scattering, |cos_i| = |wi.z|. Not reciprocal at a given h: that is where the viewer's ray hits.
// Source: Chiang et al. 2016, A Practical and Controllable Hair and Fur Model for Production Path Tracing;
// d'Eon et al. 2011, An Energy-Conserving Hair Reflectance Model; Pharr 2016, The Implementation of a Hair
// Scattering Model.

#include "bsdf/model.h"
#include "optics/fresnel.h"

namespace nacre {

/// exp(-x) I0(x), x >= 0, I0 the modified Bessel function: Abramowitz and Stegun 1964, 9.8.1 and 9.8.2,
/// relative error below 5e-7.
template <class R>
R scaled_bessel_i0(const R& x) {
  const auto series = [](const R& t, auto... c) {
    R y(0);
    ((y = y * t + constant<R>(c)), ...);
    return y;
  };
  const auto small = x < R(3.75f);
  const R near = select(small, x, R(0)), far = R(3.75f) / select(small, R(3.75f), x);
  const R t = sqr(near * constant<R>(1 / 3.75));
  return select(
      small, R(exp(-near) * series(t, 0.0045813, 0.0360768, 0.2659732, 1.2067492, 3.0899424, 3.5156229, 1.0)),
      R(series(far, 0.00392377, -0.01647633, 0.02635537, -0.02057706, 0.00916281, -0.00157565, 0.00225319,
               0.01328592, 0.39894228) *
        sqrt(far * constant<R>(1 / 3.75))));
}

/// Absorption per fibre radius, linear RGB, of a concentration of both pigments of hair; eumelanin of 0.3 is
/// blond, 1.3 brown, 8 black. Source: d'Eon et al. 2011, section 6.1.
inline std::array<double, 3> hair_absorption(double eumelanin, double pheomelanin) {
  return {0.419 * eumelanin + 0.187 * pheomelanin, 0.697 * eumelanin + 0.4 * pheomelanin,
          1.37 * eumelanin + 1.05 * pheomelanin};
}

template <class R, int C>
struct Hair : ModelBase<R, C> {
  using typename ModelBase<R, C>::Color;
  Color sigma_a, color;
  R beta_m, beta_n, tilt, ior, h;

  static constexpr std::string_view name = "hair";
  static constexpr std::string_view source = "Chiang et al. 2016; Pharr 2016";
  static constexpr std::string_view summary = "a hair: absorbing rough fibre along x";
  static constexpr Laws laws{.reciprocal = false, .transmits = true, .thin = true};
  static constexpr auto parameters() {
    return std::tuple{
        Parameter{&Hair::sigma_a, "sigma_a", "1/radius", 0, 20, 0.25, "absorption, per radius of the fibre"},
        Parameter{&Hair::color, "color", "1", 0.001, 1, 1.0,
                  "colour of a full head; the absorption that gives it is added to sigma_a"},
        Parameter{&Hair::beta_m, "beta_m", "1", 0.05, 1, 0.3, "roughness along the fibre"},
        Parameter{&Hair::beta_n, "beta_n", "1", 0.05, 1, 0.3, "roughness around the fibre"},
        Parameter{&Hair::tilt, "tilt", "rad", 0, 0.2, 0.035, "angle of the cuticle's scales"},
        Parameter{&Hair::ior, "ior", "1", 1.05, 2, 1.55, "index of the fibre / index outside"},
        Parameter{&Hair::h, "h", "1", -1, 1, 0.3, "where the ray meets the fibre: offset / radius"}};
  }

  Color eval(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const Fibre fibre(*this, wo);
    const auto lobe = fibre.lobes(wi);
    Color f;
    for (std::size_t p = 0; p < n_lobes; ++p)
      f = f + fibre.attenuation[p] * lobe[p];
    // 1e-6: along the horizon of the frame f has no bound, only f |cos_i| does
    return f / max(abs(wi.z), R(1e-6f));
  }
  R pdf(const Vec3<R>& wo, const Vec3<R>& wi) const {
    const Fibre fibre(*this, wo);
    const auto lobe = fibre.lobes(wi);
    const auto share = fibre.shares();
    R sum(0);
    for (std::size_t p = 0; p < n_lobes; ++p)
      sum = sum + share[p] * lobe[p];
    return sum;
  }
  BsdfSample<R, C> sample(const Vec3<R>& wo, const R& u_lobe, const Vec2<R>& u) const {
    const Fibre fibre(*this, wo);
    const auto share = fibre.shares();
    // The lobe, and what is left of u_lobe as a number of its own.
    R low(0), width = share[0], sin_o = fibre.sin_tilted[0], cos_o = fibre.cos_tilted[0], v = fibre.v[0],
              turn = fibre.turn[0];
    R sum = share[0];
    mask_t<R> last(false);
    for (std::size_t p = 1; p < n_lobes; ++p) {
      const auto here = u_lobe >= sum;
      low = select(here, sum, low), width = select(here, share[p], width);
      sin_o = select(here, fibre.sin_tilted[p], sin_o), cos_o = select(here, fibre.cos_tilted[p], cos_o);
      v = select(here, fibre.v[p], v);
      if (p + 1 < n_lobes) turn = select(here, fibre.turn[p], turn);
      last = here;
      sum = sum + share[p];
    }
    const R u_turn = clamp((u_lobe - low) / max(width, R(1e-9f)), R(0), R(1));

    // Longitudinal: von Mises and Fisher's distribution about the mirrored direction (d'Eon et al. 2013).
    const R q = exp(R(-2) / v);
    const R c = clamp(R(1) + v * log(max(u.x + (R(1) - u.x) * q, R(1e-12f))), R(-1), R(1));
    const R sin_i = -c * sin_o + safe_sqrt(R(R(1) - c * c)) * cos(constant<R>(2 * pi) * u.y) * cos_o;
    const R cos_i = safe_sqrt(R(R(1) - sin_i * sin_i));
    // Azimuthal: the trimmed logistic by inversion; the rest evenly.
    const R edge = fibre.edge / (R(1) + fibre.edge), inside = R(1) - R(2) * edge;
    const R odds = max(u_turn * inside + edge, R(1e-12f)) / max((R(1) - u_turn) * inside + edge, R(1e-12f));
    const R around = clamp(fibre.s * log(odds), constant<R>(-pi), constant<R>(pi));
    const R phi = fibre.phi_o + select(last, constant<R>(2 * pi) * u_turn, turn + around);
    const Vec3<R> wi{sin_i, cos_i * cos(phi), cos_i * sin(phi)};
    return {wi, eval(wo, wi), pdf(wo, wi), mask_t<R>(false)};
  }

private:
  static constexpr std::size_t n_lobes = 4; // R, TT, TRT and the rest

  /// What the fibre does with light for one viewer.
  struct Fibre {
    std::array<Color, n_lobes> attenuation;
    std::array<R, n_lobes> v, sin_tilted, cos_tilted; ///< variance of M; wo as the tilted scales see it
    std::array<R, n_lobes - 1> turn;                  ///< azimuth by which the lobe's centre leaves wo's
    R s, edge;                                        ///< scale of the logistic; exp(-pi / s)
    R phi_o;

    Fibre(const Hair& m, const Vec3<R>& wo) {
      const R sin_o = clamp(wo.x, R(-1), R(1)), cos_o = safe_sqrt(R(R(1) - sin_o * sin_o));
      phi_o = azimuth(wo);
      // eq. 7 and 8 of Chiang et al. 2016
      const R b = m.beta_m, v0 = sqr(R(0.726f) * b + R(0.812f) * b * b + R(3.7f) * power20(b)), n = m.beta_n;
      v = {v0, R(R(0.25f) * v0), R(R(4) * v0), R(R(4) * v0)};
      s = constant<R>(0.626657068657750) * // sqrt(pi / 8)
          (R(0.265f) * n + R(1.194f) * n * n + R(5.372f) * power20(n) * n * n);
      edge = exp(constant<R>(-pi) / s);

      // The scales turn wo by -2, 1 and 4 times their tilt.
      const R times[] = {R(-2), R(1), R(4), R(0)};
      for (std::size_t p = 0; p < n_lobes; ++p) {
        const R angle = m.tilt * times[p], sin_a = sin(angle), cos_a = cos(angle);
        sin_tilted[p] = sin_o * cos_a + cos_o * sin_a;
        cos_tilted[p] = abs(cos_o * cos_a - sin_o * sin_a);
      }

      // Inside the cylinder, seen along the fibre (Marschner et al. 2003's modified index).
      const R cos_gamma = safe_sqrt(R(R(1) - m.h * m.h)), gamma_o = atan2(m.h, cos_gamma);
      const R sin_t = sin_o / m.ior, cos_t = sqrt(R(1) - sin_t * sin_t);
      const R sin_gamma_t = m.h * cos_o / (m.ior * cos_t),
              cos_gamma_t = safe_sqrt(R(R(1) - sqr(sin_gamma_t)));
      const R gamma_t = atan2(sin_gamma_t, cos_gamma_t);
      for (std::size_t p = 0; p < turn.size(); ++p)
        turn[p] = R(float(2 * p)) * gamma_t - R(2) * gamma_o + constant<R>(double(p) * pi);

      const R F = fresnel_dielectric(R(cos_o * cos_gamma), m.ior).reflectance;
      const R path = R(2) * cos_gamma_t / cos_t;
      const R per_color = R(1) / color_scale(n);
      const Color T = zip(m.sigma_a, m.color, [&](const R& sigma, const R& c) {
        return R(exp(-min((sigma + sqr(log(c) * per_color)) * path, R(80)))); // exp(-80) is nothing
      });
      attenuation[0] = Color(F);
      attenuation[1] = T * sqr(R(1) - F);
      attenuation[2] = attenuation[1] * T * F;
      // F = 1 at grazing, where nothing enters: 1e-6 keeps 0 / 0 from the sum
      attenuation[3] = zip(attenuation[2], T, [&](const R& a, const R& t) {
        return R(a * t * F / max(R(1) - t * F, R(1e-6f)));
      });
    }

    /// M N of each lobe for light from wi, 1/sr.
    std::array<R, n_lobes> lobes(const Vec3<R>& wi) const {
      const R sin_i = clamp(wi.x, R(-1), R(1)), cos_i = safe_sqrt(R(R(1) - sin_i * sin_i));
      const R phi = azimuth(wi) - phi_o;
      std::array<R, n_lobes> f;
      for (std::size_t p = 0; p < n_lobes; ++p)
        f[p] = longitudinal(sin_i, cos_i, p) *
               (p + 1 < n_lobes ? logistic(R(phi - turn[p])) : constant<R>(0.5 * inv_pi));
      return f;
    }
    /// Probability of each lobe in sampling: its attenuation, averaged over channels.
    std::array<R, n_lobes> shares() const {
      std::array<R, n_lobes> a;
      R sum(0);
      for (std::size_t p = 0; p < n_lobes; ++p)
        a[p] = average(attenuation[p]), sum = sum + a[p];
      const R inv = R(1) / max(sum, R(1e-20f));
      for (R& x : a)
        x = x * inv;
      return a;
    }

  private:
    /// M of d'Eon et al. 2011, eq. 7: exp(-b) I0(a) / (2 v sinh(1 / v)), with the exponentials drawn together
    /// so that none overflows.
    R longitudinal(const R& sin_i, const R& cos_i, std::size_t p) const {
      const R inv = R(1) / v[p], a = cos_i * cos_tilted[p] * inv, b = sin_i * sin_tilted[p] * inv;
      return scaled_bessel_i0(a) * exp(min(a - b - inv, R(0))) * inv / (R(1) - exp(R(-2) * inv));
    }
    /// N of Chiang et al. 2016: a logistic density on (-pi, pi), trimmed and normalised.
    R logistic(const R& phi_any) const {
      const R turns = floor((phi_any + constant<R>(pi)) * constant<R>(0.5 * inv_pi));
      const R x = abs(phi_any - constant<R>(2 * pi) * turns), e = exp(-x / s);
      return e / (s * sqr(R(1) + e)) * (R(1) + edge) / (R(1) - edge);
    }
    static R azimuth(const Vec3<R>& w) {
      const auto along = sqr(w.y) + sqr(w.z) < R(1e-30f); // along the fibre there is none
      return atan2(select(along, R(0), w.z), select(along, R(1), w.y));
    }
    static R power20(const R& x) {
      const R x4 = sqr(sqr(x));
      return sqr(sqr(x4)) * x4;
    }
    /// Chiang et al. 2016, eq. 9: sigma_a = (ln color / this)^2.
    static R color_scale(const R& n) {
      return R(5.969f) +
             n * (R(-0.215f) + n * (R(2.532f) + n * (R(-10.73f) + n * (R(5.574f) + n * R(0.245f)))));
    }
  };
};

} // namespace nacre
