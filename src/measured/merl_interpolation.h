#pragma once
// MerlTable::interpolate: the inner loop of everything measured. Included by merl_table.h.

#include "core/pack.h"
#include "measured/merl_table.h"

#include <cstring>

namespace nacre {

template <class R>
MerlTable::Corner<R> MerlTable::corner(const HalfDifference<R>& a) const {
  // Position `x` among nodes 0..n-1 as lower node and fraction; past the last node the last value holds. A
  // NaN must not become an index: every comparison is false for it and lands within the table.
  const auto split = [](const R& x, int n, R& index, R& fraction) {
    const R first(0), last(static_cast<float>(n - 1));
    const R inside = select(x > first, R(select(x < last, x, last)), first);
    index = min(floor(inside), R(static_cast<float>(max(n - 2, 0))));
    fraction = inside - index;
  };
  Corner<R> c;
  split(sqrt(a.theta_h * constant<R>(2 / pi)) * R(static_cast<float>(n_theta_h_)), n_theta_h_, c.i, c.fi);
  split(a.theta_d * constant<R>(2 / pi * n_theta_d_), n_theta_d_, c.j, c.fj);
  const R turns = a.phi_d * constant<R>(1 / phi_d_period()), last(static_cast<float>(n_phi_d_ - 1));
  const R z = (turns - floor(turns)) * R(static_cast<float>(n_phi_d_));
  c.k = select(z < last, floor(z), last);
  c.fk = z - c.k;
  return c;
}

template <class T>
std::array<T, 4> MerlTable::blend(const Corner<T>& c) const {
  // A cell is one vector of the compiler's own vector types: left to itself gcc 12 makes gathers of this, at
  // three times the time.
  typedef float FloatCell __attribute__((vector_size(4 * sizeof(float))));
  typedef T Sum __attribute__((vector_size(4 * sizeof(T))));

  const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(c.i), j = static_cast<std::ptrdiff_t>(c.j),
                       k = static_cast<std::ptrdiff_t>(c.k), row = n_phi_d_;
  const std::ptrdiff_t next_i = n_theta_h_ > 1 ? row * n_theta_d_ : 0, next_j = n_theta_d_ > 1 ? row : 0,
                       next_k = k + 1 < row ? 1 : -k;
  const Cell* const p = cells_.data() + (i * n_theta_d_ + j) * row + k;
  Sum sum{};
  const auto add = [&](T weight, const Cell* corner) {
    FloatCell cell;
    std::memcpy(&cell, corner, sizeof cell);
    sum += weight * __builtin_convertvector(cell, Sum);
  };
  // Products of weights, never a + t (b - a): next to a hole that would leave the rounding error of b - a.
  const T i1 = c.fi, i0 = T(1) - i1, j1 = c.fj, j0 = T(1) - j1, k1 = c.fk, k0 = T(1) - k1;
  add(i0 * j0 * k0, p);
  add(i0 * j0 * k1, p + next_k);
  add(i0 * j1 * k0, p + next_j);
  add(i0 * j1 * k1, p + next_j + next_k);
  add(i1 * j0 * k0, p + next_i);
  add(i1 * j0 * k1, p + next_i + next_k);
  add(i1 * j1 * k0, p + next_i + next_j);
  add(i1 * j1 * k1, p + next_i + next_j + next_k);
  return {sum[0], sum[1], sum[2], sum[3]};
}

template <class R>
Spectrum<R, 3> MerlTable::interpolate(const HalfDifference<R>& a) const {
  const Corner<R> c = corner(a);
  std::array<R, 4> sum;
  if constexpr (std::is_arithmetic_v<R>) {
    sum = blend(c);
  } else {
    // Lane by lane: eight whole cells in a lane cost a quarter of thirty-two gathers across lanes.
    constexpr std::size_t n = pack_width;
    alignas(64) float in[6][n], out[4][n];
    const R* parts[6] = {&c.i, &c.j, &c.k, &c.fi, &c.fj, &c.fk};
    for (int part = 0; part < 6; ++part)
      store(in[part], *parts[part]);
    for (std::size_t l = 0; l < n; ++l) {
      const auto cell = blend(Corner<float>{in[0][l], in[1][l], in[2][l], in[3][l], in[4][l], in[5][l]});
      for (int channel = 0; channel < 4; ++channel)
        out[channel][l] = cell[channel];
    }
    for (int channel = 0; channel < 4; ++channel)
      sum[channel] = load(out[channel]);
  }
  const auto measured = sum[3] > R(0);
  const R scale = select(measured, R(1) / select(measured, sum[3], R(1)), R(0));
  return Spectrum<R, 3>({sum[0] * scale, sum[1] * scale, sum[2] * scale});
}

} // namespace nacre
