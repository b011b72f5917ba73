#pragma once
// The two functions that He et al. 1991 leave to the computer: the series of their distribution and the root
// of their implicit equation. Both in fixed numbers of steps, without overflow, differentiable.

#include "core/number.h"

namespace nacre {

/// Lambert's W for t >= 0: W exp(W) = t, relative error below 1e-9 in double.
/// Four steps of Iacono and Boyd 2017, New approximations to the principal real-valued branch of the Lambert
/// W-function, eq. 6, which converges quadratically from any W > 0.
template <class R>
R lambert_w(const R& t) {
  const auto small = t < R(0.01f);
  const R x = select(small, R(1), t), log_x = log(x);
  const R start = log(R(1) + x);
  R w = start * (R(1) - log(R(1) + start) / (R(2) + start));
  for (int i = 0; i < 4; ++i)
    w = w / (R(1) + w) * (R(1) + log_x - log(w));
  const R s = select(small, t, R(0)); // its own series, for the logarithms end at 0
  const R series =
      s * (R(1) - s * (R(1) - s * (R(1.5f) - s * (constant<R>(8 / 3.0) - s * constant<R>(125 / 24.0)))));
  return select(small, series, w);
}

namespace he_series_detail {
inline constexpr float split = 16;

/// The terms one by one, g <= 16: what the 48 terms leave out is below 1e-10 of the sum at X = 0.
template <class R>
R few(const R& g, const R& X) {
  R weight = exp(-g), sum(0);
  for (int m = 1; m <= 48; ++m) {
    sum = sum + weight * constant<R>(1.0 / m) * exp(-X * constant<R>(1.0 / m));
    weight = weight * g * constant<R>(1.0 / (m + 1));
  }
  return sum;
}

/// m log(m / g) - m + g over g, for q = m / g; by series near q = 1, where the terms cancel.
template <class R>
R poisson_exponent(const R& q) {
  const R z = (q - R(1)) / (q + R(1)), z2 = z * z;
  const auto near = z2 < R(0.02f);
  const R y = select(near, z2, R(0));
  // log q = 2 atanh z, q = (1 + z) / (1 - z)
  const R tail = constant<R>(1 / 3.0) +
                 y * (constant<R>(1 / 5.0) +
                      y * (constant<R>(1 / 7.0) + y * (constant<R>(1 / 9.0) + y * constant<R>(1 / 11.0))));
  const R series = R(2) * z2 * (R(1) + z * (R(1) + z) * tail) / (R(1) - z);
  return select(near, series, q * log(q) - q + R(1));
}

/// The terms as a function of continuous m, g >= 16: the sum is its integral but for exp(-16), and the
/// trapezoidal rule in sqrt(m), in which terms are nearly a Gaussian, gives that to 1e-7 with 13 nodes about
/// the largest.
template <class R>
R many(const R& g, const R& X) {
  // The largest term: log q = X / m^2 with q = m / g. Newton from above, where the function is convex.
  const R r = X / (g * g);
  R q = sqrt(R(1) + R(2) * r);
  for (int i = 0; i < 4; ++i) {
    const R log_q = log(q);
    q = q - (q * q * log_q - r) / (q * (R(2) * log_q + R(1)));
  }
  q = max(q, R(1));
  const R root = sqrt(q * g), step = R(0.5f) / sqrt(R(1) + R(2) * log(q));
  R sum(0);
  for (int j = -6; j <= 6; ++j) {
    const R m = sqr(root + step * R(float(j))), inv = R(1) / m;
    const R stirling = inv * (constant<R>(1 / 12.0) - inv * inv * constant<R>(1 / 360.0));
    sum = sum + inv * exp(-(g * poisson_exponent(R(m / g)) + X * inv + stirling));
  }
  return sum * step * constant<R>(2 / std::sqrt(2 * pi)) / g; // dm = 2 sqrt(m) d sqrt(m)
}
} // namespace he_series_detail

/// Sum over m >= 1 of g^(m - 1) exp(-g) / (m! m) exp(-X / m), the series of He et al. 1991, eq. 78, without
/// its first g. Relative error below 1e-5 where the sum is not negligible against its value at X = 0.
/// @param g  phase variance of the heights, >= 0
/// @param X  (v_xy tau / 2)^2, >= 0
template <class R>
R he_series(const R& g, const R& X) {
  using namespace he_series_detail;
  const auto is_few = g < R(split);
  const R zero(0);
  const R a = any(is_few) ? few(R(min(g, R(split))), X) : zero;
  const R b = all(is_few) ? zero : many(R(max(g, R(split))), X);
  return select(is_few, a, b);
}

} // namespace nacre
