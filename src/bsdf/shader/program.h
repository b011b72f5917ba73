#pragma once
// A shader as the vectorised machine runs it: blocks of scalar operations on numbered slots, of which there
// are three kinds: numbers (of the machine's number type, with derivatives if it has them), integers and
// truths. Vectors, matrices, arrays and structures are slots side by side; functions are inlined, so every
// address is known but for an index computed by the shader, which becomes a choice among slots.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace nacre::shader {

enum class Kind : std::uint8_t { number, integer, truth };

// The operations, as X(name, kind of the result, kinds of the operands a b c, result). n: number, i: 32-bit
// integer, t: truth, _: none. Integers are signed; what GLSL calls uint has operations of its own where the
// difference shows.
#define NACRE_SHADER_NUMBER_OPS(X)                                                                           \
  X(add, n, n, n, _, a + b)                                                                                  \
  X(subtract, n, n, n, _, a - b)                                                                             \
  X(multiply, n, n, n, _, a* b)                                                                              \
  X(divide, n, n, n, _, a / b)                                                                               \
  X(negate, n, n, _, _, -a)                                                                                  \
  X(modulo, n, n, n, _, a - b * floor(R(a / b)))                                                             \
  X(remainder, n, n, n, _, a - b * truncated(R(a / b)))                                                      \
  X(square_root, n, n, _, _, root(a))                                                                        \
  X(sine, n, n, _, _, sin(a))                                                                                \
  X(cosine, n, n, _, _, cos(a))                                                                              \
  X(tangent, n, n, _, _, tan(a))                                                                             \
  X(arc_sine, n, n, _, _, arc(a, [](const R& x) { return R(asin(x)); }))                                     \
  X(arc_cosine, n, n, _, _, arc(a, [](const R& x) { return R(acos(x)); }))                                   \
  X(arc_tangent, n, n, _, _, atan2(a, R(1)))                                                                 \
  X(arc_tangent_2, n, n, n, _, atan2(a, b))                                                                  \
  X(hyperbolic_sine, n, n, _, _, (exp(a) - exp(R(-a))) * R(0.5f))                                            \
  X(hyperbolic_cosine, n, n, _, _, (exp(a) + exp(R(-a))) * R(0.5f))                                          \
  X(power, n, n, n, _, raised(a, b))                                                                         \
  X(exponential, n, n, _, _, exp(a))                                                                         \
  X(logarithm, n, n, _, _, log(a))                                                                           \
  X(floor_of, n, n, _, _, floor(a))                                                                          \
  X(ceiling, n, n, _, _, -floor(R(-a)))                                                                      \
  X(truncate, n, n, _, _, truncated(a))                                                                      \
  X(round_even, n, n, _, _, rounded_even(a))                                                                 \
  X(absolute, n, n, _, _, abs(a))                                                                            \
  X(sign, n, n, _, _, select(a > R(0), R(1), R(select(a < R(0), R(-1), R(0)))))                              \
  X(minimum, n, n, n, _, min(a, b))                                                                          \
  X(maximum, n, n, n, _, max(a, b))                                                                          \
  X(choose, n, t, n, n, select(a, b, c))                                                                     \
  X(copy, n, n, _, _, a)

#define NACRE_SHADER_TRUTH_OPS(X)                                                                            \
  X(less, t, n, n, _, a < b)                                                                                 \
  X(less_equal, t, n, n, _, a <= b)                                                                          \
  X(equal, t, n, n, _, a == b)                                                                               \
  X(not_equal, t, n, n, _, a != b)                                                                           \
  X(is_nan, t, n, _, _, !(a == a))                                                                           \
  X(is_infinite, t, n, _, _, (a == a) & !(abs(R(a - a)) == R(0)))                                            \
  X(both, t, t, t, _, a& b)                                                                                  \
  X(either, t, t, t, _, a | b)                                                                               \
  X(opposite, t, t, _, _, !a)                                                                                \
  X(same_truth, t, t, t, _, (a & b) | ((!a) & (!b)))                                                         \
  X(choose_truth, t, t, t, t, (a & b) | ((!a) & c))                                                          \
  X(copy_truth, t, t, _, _, a)

