#pragma once
// Runs a shader for many lanes at once. R is the number type: float, double, Pack or dual numbers, and a slot
// holds `rows` of R, so that the cost of reading an operation is shared by many lanes.
//
// Lanes that take different ways wait for each other: the machine always runs the first block, in the
// program's order, that lanes wait for, with those lanes active. Stores are masked; what is computed for
// other lanes is thrown away. Source: the scheduling of masked SIMD, Levinthal and Porter 1984, Chap: a SIMD
// graphics processor.

#include "bsdf/shader/program.h"
#include "core/cancellation.h"
#include "core/dual.h"
#include "core/error.h"

#include <bit>
#include <fmt/format.h>
#include <memory>

namespace nacre::shader {

template <class R>
inline constexpr std::size_t lanes_of = 1;
template <>
inline constexpr std::size_t lanes_of<Pack> = pack_width;
template <class T, int N>
inline constexpr std::size_t lanes_of<Dual<T, N>> = lanes_of<T>;

template <class R>
inline constexpr bool is_dual = !std::is_same_v<R, value_t<R>>;

// GLSL's functions where R's own have no derivative at the end of their domain: there it counts as 0.
template <class R>
R root(const R& x) {
  if constexpr (is_dual<R>) {
    const auto inside = x > R(0);
    return select(inside, R(sqrt(select(inside, x, R(1)))), R(sqrt(value(x))));
  } else {
    return sqrt(x);
  }
}
template <class R, class F>
R arc(const R& x, F f) {
  if constexpr (is_dual<R>) {
    const auto inside = abs(x) < R(1);
    return select(inside, f(R(select(inside, x, R(0)))), R(value(f(R(value(x))))));
  } else {
    return f(x);
  }
}
template <class R>
R whole_power(const R& x, std::int32_t n) {
  R y(1), square = x;
  for (; n > 0; n /= 2) {
    if (n % 2) y = y * square;
    square = square * square;
  }
  return y;
}
/// GLSL leaves x^p undefined for x < 0; here it is 0 there, as the limit from above for p > 0.
template <class R>
R raised(const R& x, const R& p) {
  const auto inside = x > R(0);
  const R y = pow(R(select(inside, x, R(1))), p);
  const auto at_zero = select(p > R(0), R(0), R(select(p < R(0), constant<R>(1e38) * R(10), R(1))));
  return select(inside, y, R(value(R(at_zero))));
}
template <class R>
R truncated(const R& x) {
  return select(x < R(0), R(-floor(R(-x))), R(floor(x)));
}
template <class R>
R rounded_even(const R& x) {
  const R below = floor(x), part = x - below, odd = below - R(2) * floor(R(below * R(0.5f)));
  const auto up = (part > R(0.5f)) | ((part == R(0.5f)) & (odd == R(1)));
  return select(up, R(below + R(1)), below);
}

/// @tparam rows_of_slot  R's of a slot
template <class R, std::size_t rows_of_slot = 1>
class Machine {
public:
  using Mask = mask_t<R>;
  static constexpr std::size_t width = lanes_of<R>; ///< lanes of one R
  static constexpr std::size_t rows = rows_of_slot;
  /// Jumps backwards that all loops of one run may take together.
  static constexpr int max_jumps_back = 100000;

  /// @param name  of the shader, for messages; program and name outlive the machine
  Machine(const Program& program, const std::string& name)
      : program_(program), name_(name), numbers_(std::size_t(program.numbers) * rows, R(0)),
        integers_(std::size_t(program.integers) * rows),
        truths_(std::make_unique<Mask[]>(std::size_t(program.truths) * rows)),
        waiting_(std::make_unique<Mask[]>(program.blocks.size() * rows)),
        is_waited_for_(program.blocks.size()) {
    for (const auto& [slot, x] : program.number_constants)
      set(slot, constant<R>(x));
    for (const auto& [slot, x] : program.integer_constants)
      set_integer(slot, x);
    for (const auto& [slot, x] : program.truth_constants)
      set_truth(slot, x);
  }

  R* number(std::int32_t slot) { return &numbers_[std::size_t(slot) * rows]; }
  void set(std::int32_t slot, const R& x) { std::fill_n(number(slot), rows, x); }
  void set_integer(std::int32_t slot, std::int32_t x) {
    for (std::size_t r = 0; r < rows; ++r)
      integer(slot)[r].fill(x);
  }
  void set_truth(std::int32_t slot, bool x) { std::fill_n(truth(slot), rows, Mask(x)); }

