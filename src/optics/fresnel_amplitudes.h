#pragma once
// Complex amplitudes that a plane interface reflects and refracts, for any pair of media: dielectrics, total
// internal reflection, absorbing media, layers. Source: Born and Wolf, Principles of Optics, 7th ed., eqs.
// 1.5.20 and 1.5.21, written with q = n cos(theta), which is the same for every direction of one ray through
// a stack of layers. p = direction x s for every ray, so at normal incidence r_p = -r_s.

#include "optics/complex.h"
#include "optics/fresnel.h"

namespace nacre {

/// A ray inside one medium of a stack of parallel layers.
template <class R>
struct LayerWave {
  Complex<R> n; ///< index of the medium relative to the outside of the stack
  Complex<R> q; ///< index times cosine of the (complex) angle
};

// At grazing incidence on equal indices every amplitude is 0 / 0: cosines stop at 1e-8, where reflectance
// differs from 1 by less than the rounding of float.
template <class R>
R not_grazing(const R& cos_i) {
  return clamp(cos_i, R(1e-8f), R(1));
}

/// The wave outside, in the direction with cosine `cos_i` in [0, 1].
template <class R>
LayerWave<R> outside_wave(const R& cos_i) {
  return {{R(1), R(0)}, {not_grazing(cos_i), R(0)}};
}
/// That ray continued in a layer of index eta + i k relative to the outside.
template <class R>
LayerWave<R> layer_wave(const R& cos_i, const R& eta, const R& k) {
  const R c = not_grazing(cos_i);
  // n^2 - sin^2, as a sum that is exact for eta = 1
  return {{eta, k}, sqrt_upper(Complex<R>{(eta - R(1)) * (eta + R(1)) - k * k + c * c, R(2) * eta * k})};
}

template <class R>
struct FresnelAmplitudes {
  Complex<R> r_s, r_p, t_s, t_p; ///< of the electric field; t_p with complex n as in Born and Wolf

  PolarizedReflectance<R> reflectance() const { return {norm(r_s), norm(r_p)}; }
};

template <class R>
FresnelAmplitudes<R> interface_amplitudes(const LayerWave<R>& from, const LayerWave<R>& to) {
  const Complex<R> n1 = from.n * from.n, n2 = to.n * to.n;
  const Complex<R> s = from.q + to.q, p = n2 * from.q + n1 * to.q;
  const Complex<R> q2 = from.q + from.q;
  return {(from.q - to.q) / s, (n2 * from.q - n1 * to.q) / p, q2 / s, from.n * to.n * q2 / p};
}

/// Amplitudes at one interface.
/// @param cos_i   in [0, 1]
/// @param eta, k  index of the far side relative to the near side; eta < 1 may reflect totally
template <class R>
FresnelAmplitudes<R> fresnel_amplitudes(const R& cos_i, const R& eta, const R& k = R(0)) {
  return interface_amplitudes(outside_wave(cos_i), layer_wave(cos_i, eta, k));
}

/// How far total internal reflection shifts each polarisation, radians in [-pi, 0]; 0 where it is not total.
template <class R>
struct TotalReflectionPhase {
  R s, p;
  /// What a rhomb adds up: the phase of s less that of p, positive.
  R relative() const { return s - p; }
};

/// @param cos_i  in (0, 1]
/// @param eta    index of the far side / index of the near side
/// Source: Born and Wolf, eq. 1.5.60: tan(s / 2) = -g / cos, tan(p / 2) = -g / (eta^2 cos), g^2 = sin^2 -
/// eta^2.
template <class R>
TotalReflectionPhase<R> total_reflection_phase(const R& cos_i, const R& eta) {
  const R c = not_grazing(cos_i);
  const R g = safe_sqrt((R(1) - eta) * (R(1) + eta) - c * c);
  return {R(-2) * atan2(g, c), R(-2) * atan2(g, R(eta * eta * c))};
}

} // namespace nacre