// On one lane, int32 a, b, c; wrapping as GLSL asks.
#define NACRE_SHADER_INTEGER_OPS(X)                                                                          \
  X(add_integer, std::int32_t(std::uint32_t(a) + std::uint32_t(b)))                                          \
  X(subtract_integer, std::int32_t(std::uint32_t(a) - std::uint32_t(b)))                                     \
  X(multiply_integer, std::int32_t(std::uint32_t(a) * std::uint32_t(b)))                                     \
  X(divide_signed, b == 0 ? 0 : (b == -1 ? std::int32_t(0u - std::uint32_t(a)) : a / b))                     \
  X(divide_unsigned, b == 0 ? 0 : std::int32_t(std::uint32_t(a) / std::uint32_t(b)))                         \
  X(remainder_signed, b == 0 || b == -1 ? 0 : a % b)                                                         \
  X(modulo_signed, b == 0 || b == -1 ? 0 : (a % b + b) % b)                                                  \
  X(modulo_unsigned, b == 0 ? 0 : std::int32_t(std::uint32_t(a) % std::uint32_t(b)))                         \
  X(shift_left, std::int32_t(std::uint32_t(a) << (b & 31)))                                                  \
  X(shift_right_signed, a >> (b & 31))                                                                       \
  X(shift_right_unsigned, std::int32_t(std::uint32_t(a) >> (b & 31)))                                        \
  X(bits_and, a& b)                                                                                          \
  X(bits_or, a | b)                                                                                          \
  X(bits_xor, a ^ b)                                                                                         \
  X(minimum_signed, a < b ? a : b)                                                                           \
  X(maximum_signed, a > b ? a : b)                                                                           \
  X(minimum_unsigned, std::uint32_t(a) < std::uint32_t(b) ? a : b)                                           \
  X(maximum_unsigned, std::uint32_t(a) > std::uint32_t(b) ? a : b)

// On one lane, giving a truth.
#define NACRE_SHADER_COMPARISON_OPS(X)                                                                       \
  X(equal_integer, a == b)                                                                                   \
  X(less_signed, a < b)                                                                                      \
  X(less_equal_signed, a <= b)                                                                               \
  X(less_unsigned, std::uint32_t(a) < std::uint32_t(b))                                                      \
  X(less_equal_unsigned, std::uint32_t(a) <= std::uint32_t(b))

enum class Op : std::uint8_t {
#define NACRE_SHADER_NAME(name, ...) name,
  NACRE_SHADER_NUMBER_OPS(NACRE_SHADER_NAME) NACRE_SHADER_TRUTH_OPS(NACRE_SHADER_NAME)
      NACRE_SHADER_INTEGER_OPS(NACRE_SHADER_NAME) NACRE_SHADER_COMPARISON_OPS(NACRE_SHADER_NAME)
#undef NACRE_SHADER_NAME
          copy_integer,
  choose_integer,       ///< a truth, b and c integers
  number_from_signed,   ///< n <- i
  number_from_unsigned, ///< n <- i
  integer_from_number,  ///< i <- n, towards 0
  bits_from_number,     ///< i <- n, as float
  number_from_bits,     ///< n <- i
  exponent,             ///< i <- n: a = x 2^exponent with x in [1/2, 1); 0 for 0 and what is not finite
  power_of_two,         ///< n <- i, exact
  store_number,         ///< dst <- a where the lane is active
  store_integer,
  store_truth,
  whole_power, ///< n <- n to the power of the number b itself, see max_whole_power
  check_index, ///< fails if a, an active lane's index, lies outside [0, b); c is the line
};

/// pow with an exponent that the text itself says to be whole, from 0 to this, multiplies: so squares of
/// negative numbers are what graphics drivers give for them, though GLSL leaves them undefined.
inline constexpr int max_whole_power = 8;

/// What an operation reads and writes, as three letters after the result's: "nnn_".
const char* signature(Op op);

struct Operation {
  Op op;
  std::int32_t dst, a, b, c;
};

/// Where a block goes. Values that the target takes from this block alone are copied on the way.
struct Edge {
  std::int32_t target = -1;        ///< block; -1: the end
  std::int32_t begin = 0, end = 0; ///< of those copies in Program::operations
};

struct Block {
  std::int32_t begin = 0, end = 0; ///< in Program::operations
  enum class Exit : std::uint8_t { jump, branch, choice } exit = Exit::jump;
  std::int32_t condition = -1; ///< of a branch a truth; of a choice an integer
  Edge yes, no;                ///< jump: yes. branch: both. choice: no is the default
  std::vector<std::pair<std::int32_t, Edge>> cases;
  std::int32_t line = 0; ///< in the shader's text, for messages
};

/// Blocks stand in such an order that lanes which part meet again if always the first block that lanes wait
/// for is run: a construct's blocks before what follows it. A jump backwards is a loop.
struct Program {
  std::vector<Operation> operations;
  std::vector<Block> blocks;                          ///< the first is where it begins
  std::int32_t numbers = 0, integers = 0, truths = 0; ///< slots of each kind
  std::vector<std::pair<std::int32_t, double>> number_constants;
  std::vector<std::pair<std::int32_t, std::int32_t>> integer_constants;
  std::vector<std::pair<std::int32_t, bool>> truth_constants;
  struct Variable {
    std::string name;
    Kind kind = Kind::number;
    std::vector<std::int32_t> slots;
  };
  std::vector<Variable> uniforms, inputs, outputs;
};

} // namespace nacre::shader