  /// Runs the program from its beginning, all lanes active.
  /// @throws Error with the line for a loop that does not end or an index outside its array, and where a
  /// Cancellation ends it
  void run() {
    check_cancelled();
    // An earlier run may have ended in an exception.
    std::fill_n(waiting_.get(), program_.blocks.size() * rows, Mask(false));
    std::fill(is_waited_for_.begin(), is_waited_for_.end(), char(false));
    active_.fill(Mask(true));
    all_active_ = true;
    std::size_t at = 0;
    int jumps_back = 0;
    executed_ = 0;
    for (;;) {
      const Block& block = program_.blocks[at];
      execute(block.begin, block.end);
      executed_ += std::size_t(block.end - block.begin);
      first_ = program_.blocks.size();
      leave(block);
      if (first_ <= at) {
        if (++jumps_back > max_jumps_back)
          throw Error(
              fmt::format("{}:{}: a loop does not end after {} rounds", name_, block.line, max_jumps_back));
        if (jumps_back % 64 == 0) check_cancelled();
      }
      for (std::size_t next = std::min(first_, at + 1);; ++next) {
        if (next == program_.blocks.size()) return;
        if (is_waited_for_[next]) {
          at = next;
          break;
        }
      }
      is_waited_for_[at] = false;
      all_active_ = true;
      for (std::size_t r = 0; r < rows; ++r) {
        active_[r] = waiting_[at * rows + r];
        waiting_[at * rows + r] = Mask(false);
        all_active_ = all_active_ && all(active_[r]);
      }
    }
  }

  /// Operations of the last run, those between blocks left out.
  std::size_t executed() const { return executed_; }

private:
  using Integers = std::array<std::int32_t, width>;

  Integers* integer(std::int32_t slot) { return &integers_[std::size_t(slot) * rows]; }
  Mask* truth(std::int32_t slot) { return &truths_[std::size_t(slot) * rows]; }

  static Mask mask_of(const std::array<bool, width>& lane) {
    if constexpr (width == 1) {
      return lane[0];
    } else {
      std::array<float, width> x;
      for (std::size_t l = 0; l < width; ++l)
        x[l] = lane[l] ? 1.0f : 0.0f;
      return load(x.data()) > Pack(0.5f);
    }
  }
  static std::array<bool, width> lanes_of_mask(const Mask& mask) {
    if constexpr (width == 1) {
      return {bool(mask)};
    } else {
      std::array<float, width> x;
      store(x.data(), select(mask, Pack(1.0f), Pack(0.0f)));
      std::array<bool, width> lane;
      for (std::size_t l = 0; l < width; ++l)
        lane[l] = x[l] > 0.5f;
      return lane;
    }
  }
  static std::array<double, width> lanes_of_number(const R& x) {
    if constexpr (width == 1) {
      return {double(value(x))};
    } else {
      std::array<float, width> v;
      store(v.data(), value(x));
      std::array<double, width> lane;
      std::copy(v.begin(), v.end(), lane.begin());
      return lane;
    }
  }
  static R number_of(const std::array<double, width>& lane) {
    if constexpr (width == 1) {
      return R(constant<R>(lane[0]));
    } else {
      std::array<float, width> v;
      for (std::size_t l = 0; l < width; ++l)
        v[l] = float(lane[l]);
      return R(load(v.data()));
    }
  }

  /// Lanes of `mask` wait for the edge's target.
  void go(const Edge& edge, const std::array<Mask, rows>& mask) {
    bool taken = false;
    for (std::size_t r = 0; r < rows; ++r)
      taken = taken || any(mask[r]);
    if (!taken) return;
    if (edge.begin < edge.end) {
      const auto active = active_;
      const bool all_active = all_active_;
      active_ = mask;
      all_active_ = false;
      execute(edge.begin, edge.end);
      active_ = active;
      all_active_ = all_active;
    }
    if (edge.target < 0) return;
    const std::size_t target = std::size_t(edge.target);
    for (std::size_t r = 0; r < rows; ++r)
      waiting_[target * rows + r] = waiting_[target * rows + r] | mask[r];
    is_waited_for_[target] = true;
    first_ = std::min(first_, target);
  }

