#pragma once
// Number types. A reflectance model is written once, templated on its number type R; this header gives every
// such type one vocabulary: value_t, mask_t, select, sqr and the mathematical functions, all found by
// argument-dependent lookup from inside namespace nacre.
//
//   float, double       scalar evaluation
//   Pack                many directions at once               (core/pack.h)
//   Dual<double, N>     exact derivatives, reference          (core/dual.h)
//   Dual<Pack, N>       exact derivatives, many directions    (core/dual.h)

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

namespace nacre {

inline constexpr double pi = std::numbers::pi;
inline constexpr double inv_pi = std::numbers::inv_pi;

/// What comparing two numbers of type R gives: bool, or one bool a lane.
template <class R>
struct MaskOf {
  using type = bool;
};
/// A number of type R without its derivatives.
template <class R>
struct ValueOf {
  using type = R;
};
template <class R>
using mask_t = typename MaskOf<R>::type;
template <class R>
using value_t = typename ValueOf<R>::type;

// Scalars take part in the same overload sets as packs and duals.
using std::abs;
using std::acos;
using std::asin;
using std::atan;
using std::atan2;
using std::cos;
using std::cosh;
using std::erf;
using std::exp;
using std::floor;
using std::isfinite;
using std::log;
using std::max;
using std::min;
using std::pow;
using std::sin;
using std::sinh;
using std::sqrt;
using std::tan;

/// `yes` where `mask`, else `no`. Both arms are evaluated, so neither may divide by zero in a way that makes
/// a derivative NaN: guard the argument, not the result.
template <class R>
requires std::is_arithmetic_v<R>
constexpr R select(bool mask, R yes, std::type_identity_t<R> no) { return mask ? yes : no; }

inline bool any(bool mask) { return mask; }
inline bool all(bool mask) { return mask; }

/// The value without derivatives; the number itself for numbers that carry none.
template <class R>
requires std::is_arithmetic_v<R>
constexpr R value(R x) { return x; }

/// A mathematical constant or literal as a number of type R, without surprises at double -> float packs.
template <class R>
constexpr R constant(double x) {
  if constexpr (std::is_same_v<value_t<R>, double>)
    return R(x);
  else
    return R(static_cast<float>(x));
}

template <class R>
constexpr R sqr(const R& x) {
  return x * x;
}

template <class R>
R clamp(const R& x, const std::type_identity_t<R>& lo, const std::type_identity_t<R>& hi) {
  return min(max(x, lo), hi);
}

/// Square root of max(x, 0) whose derivative stays finite at and below 0, for cosines from sines and the
/// like.
template <class R>
R safe_sqrt(const R& x) {
  const auto positive = x > R(0);
  return select(positive, sqrt(select(positive, x, R(1))), R(0));
}

} // namespace nacre
