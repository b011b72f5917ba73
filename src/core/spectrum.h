#pragma once
// Spectrum<R, C>: a quantity per channel. C is 1 (luminance), 3 (linear RGB) or 4 (the sampled wavelengths of
// a path); a model never asks which.

#include "core/number.h"

#include <array>

namespace nacre {

template <class R, int C>
struct Spectrum {
  std::array<R, C> c;

  Spectrum() : Spectrum(R(0)) {}
  explicit Spectrum(const R& all_channels) { c.fill(all_channels); }
  explicit Spectrum(const std::array<R, C>& channels) : c(channels) {}

  R& operator[](int i) { return c[i]; }
  const R& operator[](int i) const { return c[i]; }

  Spectrum& operator+=(const Spectrum& b) { return *this = *this + b; }
  Spectrum& operator-=(const Spectrum& b) { return *this = *this - b; }
  Spectrum& operator*=(const Spectrum& b) { return *this = *this * b; }
  Spectrum& operator*=(const R& b) { return *this = *this * b; }

  friend Spectrum operator+(const Spectrum& a, const Spectrum& b) {
    return zip(a, b, [](const R& x, const R& y) { return R(x + y); });
  }
  friend Spectrum operator-(const Spectrum& a, const Spectrum& b) {
    return zip(a, b, [](const R& x, const R& y) { return R(x - y); });
  }
  friend Spectrum operator*(const Spectrum& a, const Spectrum& b) {
    return zip(a, b, [](const R& x, const R& y) { return R(x * y); });
  }
  friend Spectrum operator/(const Spectrum& a, const Spectrum& b) {
    return zip(a, b, [](const R& x, const R& y) { return R(x / y); });
  }
  friend Spectrum operator*(const Spectrum& a, const R& s) { return a * Spectrum(s); }
  friend Spectrum operator*(const R& s, const Spectrum& a) { return a * Spectrum(s); }
  friend Spectrum operator/(const Spectrum& a, const R& s) { return a * (R(1) / s); }
  friend Spectrum operator-(const Spectrum& a) { return a * R(-1); }

  /// f applied to each channel.
  template <class F>
  Spectrum map(F f) const {
    Spectrum y;
    for (int i = 0; i < C; ++i)
      y.c[i] = f(c[i]);
    return y;
  }
  template <class F>
  friend Spectrum zip(const Spectrum& a, const Spectrum& b, F f) {
    Spectrum y;
    for (int i = 0; i < C; ++i)
      y.c[i] = f(a.c[i], b.c[i]);
    return y;
  }
};

template <class R, int C, class M>
Spectrum<R, C> select(const M& mask, const Spectrum<R, C>& yes, const Spectrum<R, C>& no) {
  return zip(yes, no, [&](const R& a, const R& b) { return R(select(mask, a, b)); });
}
template <class R, int C>
R max_component(const Spectrum<R, C>& a) {
  R m = a[0];
  for (int i = 1; i < C; ++i)
    m = max(m, a[i]);
  return m;
}
template <class R, int C>
R average(const Spectrum<R, C>& a) {
  R sum = a[0];
  for (int i = 1; i < C; ++i)
    sum = sum + a[i];
  return sum * constant<R>(1.0 / C);
}

} // namespace nacre
