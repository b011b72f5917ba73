#pragma once
// The homogeneous medium that may fill a coat: it absorbs (a tinted varnish) and scatters (a milky one).
// Lengths are in thicknesses of the coat.

#include "bsdf/coat_interface.h"

namespace nacre {

/// Phase function of Henyey and Greenstein 1941, 1/sr; `c` is the cosine between the directions of travel
/// before and after.
template <class R>
R henyey_greenstein(const R& c, const R& g) {
  const R d = R(1) + g * g - R(2) * g * c;
  return constant<R>(0.25 * inv_pi) * (R(1) - g * g) / (d * sqrt(d));
}
/// Its cosine from a uniform number. The usual inversion ((1 + g^2 - s^2) / 2g, s = (1 - g^2) / (1 + g t), t
/// = 2u - 1) multiplied out, so that g = 0 needs no other branch.
template <class R>
R sample_henyey_greenstein(const R& g, const R& u) {
  const R t = R(2) * u - R(1), g2 = g * g;
  const R n = R(2) * t * (R(1) + g2) + g * (t * t + R(3)) - g2 * g * (R(1) - t * t);
  return clamp(R(n / (R(2) * sqr(R(1) + g * t))), R(-1), R(1));
}

template <class R, int C>
struct CoatMedium {
  Spectrum<R, C> optical_thickness; ///< extinction along the normal
  Spectrum<R, C> albedo;            ///< of single scattering
  R g;                              ///< mean cosine of scattering, in (-1, 1)

  bool is_clear() const { return !any(max_component(optical_thickness) > R(0)); }
  Spectrum<R, C> transmittance(const R& length) const {
    return optical_thickness.map([&](const R& tau) { return R(exp(-min(tau * length, R(60)))); });
  }

  /// A flight of at most `room`. Its length is drawn from the scattering of one channel, chosen by
  /// `u_channel` for the whole path, and weighed by the density of all channels' choices: however long the
  /// path, no channel's weight exceeds C. Absorption ends no path. Source: Wilkie et al. 2014, Hero
  /// Wavelength Spectral Sampling, eq. 6.
  /// @param share  density of the path so far, had this channel been chosen, over the mean density; updated
  struct Flight {
    R length;
    Spectrum<R, C> weight;
    mask_t<R> scattered;
  };
  Flight fly(const R& room, const R& u_channel, const R& u, const mask_t<R>& active,
             Spectrum<R, C>& share) const {
    Spectrum<R, C> rate;
    for (int k = 0; k < C; ++k)
      rate[k] = detached(R(optical_thickness[k] * albedo[k]));
    R chosen = rate[0];
    for (int k = 1; k < C; ++k)
      chosen = select(u_channel * R(float(C)) >= R(float(k)), rate[k], chosen);
    const auto scatters = chosen > R(1e-9f);
    const R t = -log(R(1) - u) / select(scatters, chosen, R(1));
    const mask_t<R> scattered = scatters & (t < room);
    const R length = select(scattered, t, room);
    const Spectrum<R, C> density = share * rate.map([&](const R& mu) {
      return R(select(scattered, mu, R(1)) * exp(-min(R(mu * length), R(60))));
    });
    const R inv_mean = R(1) / max(average(density), R(1e-30f));
    share = select(active, density * inv_mean, share);
    const Spectrum<R, C> passed = transmittance(length) * inv_mean;
    return {length, select(scattered, optical_thickness * albedo * passed, passed), scattered};
  }

  /// Direction of travel after scattering.
  Vec3<R> sample_phase(const Vec3<R>& w, const Vec2<R>& u) const {
    const R c = sample_henyey_greenstein(detached(g), u.x), s = safe_sqrt(R(R(1) - c * c));
    const R phi = constant<R>(2 * pi) * u.y;
    return normalize(Frame<R>::around(w).to_world({s * cos(phi), s * sin(phi), c}));
  }
};

} // namespace nacre
