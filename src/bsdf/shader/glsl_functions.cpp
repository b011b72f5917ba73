#include "bsdf/shader/emitter.h"

#include <cmath>
#include <glslang/SPIRV/GLSL.std.450.h>
#include <numbers>

namespace nacre::shader {

const char* signature(Op op) {
  switch (op) {
#define NACRE_SHADER_CASE(name, result, a, b, c, expression)                                                 \
  case Op::name:                                                                                             \
    return #result #a #b #c;
    NACRE_SHADER_NUMBER_OPS(NACRE_SHADER_CASE)
    NACRE_SHADER_TRUTH_OPS(NACRE_SHADER_CASE)
#undef NACRE_SHADER_CASE
#define NACRE_SHADER_CASE(name, expression) case Op::name:
    NACRE_SHADER_INTEGER_OPS(NACRE_SHADER_CASE)
    return "iii_";
    NACRE_SHADER_COMPARISON_OPS(NACRE_SHADER_CASE)
    return "tii_";
#undef NACRE_SHADER_CASE
  case Op::copy_integer:
    return "ii__";
  case Op::choose_integer:
    return "itii";
  case Op::number_from_signed:
  case Op::number_from_unsigned:
  case Op::number_from_bits:
  case Op::power_of_two:
    return "ni__";
  case Op::integer_from_number:
  case Op::exponent:
  case Op::bits_from_number:
    return "in__";
  case Op::store_number:
  case Op::whole_power:
    return "nn__";
  case Op::store_integer:
    return "ii__";
  case Op::store_truth:
    return "tt__";
  case Op::check_index:
    return "_i__";
  }
  return "____";
}

namespace {

Slot determinant(Emitter& e, const Slots& m, std::size_t n) {
  if (n == 1) return m[0];
  Slot sum = -1;
  for (std::size_t column = 0; column < n; ++column) { // along the first row, Laplace
    Slots minor;
    for (std::size_t c = 0; c < n; ++c)
      for (std::size_t r = 1; r < n && c != column; ++r)
        minor.push_back(m[c * n + r]);
    const Slot term = e.make(Op::multiply, m[column * n], determinant(e, minor, n - 1));
    sum = sum < 0 ? term : e.make(column % 2 ? Op::subtract : Op::add, sum, term);
  }
  return sum;
}

/// The adjugate over the determinant.
Slots inverse(Emitter& e, const Slots& m, std::size_t n) {
  const Slot over = e.make(Op::divide, e.number(1), determinant(e, m, n));
  Slots result(n * n);
  for (std::size_t column = 0; column < n; ++column)
    for (std::size_t row = 0; row < n; ++row) {
      Slots minor;
      for (std::size_t c = 0; c < n; ++c)
        for (std::size_t r = 0; r < n; ++r)
          if (c != row && r != column) minor.push_back(m[c * n + r]);
      const Slot cofactor = n == 1 ? e.number(1) : determinant(e, minor, n - 1);
      const Slot scaled = e.make(Op::multiply, cofactor, over);
      result[column * n + row] = (row + column) % 2 ? e.make(Op::negate, scaled) : scaled;
    }
  return result;
}

std::size_t side_of(const Slots& matrix) {
  return std::size_t(std::lround(std::sqrt(double(matrix.size()))));
}

} // namespace

Slots glsl_function(Emitter& e, std::uint32_t function, const std::vector<Slots>& a) {
  const auto one = [&] { return Slots{e.number(1)}; };
  const auto constant = [&](double x) { return Slots{e.number(x)}; };
  const auto scaled = [&](const Slots& v, double s) { return e.map(Op::multiply, v, constant(s)); };
  const auto length = [&](const Slots& v) { return e.make(Op::square_root, e.dot(v, v)); };
  const auto minus = [&](const Slots& x, const Slots& y) { return e.map(Op::subtract, x, y); };
  const auto plus = [&](const Slots& x, const Slots& y) { return e.map(Op::add, x, y); };
  const auto times = [&](const Slots& x, const Slots& y) { return e.map(Op::multiply, x, y); };
  switch (function) {
  case GLSLstd450Round:
  case GLSLstd450RoundEven:
    return e.map(Op::round_even, a.at(0));
  case GLSLstd450Trunc:
    return e.map(Op::truncate, a.at(0));
  case GLSLstd450FAbs:
    return e.map(Op::absolute, a.at(0));
  case GLSLstd450SAbs:
    return e.map(Op::maximum_signed, a.at(0), e.map(Op::subtract_integer, {e.integer(0)}, a[0]));
  case GLSLstd450FSign:
    return e.map(Op::sign, a.at(0));
  case GLSLstd450SSign:
    return e.map(Op::maximum_signed, {e.integer(-1)}, e.map(Op::minimum_signed, {e.integer(1)}, a.at(0)));
  case GLSLstd450Floor:
    return e.map(Op::floor_of, a.at(0));
  case GLSLstd450Ceil:
    return e.map(Op::ceiling, a.at(0));
  case GLSLstd450Fract:
    return minus(a.at(0), e.map(Op::floor_of, a[0]));
  case GLSLstd450Radians:
    return scaled(a.at(0), std::numbers::pi / 180);
  case GLSLstd450Degrees:
    return scaled(a.at(0), 180 / std::numbers::pi);
  case GLSLstd450Sin:
    return e.map(Op::sine, a.at(0));
  case GLSLstd450Cos:
    return e.map(Op::cosine, a.at(0));
  case GLSLstd450Tan:
    return e.map(Op::tangent, a.at(0));
  case GLSLstd450Asin:
    return e.map(Op::arc_sine, a.at(0));
  case GLSLstd450Acos:
    return e.map(Op::arc_cosine, a.at(0));
  case GLSLstd450Atan:
    return e.map(Op::arc_tangent, a.at(0));
  case GLSLstd450Atan2:
    return e.map(Op::arc_tangent_2, a.at(0), a.at(1));
  case GLSLstd450Sinh:
    return e.map(Op::hyperbolic_sine, a.at(0));
  case GLSLstd450Cosh:
    return e.map(Op::hyperbolic_cosine, a.at(0));
  case GLSLstd450Tanh: { // 1 - 2 / (exp(2x) + 1) overflows to the right values
    const Slots growth = plus(e.map(Op::exponential, scaled(a.at(0), 2)), one());
    return minus(one(), e.map(Op::divide, constant(2), growth));
  }
  case GLSLstd450Asinh: { // sign(x) log(|x| + sqrt(x^2 + 1))
    const Slots x = e.map(Op::absolute, a.at(0));
    const Slots r = e.map(Op::logarithm, plus(x, e.map(Op::square_root, plus(times(x, x), one()))));
    return times(e.map(Op::sign, a[0]), r);
  }
  case GLSLstd450Acosh:
    return e.map(Op::logarithm, plus(a.at(0), e.map(Op::square_root, minus(times(a[0], a[0]), one()))));
  case GLSLstd450Atanh:
    return scaled(e.map(Op::logarithm, e.map(Op::divide, plus(one(), a.at(0)), minus(one(), a[0]))), 0.5);
  case GLSLstd450Pow:
    return e.map(Op::power, a.at(0), a.at(1));
  case GLSLstd450Exp:
    return e.map(Op::exponential, a.at(0));
  case GLSLstd450Log:
    return e.map(Op::logarithm, a.at(0));
  case GLSLstd450Exp2:
    return e.map(Op::exponential, scaled(a.at(0), std::numbers::ln2));
  case GLSLstd450Log2:
    return scaled(e.map(Op::logarithm, a.at(0)), std::numbers::log2e);
  case GLSLstd450Sqrt:
    return e.map(Op::square_root, a.at(0));
  case GLSLstd450InverseSqrt:
    return e.map(Op::divide, one(), e.map(Op::square_root, a.at(0)));
  case GLSLstd450Determinant:
    return {determinant(e, a.at(0), side_of(a[0]))};
  case GLSLstd450MatrixInverse:
    return inverse(e, a.at(0), side_of(a[0]));
  case GLSLstd450FMin:
    return e.map(Op::minimum, a.at(0), a.at(1));
  case GLSLstd450UMin:
    return e.map(Op::minimum_unsigned, a.at(0), a.at(1));
  case GLSLstd450SMin:
    return e.map(Op::minimum_signed, a.at(0), a.at(1));
  case GLSLstd450FMax:
    return e.map(Op::maximum, a.at(0), a.at(1));
  case GLSLstd450UMax:
    return e.map(Op::maximum_unsigned, a.at(0), a.at(1));
  case GLSLstd450SMax:
    return e.map(Op::maximum_signed, a.at(0), a.at(1));
  case GLSLstd450FClamp:
    return e.map(Op::minimum, e.map(Op::maximum, a.at(0), a.at(1)), a.at(2));
  case GLSLstd450UClamp:
    return e.map(Op::minimum_unsigned, e.map(Op::maximum_unsigned, a.at(0), a.at(1)), a.at(2));
  case GLSLstd450SClamp:
    return e.map(Op::minimum_signed, e.map(Op::maximum_signed, a.at(0), a.at(1)), a.at(2));
  case GLSLstd450FMix:
    return plus(times(a.at(0), minus(one(), a.at(2))), times(a.at(1), a[2]));
  case GLSLstd450Step:
    return e.map(Op::choose, e.map(Op::less, a.at(1), a.at(0)), constant(0), one());
  case GLSLstd450SmoothStep: {
    const Slots t = e.map(Op::divide, minus(a.at(2), a.at(0)), minus(a.at(1), a[0]));
    const Slots inside = e.map(Op::minimum, e.map(Op::maximum, t, constant(0)), one());
    return times(times(inside, inside), minus(constant(3), scaled(inside, 2)));
  }
  case GLSLstd450Fma:
    return plus(times(a.at(0), a.at(1)), a.at(2));
  case GLSLstd450Ldexp:
    return times(a.at(0), e.map(Op::power_of_two, a.at(1)));
  case GLSLstd450FrexpStruct: { // the significand, then the exponent
    const Slots exponent = e.map(Op::exponent, a.at(0));
    const Slots down = e.map(Op::power_of_two, e.map(Op::subtract_integer, {e.integer(0)}, exponent));
    Slots both = times(a[0], down);
    both.insert(both.end(), exponent.begin(), exponent.end());
    return both;
  }
  case GLSLstd450Length:
    return {length(a.at(0))};
  case GLSLstd450Distance:
    return {length(minus(a.at(0), a.at(1)))};
  case GLSLstd450Cross: {
    const Slots &x = a.at(0), &y = a.at(1);
    Slots result;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      result.push_back(e.make(Op::subtract, e.make(Op::multiply, x.at(j), y.at(k)),
                              e.make(Op::multiply, x.at(k), y.at(j))));
    }
    return result;
  }
  case GLSLstd450Normalize:
    return e.map(Op::divide, a.at(0), {length(a[0])});
  case GLSLstd450FaceForward: { // N, I, Nref
    const Slot towards = e.make(Op::less, e.dot(a.at(2), a.at(1)), e.number(0));
    return e.map(Op::choose, {towards}, a[0], e.map(Op::negate, a[0]));
  }
  case GLSLstd450Reflect: // I - 2 dot(N, I) N
    return minus(a.at(0), times(a.at(1), scaled({e.dot(a[1], a[0])}, 2)));
  case GLSLstd450Refract: { // I, N, eta
    const Slots d{e.dot(a.at(1), a.at(0))}, eta = a.at(2);
    const Slots k = minus(one(), times(times(eta, eta), minus(one(), times(d, d))));
    const Slots total = e.map(Op::less, k, constant(0));
    const Slots root = e.map(Op::square_root, e.map(Op::maximum, k, constant(0)));
    const Slots bent = minus(times(a[0], eta), times(a[1], plus(times(eta, d), root)));
    return e.map(Op::choose, total, constant(0), bent);
  }
  default:
    return {};
  }
}

} // namespace nacre::shader
