#pragma once
// Smith's masking of one distribution as a table: its quadrature once per set of parameters instead of once
// per direction. For who evaluates many directions in packs, with derivatives or without.

#include "core/dual.h"
#include "core/pack.h"

#include <array>

namespace nacre {

/// What holds a pack of values, and how many derivatives of each.
template <class R>
inline constexpr int pack_derivatives = -1;
template <>
inline constexpr int pack_derivatives<Pack> = 0;
template <int N>
inline constexpr int pack_derivatives<Dual<Pack, N>> = N;

/// L(q) = lambda_cos(1, q), q = cot theta, by cubic interpolation in log q between 1e-4 and 1e4, beyond which
/// it stays; lambda_cos(s, z) = s L(z / s). Derivatives are those of the interpolant: by the shape's
/// parameters from tables of their own, by s and z from its slope.
/// R: Pack or Dual<Pack, N>.
template <class R>
class MaskingTable {
public:
  /// @param shape  offers lambda_cos(s, z); its numbers are the same in all lanes
  template <class Shape>
  explicit MaskingTable(const Shape& shape) {
    std::array<float, pack_width> x;
    for (std::size_t i = 0; i < count; i += pack_width) {
      for (std::size_t k = 0; k < pack_width; ++k)
        x[k] = first + step * float(i + k);
      const R L = shape.lambda_cos(R(1.0f), R(exp(load(x.data()))));
      store(&tables_[0][i], value(L));
      if constexpr (derivatives > 0)
        for (std::size_t k = 0; k < derivatives; ++k)
          store(&tables_[1 + k][i], L.d[k]);
    }
  }

  R lambda_cos(const R& s, const R& z) const {
    const Pack s0 = max(value(s), Pack(1e-20f)), z0 = max(value(z), Pack(1e-20f)), q = z0 / s0;
    const Pack x = (log(q) - Pack(first)) * Pack(1 / step);
    const Pack within = min(max(x, Pack(1.0f)), Pack(float(count) - 2.001f)), before = floor(within);
    // Lagrange's cubic through the nodes at -1, 0, 1 and 2.
    const Pack t = within - before, u = t - Pack(1.0f), v = t - Pack(2.0f), w = t + Pack(1.0f);
    const Pack sixth(1 / 6.0f), half(0.5f);
    const Weights weights{-t * u * v * sixth, w * u * v * half, -t * w * v * half, t * w * u * sixth};
    const Pack L = interpolate(0, before, weights);
    if constexpr (derivatives == 0) {
      return s0 * L;
    } else {
      const Pack three(3.0f), two(2.0f), one(1.0f);
      const Weights slopes{-((three * t - Pack(6.0f)) * t + two) * sixth,
                           ((three * t - Pack(4.0f)) * t - one) * half, -((three * t - two) * t - two) * half,
                           (three * t * t - one) * sixth};
      // dL / d log q
      const Pack slope = select(x == within, interpolate(0, before, slopes) * Pack(1 / step), Pack(0.0f));
      R y = dual::chain(Pack(s0 * L), Pack(L - slope), s, Pack(slope / q), z);
      for (std::size_t k = 0; k < derivatives; ++k)
        y.d[k] += s0 * interpolate(1 + k, before, weights);
      return y;
    }
  }

private:
  static constexpr std::size_t derivatives = std::size_t(std::max(pack_derivatives<R>, 0));
  static constexpr std::size_t count = 256; ///< nodes, a multiple of any pack's width
  static constexpr float first = -9.2f, step = 18.4f / (count - 1);
  using Weights = std::array<Pack, 4>;

  Pack interpolate(std::size_t table, Pack before, const Weights& w) const {
    const float* at = tables_[table].data();
    return w[0] * gather(at - 1, before) + w[1] * gather(at, before) + w[2] * gather(at + 1, before) +
           w[3] * gather(at + 2, before);
  }

  std::array<std::array<float, count>, 1 + derivatives> tables_; ///< L, and its derivatives
};

} // namespace nacre
