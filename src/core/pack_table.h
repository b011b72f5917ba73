#pragma once
// A short table that is computed and then looked up lane by lane, held in registers.

#include "core/pack.h"

#include <array>

namespace nacre {

/// Value number `index` of the values in `table`, pack after pack, for each lane.
/// @param index  whole numbers in [0, N pack_width)
template <std::size_t N>
Pack lookup(const std::array<Pack, N>& table, const Pack& index) {
#ifdef __AVX512F__
  // A permutation of two registers; a gather would have to wait until what it reads is stored.
  if constexpr (pack_width == 16 && N == 2)
    return _mm512_permutex2var_ps(table[0], _mm512_cvttps_epi32(index), table[1]);
#endif
  std::array<float, N * pack_width> values;
  for (std::size_t k = 0; k < N; ++k)
    store(&values[k * pack_width], table[k]);
  return gather(values.data(), index);
}

} // namespace nacre