  void leave(const Block& block) {
    if (block.exit == Block::Exit::jump) return go(block.yes, active_);
    std::array<Mask, rows> mask;
    if (block.exit == Block::Exit::branch) {
      const Mask* condition = truth(block.condition);
      for (std::size_t r = 0; r < rows; ++r)
        mask[r] = active_[r] & condition[r];
      std::array<Mask, rows> others;
      for (std::size_t r = 0; r < rows; ++r)
        others[r] = active_[r] & (!condition[r]);
      go(block.yes, mask);
      return go(block.no, others);
    }
    const Integers* selector = integer(block.condition);
    std::array<Mask, rows> rest = active_;
    for (const auto& [value, edge] : block.cases) {
      for (std::size_t r = 0; r < rows; ++r) {
        std::array<bool, width> same;
        for (std::size_t l = 0; l < width; ++l)
          same[l] = selector[r][l] == value;
        const Mask is = mask_of(same);
        mask[r] = rest[r] & is;
        rest[r] = rest[r] & (!is);
      }
      go(edge, mask);
    }
    go(block.no, rest);
  }

  void execute(std::int32_t begin, std::int32_t end) {
    for (std::int32_t i = begin; i < end; ++i)
      execute(program_.operations[std::size_t(i)]);
  }

  void execute(const Operation& o) {
    switch (o.op) {
#define NACRE_SHADER_SLOT_n(slot) number(slot)
#define NACRE_SHADER_SLOT_t(slot) truth(slot)
#define NACRE_SHADER_SLOT__(slot) number(0)
#define NACRE_SHADER_CASE(name, result, ka, kb, kc, expression)                                              \
  case Op::name: {                                                                                           \
    auto* to = NACRE_SHADER_SLOT_##result(o.dst);                                                            \
    const auto* pa = NACRE_SHADER_SLOT_##ka(o.a);                                                            \
    [[maybe_unused]] const auto* pb = NACRE_SHADER_SLOT_##kb(o.b);                                           \
    [[maybe_unused]] const auto* pc = NACRE_SHADER_SLOT_##kc(o.c);                                           \
    for (std::size_t r = 0; r < rows; ++r) {                                                                 \
      const auto& a = pa[r];                                                                                 \
      [[maybe_unused]] const auto& b = pb[r];                                                                \
      [[maybe_unused]] const auto& c = pc[r];                                                                \
      to[r] = expression;                                                                                    \
    }                                                                                                        \
    return;                                                                                                  \
  }
      NACRE_SHADER_NUMBER_OPS(NACRE_SHADER_CASE)
      NACRE_SHADER_TRUTH_OPS(NACRE_SHADER_CASE)
#undef NACRE_SHADER_CASE
#undef NACRE_SHADER_SLOT_n
#undef NACRE_SHADER_SLOT_t
#undef NACRE_SHADER_SLOT__
#define NACRE_SHADER_CASE(name, expression)                                                                  \
  case Op::name:                                                                                             \
    return each_integer(o, [](std::int32_t a, [[maybe_unused]] std::int32_t b) { return expression; });
      NACRE_SHADER_INTEGER_OPS(NACRE_SHADER_CASE)
#undef NACRE_SHADER_CASE
#define NACRE_SHADER_CASE(name, expression)                                                                  \
  case Op::name:                                                                                             \
    return compare(o, [](std::int32_t a, std::int32_t b) { return expression; });
      NACRE_SHADER_COMPARISON_OPS(NACRE_SHADER_CASE)
#undef NACRE_SHADER_CASE
    case Op::copy_integer:
      return each_integer(o, [](std::int32_t a, std::int32_t) { return a; });
    case Op::choose_integer:
      return masked_integers(o.dst, truth(o.a), integer(o.b), integer(o.c));
    case Op::number_from_signed:
      return to_number(o, [](std::int32_t a) { return double(a); });
    case Op::number_from_unsigned:
      return to_number(o, [](std::int32_t a) { return double(std::uint32_t(a)); });
    case Op::number_from_bits:
      return to_number(o, [](std::int32_t a) { return double(std::bit_cast<float>(a)); });
    case Op::power_of_two:
      return to_number(o, [](std::int32_t a) { return std::ldexp(1.0, std::clamp(a, -1000, 1000)); });
    case Op::exponent:
      return to_integer(o, [](double a) {
        int exponent = 0;
        if (std::isfinite(a)) std::frexp(a, &exponent);
        return std::int32_t(exponent);
      });
    case Op::integer_from_number:
      return to_integer(o, [](double a) {
        // Beyond the range the result is undefined in GLSL; a cast would be so in C++.
        return a > -2147483649.0 && a < 4294967296.0 ? std::int32_t(std::uint32_t(std::int64_t(a))) : 0;
      });
    case Op::bits_from_number:
      return to_integer(o, [](double a) { return std::bit_cast<std::int32_t>(float(a)); });
    case Op::store_number: {
      R* to = number(o.dst);
      const R* from = number(o.a);
      for (std::size_t r = 0; r < rows; ++r)
        to[r] = all_active_ ? from[r] : R(select(active_[r], from[r], to[r]));
      return;
    }
    case Op::whole_power: {
      R* to = number(o.dst);
      const R* from = number(o.a);
      for (std::size_t r = 0; r < rows; ++r)
        to[r] = whole_power(from[r], o.b);
      return;
    }
    case Op::store_truth: {
      Mask* to = truth(o.dst);
      const Mask* from = truth(o.a);
      for (std::size_t r = 0; r < rows; ++r)
        to[r] = (active_[r] & from[r]) | ((!active_[r]) & to[r]);
      return;
    }
    case Op::store_integer:
      return masked_integers(o.dst, active_.data(), integer(o.a), integer(o.dst));
    case Op::check_index:
      for (std::size_t r = 0; r < rows; ++r) {
        const auto lane = lanes_of_mask(active_[r]);
        for (std::size_t l = 0; l < width; ++l)
          if (const std::int32_t i = integer(o.a)[r][l]; lane[l] && (i < 0 || i >= o.b))
            throw Error(fmt::format("{}:{}: index {} outside an array of {}", name_, o.c, i, o.b));
      }
      return;
    }
  }

