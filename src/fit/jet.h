#pragma once
// ceres::Jet<double, N> as a number type of the models: the reference that the fitter's derivatives are
// tested and timed against. Jet has the arithmetic; this adds what core/number.h asks of a number type, in
// Jet's namespace, where argument-dependent lookup finds it.

#include "core/number.h"

#include <ceres/jet.h>

namespace nacre {

template <class T, int N>
struct ValueOf<ceres::Jet<T, N>> {
  using type = T;
};

} // namespace nacre

namespace ceres {

template <class T, int N>
T value(const Jet<T, N>& x) {
  return x.a;
}
template <class T, int N>
Jet<T, N> select(bool mask, const Jet<T, N>& yes, const Jet<T, N>& no) {
  return mask ? yes : no;
}
template <class T, int N>
Jet<T, N> select(bool mask, const Jet<T, N>& yes, double no) {
  return mask ? yes : Jet<T, N>(no);
}
template <class T, int N>
Jet<T, N> select(bool mask, double yes, const Jet<T, N>& no) {
  return mask ? Jet<T, N>(yes) : no;
}
template <class T, int N>
Jet<T, N> clamp(const Jet<T, N>& x, double lo, double hi) {
  return nacre::clamp(x, Jet<T, N>(lo), Jet<T, N>(hi));
}

/// Numbers that Jet<T, N>'s own operators do not mix with: int and float beside Jet<double, N>.
template <class S, class T>
concept OtherNumber = std::is_arithmetic_v<S> && !std::is_same_v<S, T>;

template <class T, int N, OtherNumber<T> S>
Jet<T, N> operator+(const Jet<T, N>& a, S b) {
  return a + T(b);
}
template <class T, int N, OtherNumber<T> S>
Jet<T, N> operator+(S a, const Jet<T, N>& b) {
  return T(a) + b;
}
template <class T, int N, OtherNumber<T> S>
Jet<T, N> operator-(const Jet<T, N>& a, S b) {
  return a - T(b);
}
template <class T, int N, OtherNumber<T> S>
Jet<T, N> operator-(S a, const Jet<T, N>& b) {
  return T(a) - b;
}
template <class T, int N, OtherNumber<T> S>
Jet<T, N> operator*(const Jet<T, N>& a, S b) {
  return a * T(b);
}
template <class T, int N, OtherNumber<T> S>
Jet<T, N> operator*(S a, const Jet<T, N>& b) {
  return T(a) * b;
}
template <class T, int N, OtherNumber<T> S>
Jet<T, N> operator/(const Jet<T, N>& a, S b) {
  return a / T(b);
}
template <class T, int N, OtherNumber<T> S>
Jet<T, N> operator/(S a, const Jet<T, N>& b) {
  return T(a) / b;
}

} // namespace ceres
