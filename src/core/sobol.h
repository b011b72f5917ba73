#pragma once
// Samplers: the numbers one path consumes, request after request. SobolSampler stratifies each request over
// the samples of its pixel; IndependentSampler is plain random numbers with the same interface.

#include "core/random.h"
#include "core/vec.h"

#include <bit>

namespace nacre {

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return std::rotl(x, 16);
}

/// Owen scrambling of digits stored lowest bit first: a bijection in which bit i depends on bits 0..i alone.
/// `seed` must itself be well mixed.
/// Source: the form of Laine and Karras 2011 (Stratified Sampling for Stochastic Transparency), with the
/// steps and constants of Vegdahl 2021, Building a Better LK Hash, "the final hash".
constexpr std::uint32_t scramble_digits(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// The second coordinate of the Sobol' point `index`, as binary digits, the first behind the point in bit 0.
/// (Those of the first coordinate are `index` itself.) Its generator is Pascal's triangle modulo 2 (Sobol'
/// 1967), and by Lucas's theorem C(j, i) is odd where the bits of i are among those of j: digit i is the
/// parity of all index bits j that contain i, a sum over supersets, taken here one bit of i at a time.
constexpr std::uint32_t sobol_second_digits(std::uint32_t index) {
  index ^= (index >> 1) & 0x55555555u;
  index ^= (index >> 2) & 0x33333333u;
  index ^= (index >> 4) & 0x0f0f0f0fu;
  index ^= (index >> 8) & 0x00ff00ffu;
  index ^= (index >> 16) & 0x0000ffffu;
  return index;
}

/// Owen-scrambled Sobol' points, padded: every request, 1-D or 2-D, is a (0,2)-sequence over the sample
/// index, shuffled and scrambled on its own, so any aligned run of 2^k samples is stratified in all
/// elementary intervals of area 2^-k and requests are independent of one another. Values are multiples of
/// 2^-24 in [0, 1). Source: Burley 2020, Practical Hash-based Owen Scrambling, sections 3 and 5.
class SobolSampler {
public:
  SobolSampler(std::uint64_t seed, std::uint64_t pixel_index, std::uint32_t sample_index)
      : key_(hash(seed, pixel_index)), reversed_index_(reverse_bits(sample_index)) {}

  float next_1d() {
    const std::uint64_t h = hash_step(key_, dimension_++);
    return coordinate(shuffled(low(h)), high(h));
  }
  Vec2f next_2d() {
    const std::uint64_t h = hash_step(key_, dimension_++);
    const std::uint32_t index = shuffled(low(h));
    return {coordinate(index, high(h)), coordinate(sobol_second_digits(index), high(mix_bits(~h)))};
  }
  /// Requests so far. Setting it gives a purpose the same place in the sequence whatever was asked before.
  std::uint32_t dimension() const { return dimension_; }
  void set_dimension(std::uint32_t dimension) { dimension_ = dimension; }

private:
  static std::uint32_t low(std::uint64_t h) { return static_cast<std::uint32_t>(h); }
  static std::uint32_t high(std::uint64_t h) { return static_cast<std::uint32_t>(h >> 32); }
  /// The sample index permuted within every aligned block of 2^k at once: itself an Owen scrambling.
  std::uint32_t shuffled(std::uint32_t seed) const {
    return reverse_bits(scramble_digits(reversed_index_, seed));
  }
  static float coordinate(std::uint32_t digits, std::uint32_t seed) {
    return unit_float(reverse_bits(scramble_digits(digits, seed)));
  }

  std::uint64_t key_;
  std::uint32_t reversed_index_, dimension_ = 0;
};

/// Independent uniform numbers: the i-th number is uniform(seed, pixel, sample, i). A 2-D request takes two.
class IndependentSampler {
public:
  IndependentSampler(std::uint64_t seed, std::uint64_t pixel_index, std::uint32_t sample_index)
      : key_(hash(seed, pixel_index, sample_index)) {}

  float next_1d() { return unit_float(static_cast<std::uint32_t>(hash_step(key_, dimension_++) >> 32)); }
  Vec2f next_2d() {
    const float x = next_1d();
    return {x, next_1d()};
  }
  /// Numbers taken so far. Setting it gives a purpose the same place in the sequence whatever was asked
  /// before.
  std::uint32_t dimension() const { return dimension_; }
  void set_dimension(std::uint32_t dimension) { dimension_ = dimension; }

private:
  std::uint64_t key_;
  std::uint32_t dimension_ = 0;
};

} // namespace nacre
