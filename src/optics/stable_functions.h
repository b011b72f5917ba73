#pragma once
// Functions that stay exact and differentiable where their textbook form is 0 / 0 or a difference of equals,
// and the gamma function, for every number type.

#include "core/number.h"

namespace nacre {

/// (exp(x) - 1) / x, 1 at x = 0. Relative error below 1e-8 in double.
template <class R>
R expm1_over(const R& x) {
  const auto small = abs(x) < R(0.3f);
  const R t = select(small, x, R(0)), y = select(small, R(1), x);
  const R series =
      R(1) + t * (R(0.5f) + t * (constant<R>(1.0 / 6) +
                                 t * (constant<R>(1.0 / 24) +
                                      t * (constant<R>(1.0 / 120) +
                                           t * (constant<R>(1.0 / 720) + t * constant<R>(1.0 / 5040))))));
  return select(small, series, (exp(y) - R(1)) / y);
}

/// log(1 + x) / x for x > -1, 1 at x = 0. Relative error below 1e-8 in double.
template <class R>
R log1p_over(const R& x) {
  const auto small = abs(x) < R(0.3f);
  const R t = select(small, x, R(0)), y = select(small, R(1), x);
  const R a = t / (R(2) + t), a2 = a * a; // log(1 + x) = 2 artanh(x / (2 + x))
  const R series =
      R(2) / (R(2) + t) *
      (R(1) + a2 * (constant<R>(1.0 / 3) +
                    a2 * (constant<R>(1.0 / 5) + a2 * (constant<R>(1.0 / 7) + a2 * constant<R>(1.0 / 9)))));
  return select(small, series, log(max(R(1) + y, R(1e-30f))) / y);
}

/// log(1 + u (exp(x) - 1)) / x, which rises from 0 to 1 with u in [0, 1]: the inverse of a distribution
/// function made of powers; u at x = 0. For x up to 80.
template <class R>
R exponential_blend(const R& u, const R& x) {
  const R slope = u * expm1_over(x);
  return slope * log1p_over(R(x * slope));
}

/// log of the gamma function for x in (0, 1000). Absolute error below 1e-9 in double.
/// Source: Abramowitz and Stegun 1964, 6.1.15 (recurrence) and 6.1.41 (Stirling).
template <class R>
R log_gamma(const R& x) {
  const R product = x * (x + R(1)) * (x + R(2)) * (x + R(3)) * (x + R(4)) * (x + R(5)) * (x + R(6));
  const R z = x + R(7), inv = R(1) / z, inv2 = inv * inv;
  const R tail =
      inv * (constant<R>(1.0 / 12) - inv2 * (constant<R>(1.0 / 360) - inv2 * constant<R>(1.0 / 1260)));
  return (z - R(0.5f)) * log(z) - z + constant<R>(0.5 * std::log(2 * pi)) + tail - log(product);
}

} // namespace nacre