  template <class F>
  void each_integer(const Operation& o, F f) {
    Integers* to = integer(o.dst);
    const Integers *a = integer(o.a), *b = integer(o.b);
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t l = 0; l < width; ++l)
        to[r][l] = f(a[r][l], b[r][l]);
  }
  template <class F>
  void compare(const Operation& o, F f) {
    const Integers *a = integer(o.a), *b = integer(o.b);
    for (std::size_t r = 0; r < rows; ++r) {
      std::array<bool, width> lane;
      for (std::size_t l = 0; l < width; ++l)
        lane[l] = f(a[r][l], b[r][l]);
      truth(o.dst)[r] = mask_of(lane);
    }
  }
  void masked_integers(std::int32_t dst, const Mask* mask, const Integers* yes, const Integers* no) {
    Integers* to = integer(dst);
    for (std::size_t r = 0; r < rows; ++r) {
      const auto lane = lanes_of_mask(mask[r]);
      for (std::size_t l = 0; l < width; ++l)
        to[r][l] = lane[l] ? yes[r][l] : no[r][l];
    }
  }
  template <class F>
  void to_number(const Operation& o, F f) {
    for (std::size_t r = 0; r < rows; ++r) {
      std::array<double, width> x;
      for (std::size_t l = 0; l < width; ++l)
        x[l] = f(integer(o.a)[r][l]);
      number(o.dst)[r] = number_of(x);
    }
  }
  template <class F>
  void to_integer(const Operation& o, F f) {
    for (std::size_t r = 0; r < rows; ++r) {
      const auto x = lanes_of_number(number(o.a)[r]);
      for (std::size_t l = 0; l < width; ++l)
        integer(o.dst)[r][l] = f(x[l]);
    }
  }

  const Program& program_;
  const std::string& name_;
  std::vector<R> numbers_;
  std::vector<Integers> integers_;
  std::unique_ptr<Mask[]> truths_;  // bools too must have addresses
  std::unique_ptr<Mask[]> waiting_; ///< [block][row]: lanes that wait for it
  std::vector<char> is_waited_for_;
  std::array<Mask, rows> active_{};
  bool all_active_ = true;
  std::size_t executed_ = 0;
  std::size_t first_ = 0; ///< of the blocks that the last one led to
};

} // namespace nacre::shader
