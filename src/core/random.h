#pragma once
// Counted random numbers: each is a hash of what it is for, (seed, pixel, sample, dimension), and of nothing
// else. So an image does not depend on threads, tile order or how the work was split.

#include <concepts>
#include <cstdint>

namespace nacre {

/// Bijection of 64-bit words in which every input bit flips about half of the output bits.
/// Source: Stafford 2011, Better Bit Mixing, "Mix13"; the finaliser of SplitMix64 (Steele et al. 2014, fig.
/// 16).
constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// `state` with one more number mixed in. For a fixed state, successive values of `x` give the output of
/// SplitMix64 started there; its increment is the golden ratio of 2^64.
constexpr std::uint64_t hash_step(std::uint64_t state, std::uint64_t x) {
  return mix_bits(state + (x + 1) * 0x9e3779b97f4a7c15u);
}

/// Hash of a list of whole numbers; order matters, and hash(a, b, c) == hash_step(hash(a, b), c).
template <std::integral... T>
constexpr std::uint64_t hash(T... numbers) {
  std::uint64_t state = 0;
  ((state = hash_step(state, static_cast<std::uint64_t>(numbers))), ...);
  return state;
}

/// A float in [0, 1) from the 24 highest bits: a whole multiple of 2^-24, exact, at most 1 - 2^-24.
constexpr float unit_float(std::uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }
/// A double in [0, 1), a whole multiple of 2^-53.
constexpr double unit_double(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

/// Uniform in [0, 1), a function of its arguments alone.
constexpr float uniform(std::uint64_t seed, std::uint64_t pixel, std::uint64_t sample,
                        std::uint64_t dimension) {
  return unit_float(static_cast<std::uint32_t>(hash(seed, pixel, sample, dimension) >> 32));
}

} // namespace nacre
