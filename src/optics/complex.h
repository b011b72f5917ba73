#pragma once
// Complex numbers over any number type: std::complex promises nothing for packs and duals. Waves are
// exp(i k x - i omega t), so an absorbing index is eta + i k and a decaying wave has a positive imaginary
// part (Born and Wolf, Principles of Optics, 7th ed.).

#include "core/number.h"

namespace nacre {

template <class R>
struct Complex {
  R re, im;

  friend Complex operator+(const Complex& a, const Complex& b) { return {a.re + b.re, a.im + b.im}; }
  friend Complex operator-(const Complex& a, const Complex& b) { return {a.re - b.re, a.im - b.im}; }
  friend Complex operator*(const Complex& a, const Complex& b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
  friend Complex operator*(const R& s, const Complex& a) { return {s * a.re, s * a.im}; }
  friend Complex operator/(const Complex& a, const Complex& b) {
    // The floor keeps 0 / 0 at 0; lower, the derivative of the quotient would leave the range of float.
    return R(R(1) / max(norm(b), R(1e-18f))) * (a * conj(b));
  }
  friend Complex operator-(const Complex& a) { return {-a.re, -a.im}; }
  friend Complex conj(const Complex& a) { return {a.re, -a.im}; }
  /// |a|^2
  friend R norm(const Complex& a) { return a.re * a.re + a.im * a.im; }
};

/// The square root in the first quadrant of a number whose imaginary part is not negative. The larger part is
/// a sum of one sign, the other comes from the product: a difference would leave no digits in float.
template <class R>
Complex<R> sqrt_upper(const Complex<R>& a) {
  const R larger = safe_sqrt(R(0.5f) * (safe_sqrt(norm(a)) + abs(a.re)));
  const R smaller = R(0.5f) * a.im / select(larger > R(0), larger, R(1));
  const auto right = a.re > R(0);
  return {select(right, larger, smaller), select(right, smaller, larger)};
}

/// exp(i z); the imaginary part of z must not be below -80, where float overflows.
template <class R>
Complex<R> exp_i(const Complex<R>& z) {
  const R size = exp(-min(z.im, R(80))); // beyond it the factor is 0 in float
  return {size * cos(z.re), size * sin(z.re)};
}

} // namespace nacre
