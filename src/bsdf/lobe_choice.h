#pragma once
// Choosing among the lobes of a model: each with a probability in proportion to its estimated albedo.

#include "core/number.h"

#include <array>

namespace nacre {

/// @tparam N lobes; albedo estimates >= 0, in any scale
template <class R, int N>
struct LobeChoice {
  std::array<R, N> probability; ///< sums to 1

  explicit LobeChoice(const std::array<R, N>& albedo) {
    R sum = R(1e-6f); // black lobes alone: the last is chosen
    for (const R& a : albedo)
      sum = sum + a;
    R rest(1);
    for (int i = 0; i + 1 < N; ++i) {
      probability[std::size_t(i)] = albedo[std::size_t(i)] / sum;
      rest = rest - probability[std::size_t(i)];
    }
    probability[N - 1] = max(rest, R(0));
  }

  /// Calls f(i, here, u) for each lobe i but lobe 0 with the mask of those who choose it, and u_lobe
  /// stretched to be uniform in [0, 1) again among them.
  template <class F>
  void for_each_chosen(const R& u_lobe, F f) const {
    R begin = probability[0];
    for (int i = 1; i < N; ++i) {
      const R& p = probability[std::size_t(i)];
      const R end = begin + p;
      const mask_t<R> here = i + 1 < N ? mask_t<R>((u_lobe >= begin) & (u_lobe < end)) : u_lobe >= begin;
      f(i, here, R(clamp(R((u_lobe - begin) / max(p, R(1e-20f))), R(0), R(0.9999999f))));
      begin = end;
    }
  }
};

} // namespace nacre
