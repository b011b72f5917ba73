#pragma once
// Dual numbers: a value and its exact derivatives with respect to N parameters. T is double (reference) or
// Pack (many directions at once). The arithmetic is forward-mode automatic differentiation; every rule is the
// chain rule, written once in `chain`.

#include "core/pack.h"

#include <array>

namespace nacre {

template <class T, int N>
struct Dual {
  T v = T(0);           ///< value (never T{0}: a pack would take that as a list of lanes)
  std::array<T, N> d{}; ///< d[i] = dv / d(parameter i)

  Dual() { d.fill(T(0)); }
  Dual(T value) : v(value) { d.fill(T(0)); } // NOLINT: numbers convert implicitly
  template <class S>
  requires(std::is_arithmetic_v<S> && !std::is_same_v<S, T>) Dual(S value)
      : Dual(T(static_cast<float_of_t<S>>(value))) {} // NOLINT
  /// The i-th parameter itself: derivative 1 with respect to itself.
  static Dual variable(T value, int i) {
    Dual x(value);
    x.d[i] = T(1);
    return x;
  }

private:
  template <class S>
  using float_of_t = std::conditional_t<std::is_same_v<T, double>, double, float>;
};

template <class T, int N>
struct MaskOf<Dual<T, N>> {
  using type = mask_t<T>;
};
template <class T, int N>
struct ValueOf<Dual<T, N>> {
  using type = T;
};

namespace dual {
/// f(x) with value `v` and slope `slope` at x.
template <class T, int N>
Dual<T, N> chain(const T& v, const T& slope, const Dual<T, N>& x) {
  Dual<T, N> y(v);
  for (int i = 0; i < N; ++i)
    y.d[i] = slope * x.d[i];
  return y;
}
/// f(a, b) with value `v` and partial slopes at (a, b).
template <class T, int N>
Dual<T, N> chain(const T& v, const T& slope_a, const Dual<T, N>& a, const T& slope_b, const Dual<T, N>& b) {
  Dual<T, N> y(v);
  for (int i = 0; i < N; ++i)
    y.d[i] = slope_a * a.d[i] + slope_b * b.d[i];
  return y;
}
} // namespace dual

/// Number types that mix with Dual<T, N> in an expression: T itself and plain numbers.
template <class S, class T>
concept ConstantFor = std::is_same_v<S, T> || std::is_arithmetic_v<S>;

template <class T, int N>
Dual<T, N> operator+(const Dual<T, N>& a, const Dual<T, N>& b) {
  Dual<T, N> y(a.v + b.v);
  for (int i = 0; i < N; ++i)
    y.d[i] = a.d[i] + b.d[i];
  return y;
}
template <class T, int N>
Dual<T, N> operator-(const Dual<T, N>& a, const Dual<T, N>& b) {
  Dual<T, N> y(a.v - b.v);
  for (int i = 0; i < N; ++i)
    y.d[i] = a.d[i] - b.d[i];
  return y;
}
template <class T, int N>
Dual<T, N> operator*(const Dual<T, N>& a, const Dual<T, N>& b) {
  return dual::chain(T(a.v * b.v), b.v, a, a.v, b);
}
template <class T, int N>
Dual<T, N> operator/(const Dual<T, N>& a, const Dual<T, N>& b) {
  const T inv = T(1) / b.v, q = a.v * inv;
  return dual::chain(q, inv, a, T(-q * inv), b);
}
template <class T, int N>
Dual<T, N> operator-(const Dual<T, N>& a) {
  return dual::chain(T(-a.v), T(-1), a);
}
template <class T, int N, ConstantFor<T> S>
Dual<T, N> operator+(const Dual<T, N>& a, S b) {
  Dual<T, N> y = a;
  y.v += Dual<T, N>(b).v;
  return y;
}
template <class T, int N, ConstantFor<T> S>
Dual<T, N> operator+(S a, const Dual<T, N>& b) {
  return b + a;
}
template <class T, int N, ConstantFor<T> S>
Dual<T, N> operator-(const Dual<T, N>& a, S b) {
  Dual<T, N> y = a;
  y.v -= Dual<T, N>(b).v;
  return y;
}
template <class T, int N, ConstantFor<T> S>
Dual<T, N> operator-(S a, const Dual<T, N>& b) {
  return -b + a;
}
template <class T, int N, ConstantFor<T> S>
Dual<T, N> operator*(const Dual<T, N>& a, S b) {
  const T s = Dual<T, N>(b).v;
  return dual::chain(T(a.v * s), s, a);
}
template <class T, int N, ConstantFor<T> S>
Dual<T, N> operator*(S a, const Dual<T, N>& b) {
  return b * a;
}
template <class T, int N, ConstantFor<T> S>
Dual<T, N> operator/(const Dual<T, N>& a, S b) {
  return a * (T(1) / Dual<T, N>(b).v);
}
template <class T, int N, ConstantFor<T> S>
Dual<T, N> operator/(S a, const Dual<T, N>& b) {
  return Dual<T, N>(a) / b;
}
template <class T, int N, class S>
Dual<T, N>& operator+=(Dual<T, N>& a, const S& b) {
  return a = a + b;
}
template <class T, int N, class S>
Dual<T, N>& operator-=(Dual<T, N>& a, const S& b) {
  return a = a - b;
}
template <class T, int N, class S>
Dual<T, N>& operator*=(Dual<T, N>& a, const S& b) {
  return a = a * b;
}
template <class T, int N, class S>
Dual<T, N>& operator/=(Dual<T, N>& a, const S& b) {
  return a = a / b;
}

// Comparisons look at values only.
#define NACRE_DUAL_COMPARE(op)                                                                               \
  template <class T, int N>                                                                                  \
  mask_t<T> operator op(const Dual<T, N>& a, const Dual<T, N>& b) {                                          \
    return a.v op b.v;                                                                                       \
  }                                                                                                          \
  template <class T, int N, ConstantFor<T> S>                                                                \
  mask_t<T> operator op(const Dual<T, N>& a, S b) {                                                          \
    return a.v op Dual<T, N>(b).v;                                                                           \
  }                                                                                                          \
  template <class T, int N, ConstantFor<T> S>                                                                \
  mask_t<T> operator op(S a, const Dual<T, N>& b) {                                                          \
    return Dual<T, N>(a).v op b.v;                                                                           \
  }
NACRE_DUAL_COMPARE(<)
NACRE_DUAL_COMPARE(>)
NACRE_DUAL_COMPARE(<=)
NACRE_DUAL_COMPARE(>=)
NACRE_DUAL_COMPARE(==)
NACRE_DUAL_COMPARE(!=)
#undef NACRE_DUAL_COMPARE

/// Finite in value and in every derivative.
template <class T, int N>
mask_t<T> isfinite(const Dual<T, N>& x) {
  mask_t<T> finite = isfinite(x.v);
  for (int i = 0; i < N; ++i)
    finite = finite & isfinite(x.d[i]);
  return finite;
}
template <class T, int N>
T value(const Dual<T, N>& x) {
  return x.v;
}
template <class T, int N>
Dual<T, N> select(const mask_t<T>& mask, const Dual<T, N>& yes, const Dual<T, N>& no) {
  Dual<T, N> y(select(mask, yes.v, no.v));
  for (int i = 0; i < N; ++i)
    y.d[i] = select(mask, yes.d[i], no.d[i]);
  return y;
}
template <class T, int N, ConstantFor<T> S>
Dual<T, N> select(const mask_t<T>& mask, const Dual<T, N>& yes, S no) {
  return select(mask, yes, Dual<T, N>(no));
}
template <class T, int N, ConstantFor<T> S>
Dual<T, N> select(const mask_t<T>& mask, S yes, const Dual<T, N>& no) {
  return select(mask, Dual<T, N>(yes), no);
}
template <class T, int N>
Dual<T, N> min(const Dual<T, N>& a, const Dual<T, N>& b) {
  return select(a.v <= b.v, a, b); // a tie is a's: a parameter on the bound of a clamp keeps its derivative
}
template <class T, int N>
Dual<T, N> max(const Dual<T, N>& a, const Dual<T, N>& b) {
  return select(a.v >= b.v, a, b);
}
template <class T, int N, ConstantFor<T> S>
Dual<T, N> min(const Dual<T, N>& a, S b) {
  return min(a, Dual<T, N>(b));
}
template <class T, int N, ConstantFor<T> S>
Dual<T, N> max(const Dual<T, N>& a, S b) {
  return max(a, Dual<T, N>(b));
}
template <class T, int N>
Dual<T, N> abs(const Dual<T, N>& x) {
  return select(x.v < T(0), -x, x);
}
template <class T, int N>
Dual<T, N> floor(const Dual<T, N>& x) {
  return Dual<T, N>(T(floor(x.v)));
}
template <class T, int N>
Dual<T, N> sqrt(const Dual<T, N>& x) {
  const T s = sqrt(x.v);
  return dual::chain(s, T(T(0.5f) / s), x);
}
template <class T, int N>
Dual<T, N> exp(const Dual<T, N>& x) {
  const T e = exp(x.v);
  return dual::chain(e, e, x);
}
template <class T, int N>
Dual<T, N> log(const Dual<T, N>& x) {
  return dual::chain(T(log(x.v)), T(T(1) / x.v), x);
}
template <class T, int N>
Dual<T, N> sin(const Dual<T, N>& x) {
  return dual::chain(T(sin(x.v)), T(cos(x.v)), x);
}
template <class T, int N>
Dual<T, N> cos(const Dual<T, N>& x) {
  return dual::chain(T(cos(x.v)), T(-sin(x.v)), x);
}
template <class T, int N>
Dual<T, N> tan(const Dual<T, N>& x) {
  const T t = tan(x.v);
  return dual::chain(t, T(T(1) + t * t), x);
}
template <class T, int N>
Dual<T, N> asin(const Dual<T, N>& x) {
  return dual::chain(T(asin(x.v)), T(T(1) / sqrt(T(1) - x.v * x.v)), x);
}
template <class T, int N>
Dual<T, N> acos(const Dual<T, N>& x) {
  return dual::chain(T(acos(x.v)), T(T(-1) / sqrt(T(1) - x.v * x.v)), x);
}
template <class T, int N>
Dual<T, N> atan(const Dual<T, N>& x) {
  return dual::chain(T(atan(x.v)), T(T(1) / (T(1) + x.v * x.v)), x);
}
template <class T, int N>
Dual<T, N> atan2(const Dual<T, N>& y, const Dual<T, N>& x) {
  const T inv = T(1) / (x.v * x.v + y.v * y.v);
  return dual::chain(T(atan2(y.v, x.v)), T(x.v * inv), y, T(-y.v * inv), x);
}
template <class T, int N>
Dual<T, N> cosh(const Dual<T, N>& x) {
  return dual::chain(T(cosh(x.v)), T(sinh(x.v)), x);
}
template <class T, int N>
Dual<T, N> sinh(const Dual<T, N>& x) {
  return dual::chain(T(sinh(x.v)), T(cosh(x.v)), x);
}
template <class T, int N>
Dual<T, N> erf(const Dual<T, N>& x) {
  return dual::chain(T(erf(x.v)), T(constant<T>(2 / std::sqrt(pi)) * exp(T(-x.v * x.v))), x);
}
/// x^p with both differentiated; x must be positive.
template <class T, int N>
Dual<T, N> pow(const Dual<T, N>& x, const Dual<T, N>& p) {
  const T y = pow(x.v, p.v);
  return dual::chain(y, T(p.v * y / x.v), x, T(y * log(x.v)), p);
}
/// x^p for a constant p; x must be positive.
template <class T, int N, ConstantFor<T> S>
Dual<T, N> pow(const Dual<T, N>& x, S p) {
  const T e = Dual<T, N>(p).v, y = pow(x.v, e);
  return dual::chain(y, T(e * y / x.v), x);
}

} // namespace nacre
