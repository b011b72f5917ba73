#pragma once
// Mueller matrices of reflection and refraction at a smooth interface. Conventions:
// - A ray's frame is (s, p, d): s perpendicular to the plane of incidence, the same for all rays; d where the
//   light goes; p = d x s, so that s x p = d.
// - Stokes vector: I = |Es|^2 + |Ep|^2, Q = |Es|^2 - |Ep|^2, U = 2 Re(Es Ep*), V = -2 Im(Es Ep*), for waves
//   exp(i k x - i omega t): positive V turns from s to p for one who faces the light (positive helicity).
// - I counts radiant flux through a surface element: refraction carries the factor of the changed beam
//   section and speed, and what is reflected and refracted sums to what arrives. Radiance gains eta^2 beside.
// Sources: Collett 2005, Field Guide to Polarization, sections on Fresnel reflection and transmission; Wilkie
// and Weidlich 2012, Polarised Light in Computer Graphics; the signs of amplitudes: Born and Wolf,
// eq. 1.5.21.

#include "optics/fresnel_amplitudes.h"

#include <array>

namespace nacre {

template <class R>
using Stokes = std::array<R, 4>; ///< I, Q, U, V

template <class R>
struct Mueller {
  std::array<std::array<R, 4>, 4> rows;

  Mueller() {
    for (auto& row : rows)
      row.fill(R(0));
  }
  friend Stokes<R> operator*(const Mueller& m, const Stokes<R>& s) {
    Stokes<R> y;
    for (int i = 0; i < 4; ++i)
      y[i] = m.rows[i][0] * s[0] + m.rows[i][1] * s[1] + m.rows[i][2] * s[2] + m.rows[i][3] * s[3];
    return y;
  }
  /// First b, then a.
  friend Mueller operator*(const Mueller& a, const Mueller& b) {
    Mueller y;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        for (int k = 0; k < 4; ++k)
          y.rows[i][j] = y.rows[i][j] + a.rows[i][k] * b.rows[k][j];
    return y;
  }
};

/// Of an element that scales Es by a and Ep by b, times `flux`.
template <class R>
Mueller<R> mueller_of_amplitudes(const Complex<R>& a, const Complex<R>& b, const R& flux = R(1)) {
  const R s = flux * norm(a), p = flux * norm(b);
  const Complex<R> cross = flux * (a * conj(b));
  Mueller<R> m;
  m.rows[0][0] = m.rows[1][1] = R(0.5f) * (s + p);
  m.rows[0][1] = m.rows[1][0] = R(0.5f) * (s - p);
  m.rows[2][2] = m.rows[3][3] = cross.re;
  m.rows[2][3] = cross.im;
  m.rows[3][2] = -cross.im;
  return m;
}

/// Reflection; at total internal reflection a retarder.
/// @param cos_i   in [0, 1]
/// @param eta, k  index of the far side relative to the near side; k = 0 for a dielectric
template <class R>
Mueller<R> mueller_reflection(const R& cos_i, const R& eta, const R& k = R(0)) {
  const auto amplitudes = fresnel_amplitudes(cos_i, eta, k);
  return mueller_of_amplitudes(amplitudes.r_s, amplitudes.r_p);
}

/// Refraction into a dielectric; 0 at total reflection.
template <class R>
Mueller<R> mueller_refraction(const R& cos_i, const R& eta) {
  const auto near = outside_wave(cos_i), far = layer_wave(cos_i, eta, R(0));
  const auto amplitudes = interface_amplitudes(near, far);
  return mueller_of_amplitudes(amplitudes.t_s, amplitudes.t_p, R(far.q.re / near.q.re));
}

/// The frame turned by `angle` radians from s towards p: what a ray's Stokes vector is in the frame of the
/// next plane of incidence. Source: Collett 2005, rotation of the coordinate system.
template <class R>
Mueller<R> mueller_rotation(const R& angle) {
  const R c = cos(R(angle + angle)), s = sin(R(angle + angle));
  Mueller<R> m;
  m.rows[0][0] = m.rows[3][3] = R(1);
  m.rows[1][1] = m.rows[2][2] = c;
  m.rows[1][2] = s;
  m.rows[2][1] = -s;
  return m;
}

} // namespace nacre
