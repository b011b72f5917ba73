#pragma once
// Writes a program operation by operation: slots, constants, and arithmetic on vectors as scalars side by
// side.

#include "bsdf/shader/program.h"

#include <functional>
#include <map>

namespace nacre::shader {

using Slot = std::int32_t;
using Slots = std::vector<Slot>;

class Emitter {
public:
  Program program;

  Slot fresh(Kind kind) {
    return kind == Kind::number    ? program.numbers++
           : kind == Kind::integer ? program.integers++
                                   : program.truths++;
  }
  Slots fresh(const std::vector<Kind>& kinds) {
    Slots slots;
    for (const Kind kind : kinds)
      slots.push_back(fresh(kind));
    return slots;
  }
  Slot number(double x) { return constant(numbers_, x, program.number_constants, Kind::number); }
  Slot integer(std::int32_t x) { return constant(integers_, x, program.integer_constants, Kind::integer); }
  Slot truth(bool x) { return constant(truths_, x, program.truth_constants, Kind::truth); }
  /// The value of a slot that holds a constant integer; null for one that does not.
  const std::int32_t* constant_integer(Slot slot) const {
    for (const auto& [s, x] : program.integer_constants)
      if (s == slot) return &x;
    return nullptr;
  }

  void emit(Op op, Slot dst, Slot a, Slot b = 0, Slot c = 0) {
    program.operations.push_back({op, dst, a, b, c});
  }
  /// The operation's result in a fresh slot.
  Slot make(Op op, Slot a, Slot b = 0, Slot c = 0) {
    const char kind = signature(op)[0];
    const Slot dst = fresh(kind == 'n' ? Kind::number : kind == 'i' ? Kind::integer : Kind::truth);
    emit(op, dst, a, b, c);
    return dst;
  }
  /// Component by component; a vector of one component goes with all of the other's.
  Slots map(Op op, const Slots& a) {
    return each(a.size(), [&](std::size_t i) { return make(op, a[i]); });
  }
  Slots map(Op op, const Slots& a, const Slots& b) {
    return each(std::max(a.size(), b.size()), [&](std::size_t i) { return make(op, of(a, i), of(b, i)); });
  }
  Slots map(Op op, const Slots& a, const Slots& b, const Slots& c) {
    return each(std::max({a.size(), b.size(), c.size()}),
                [&](std::size_t i) { return make(op, of(a, i), of(b, i), of(c, i)); });
  }

  Slot sum(const Slots& a) {
    Slot s = a[0];
    for (std::size_t i = 1; i < a.size(); ++i)
      s = make(Op::add, s, a[i]);
    return s;
  }
  Slot dot(const Slots& a, const Slots& b) { return sum(map(Op::multiply, a, b)); }
  Slots copy(const std::vector<Kind>& kinds, const Slots& a) {
    return each(a.size(), [&](std::size_t i) { return make(copy_op(kinds[i]), a[i]); });
  }
  void store(const std::vector<Kind>& kinds, const Slots& to, const Slots& from) {
    for (std::size_t i = 0; i < to.size(); ++i)
      emit(store_op(kinds[i]), to[i], from[i]);
  }
  static Op copy_op(Kind k) {
    return k == Kind::number ? Op::copy : k == Kind::integer ? Op::copy_integer : Op::copy_truth;
  }
  static Op store_op(Kind k) {
    return k == Kind::number ? Op::store_number : k == Kind::integer ? Op::store_integer : Op::store_truth;
  }
  static Op choose_op(Kind k) {
    return k == Kind::number ? Op::choose : k == Kind::integer ? Op::choose_integer : Op::choose_truth;
  }

private:
  static Slot of(const Slots& v, std::size_t i) { return v.size() == 1 ? v[0] : v.at(i); }
  template <class F>
  static Slots each(std::size_t n, F f) {
    Slots slots;
    for (std::size_t i = 0; i < n; ++i)
      slots.push_back(f(i));
    return slots;
  }
  template <class T>
  Slot constant(std::map<T, Slot>& known, T x, std::vector<std::pair<Slot, T>>& list, Kind kind) {
    if (const auto found = known.find(x); found != known.end() && x == x) return found->second;
    const Slot slot = fresh(kind);
    if (x == x) known[x] = slot; // a NaN is equal to nothing
    list.emplace_back(slot, x);
    return slot;
  }
  std::map<double, Slot> numbers_;
  std::map<std::int32_t, Slot> integers_;
  std::map<bool, Slot> truths_;
};

/// GLSL's built-in functions as the extended instruction set GLSL.std.450 numbers them.
/// @param a         operands that are values, each as its scalars
/// @param is_matrix_of  rows of a square matrix operand, for determinant and inverse
/// @return the result's scalars; empty for a function that is not supported
/// Source: SPIR-V Extended Instructions for GLSL, Khronos; OpenGL Shading Language 4.10.
Slots glsl_function(Emitter& emitter, std::uint32_t function, const std::vector<Slots>& a);

} // namespace nacre::shader
