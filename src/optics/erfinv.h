#pragma once
// Inverse of the error function.

#include "core/number.h"

namespace nacre {

/// x with erf(x) = y, for y in (-1, 1); arguments nearer to -1 or 1 than float resolves give about +-3.8.
/// Relative error below 1e-6. Source: Giles 2011, Approximating the erfinv Function, GPU Computing Gems 2,
/// table 2.
template <class R>
R erfinv(const R& y) {
  const R w = -log(max((R(1) - y) * (R(1) + y), R(5.96e-8f)));
  const auto central = w < R(5);
  const R a = w - R(2.5f);
  R p = R(2.81022636e-08f);
  p = R(3.43273939e-07f) + p * a;
  p = R(-3.5233877e-06f) + p * a;
  p = R(-4.39150654e-06f) + p * a;
  p = R(0.00021858087f) + p * a;
  p = R(-0.00125372503f) + p * a;
  p = R(-0.00417768164f) + p * a;
  p = R(0.246640727f) + p * a;
  p = R(1.50140941f) + p * a;
  const R b = safe_sqrt(w) - R(3);
  R q = R(-0.000200214257f);
  q = R(0.000100950558f) + q * b;
  q = R(0.00134934322f) + q * b;
  q = R(-0.00367342844f) + q * b;
  q = R(0.00573950773f) + q * b;
  q = R(-0.0076224613f) + q * b;
  q = R(0.00943887047f) + q * b;
  q = R(1.00167406f) + q * b;
  q = R(2.83297682f) + q * b;
  return y * select(central, p, q);
}

} // namespace nacre
