#pragma once
// Packs of floats: the one header that names the SIMD library. A Pack is a number type like float; the models
// know nothing else about it.

#include "core/number.h"

#include <cstddef>
#include <xsimd/xsimd.hpp>

namespace nacre {

// xsimd 8.1 does not compile log for AVX-512BW (its integer select takes any type for bytes); AVX-512DQ has
// the same float instructions.
#if XSIMD_WITH_AVX512DQ
using PackArchitecture = xsimd::avx512dq;
#else
using PackArchitecture = xsimd::default_arch;
#endif

/// As many floats as one register of the build's architecture holds (16 for AVX-512, 8 for AVX2).
using Pack = xsimd::batch<float, PackArchitecture>;
using PackMask = Pack::batch_bool_type;
inline constexpr std::size_t pack_width = Pack::size;

template <>
struct MaskOf<Pack> {
  using type = PackMask;
};

inline Pack select(PackMask mask, Pack yes, Pack no) { return xsimd::select(mask, yes, no); }
inline bool any(PackMask mask) { return xsimd::any(mask); }
inline bool all(PackMask mask) { return xsimd::all(mask); }
inline Pack value(Pack x) { return x; }

/// Unaligned load of pack_width floats.
inline Pack load(const float* p) { return Pack::load_unaligned(p); }
inline void store(float* p, Pack x) { x.store_unaligned(p); }
/// Lane `i` of a pack; for results and tests, not for inner loops.
inline float lane(Pack x, std::size_t i) { return x.get(i); }
/// Table values at whole-numbered indices, one per lane; the caller keeps indices within the table.
inline Pack gather(const float* table, Pack index) {
  return Pack::gather(table, xsimd::batch_cast<std::int32_t>(index));
}
inline float gather(const float* table, float index) { return table[static_cast<std::ptrdiff_t>(index)]; }
inline double gather(const float* table, double index) { return table[static_cast<std::ptrdiff_t>(index)]; }

} // namespace nacre
