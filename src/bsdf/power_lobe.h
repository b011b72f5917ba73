#pragma once
// The lobe cos^n of the angle to an axis: what Phong's and Blinn's families are made of. Exponents reach 1e5,
// where cos itself is 1 to the last digits of a float: everything is kept in 1 - cos.

#include "bsdf/model.h"

namespace nacre {

/// log(1 - x), to full relative precision near 0; log(1e-20) from 1 on.
/// Source: Higham 2002, Accuracy and Stability of Numerical Algorithms, section 1.14.1.
template <class R>
R log_one_minus(const R& x) {
  const R y = max(R(R(1) - x), R(1e-20f)), rounded = R(1) - y; // rounded is x as y has it
  const auto small = rounded == R(0);
  return select(small, -x, log(y) * min(x, R(1)) / select(small, R(1), rounded));
}
/// 1 - exp(-x) for x >= 0, to full relative precision near 0.
template <class R>
R one_minus_exp(const R& x) {
  const R y = exp(-min(x, R(80))), rounded = R(1) - y; // 80: beyond, the result is 1
  const auto small = rounded == R(0), log_useful = y > R(0.01f);
  return select(small, x, rounded * select(log_useful, x / -log(select(small, R(0.5f), y)), R(1)));
}
/// cos^n from 1 - cos; 0 beyond a right angle. n > 0.
template <class R>
R power_of_cosine(const R& one_minus_cos, const R& n) {
  return select(one_minus_cos < R(1), exp(n * log_one_minus(one_minus_cos)), R(0));
}

template <class R>
struct PowerLobe {
  Vec3<R> axis; ///< unit
  R exponent;   ///< > 0

  /// cos^n of the angle between the unit vector w and the axis.
  R value(const Vec3<R>& w) const { return power_of_cosine(R(R(0.5f) * length_squared(axis - w)), exponent); }
  /// Of `sample`, 1/sr: (n + 1) / (2 pi) cos^n.
  R density(const Vec3<R>& w) const { return (exponent + R(1)) * constant<R>(0.5 * inv_pi) * value(w); }
  Vec3<R> sample(const Vec2<R>& u) const {
    const R drop = one_minus_exp(R(-log(R(1) - u.x) / (exponent + R(1)))); // cos = (1 - u)^(1 / (n + 1))
    const R s = safe_sqrt(R(drop * (R(2) - drop))), phi = constant<R>(2 * pi) * u.y;
    return Frame<R>::around(axis).to_world({s * cos(phi), s * sin(phi), R(1) - drop});
  }
};

/// The direction in which a mirror sends light to or from w.
template <class R>
Vec3<R> mirrored(const Vec3<R>& w) {
  return {-w.x, -w.y, w.z};
}

} // namespace nacre
