#pragma once
// Random numbers drawn from what they are for: a stream whose key is the bits of a direction or of other
// random numbers. So a function that estimates (a random walk through layers, say) stays a function: the same
// arguments give the same value, in any thread and order, and neighbouring arguments give unrelated noise.

#include "core/dual.h"
#include "core/random.h"
#include "core/vec.h"

#include <bit>

namespace nacre {

namespace random_stream {

/// 32-bit words, one a lane. Mixer: Wellons 2018, Prospecting for Hash Functions, "lowbias32".
template <class U>
U mix(U x) {
  x = (x ^ (x >> 16)) * U(0x7feb352du);
  x = (x ^ (x >> 15)) * U(0x846ca68bu);
  return x ^ (x >> 16);
}

struct ScalarWords {
  using Word = std::uint32_t;
  static Word bits(float x) { return std::bit_cast<std::uint32_t>(x); }
  static Word bits(double x) {
    const std::uint64_t b = mix_bits(std::bit_cast<std::uint64_t>(x));
    return std::uint32_t(b ^ (b >> 32));
  }
  template <class R>
  static R unit(Word w) {
    return R(unit_float(w));
  }
};

struct PackWords {
  using Word = xsimd::batch<std::uint32_t, PackArchitecture>;
  static Word bits(const Pack& x) { return xsimd::bitwise_cast<Word>(x); }
  template <class R>
  static R unit(const Word& w) {
    using Signed = xsimd::batch<std::int32_t, PackArchitecture>;
    return xsimd::batch_cast<float>(xsimd::bitwise_cast<Signed>(Word(w >> 8))) * R(0x1p-24f);
  }
};

} // namespace random_stream

/// @tparam R  a number type; of a dual the value alone makes the key, and the numbers carry no derivatives
template <class R>
class RandomStream {
  using Value = value_t<R>;
  using Words =
      std::conditional_t<std::is_same_v<Value, Pack>, random_stream::PackWords, random_stream::ScalarWords>;
  using Word = typename Words::Word;

public:
  RandomStream(const Vec3<R>& a, const Vec3<R>& b) {
    for (const R* x : {&a.x, &a.y, &a.z, &b.x, &b.y, &b.z})
      take(*x);
  }
  RandomStream(const R& u_lobe, const Vec2<R>& u) {
    for (const R* x : {&u_lobe, &u.x, &u.y})
      take(*x);
  }
  /// Uniform in [0, 1), a whole multiple of 2^-24.
  R next() {
    counter_ += 0x9e3779b9u;
    return R(
        Words::template unit<Value>(random_stream::mix(Word(key_ ^ random_stream::mix(Word(counter_))))));
  }
  Vec2<R> next_2d() {
    const R x = next();
    return {x, next()};
  }

private:
  void take(const R& x) {
    key_ = random_stream::mix(Word(key_ * Word(0x9e3779b1u) + Words::bits(Value(value(x)))));
  }
  Word key_ = Word(0x2545f491u);
  std::uint32_t counter_ = 0;
};

} // namespace nacre
