#include "bsdf/shader/decode_spirv.h"

#include "bsdf/shader/emitter.h"
#include "bsdf/shader/spirv_module.h"
#include "core/error.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <glslang/SPIRV/GLSL.std.450.h>
#include <glslang/SPIRV/spirv.hpp>

namespace nacre::shader {
namespace {

constexpr std::size_t max_operations = 400000;

/// Of the functions that GLSL has and glsl_function has not.
std::string name_of_function(std::uint32_t function) {
  switch (function) {
  case GLSLstd450PackSnorm4x8:
    return "packSnorm4x8";
  case GLSLstd450PackUnorm4x8:
    return "packUnorm4x8";
  case GLSLstd450PackSnorm2x16:
    return "packSnorm2x16";
  case GLSLstd450PackUnorm2x16:
    return "packUnorm2x16";
  case GLSLstd450PackHalf2x16:
    return "packHalf2x16";
  case GLSLstd450UnpackSnorm2x16:
    return "unpackSnorm2x16";
  case GLSLstd450UnpackUnorm2x16:
    return "unpackUnorm2x16";
  case GLSLstd450UnpackHalf2x16:
    return "unpackHalf2x16";
  case GLSLstd450UnpackSnorm4x8:
    return "unpackSnorm4x8";
  case GLSLstd450UnpackUnorm4x8:
    return "unpackUnorm4x8";
  case GLSLstd450FindILsb:
    return "findLSB";
  case GLSLstd450FindSMsb:
  case GLSLstd450FindUMsb:
    return "findMSB";
  default:
    return fmt::format("built-in function {}", function);
  }
}

/// A place in memory: which slots, and if the shader computes an index, which of several.
struct Pointer {
  Id type = 0; ///< of what it points to
  std::vector<Slots> candidates;
  Slot index = -1;          ///< an integer, of the candidate; -1: there is one
  bool is_constant = false; ///< nobody stores there
};

struct Frame {
  const SpirvFunction* function = nullptr;
  std::map<Id, Slots> values;
  std::map<Id, Pointer> pointers;
  std::map<Id, std::int32_t> block_of; ///< label to its first block in the program
  struct Fixup {
    std::int32_t block;
    int which; ///< -1: yes, -2: no, else a case
    Id label;
  };
  std::vector<Fixup> fixups;
  std::vector<std::int32_t> returns; ///< blocks that end in a return
  Slots result;
};

class Decoder {
public:
  Decoder(const SpirvModule& module, const std::string& name) : m_(module), name_(name) {}

  Program decode() {
    for (const Instruction& i : m_.constants)
      add_constant(i);
    begin_block();
    for (const Instruction& i : m_.variables)
      add_global(i);
    const auto entry = m_.functions.find(m_.entry);
    if (entry == m_.functions.end()) fail("the module has no main function");
    Frame frame;
    frame.function = &entry->second;
    inline_function(frame);
    for (const std::int32_t b : frame.returns)
      block(b).yes.target = -1;
    find_whole_powers();
    share_slots();
    return std::move(e_.program);
  }

private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(line_ > 0 ? fmt::format("{}:{}: {}", name_, line_, what)
                          : fmt::format("{}: {}", name_, what));
  }
  const Type& type(Id id) const {
    const auto found = m_.types.find(id);
    if (found == m_.types.end()) fail("a value of unknown type");
    return found->second;
  }
  const std::vector<Kind>& leaves(Id id) const { return type(id).leaves; }
  std::string name_of(Id id) const {
    const auto found = m_.names.find(id);
    return found == m_.names.end() ? std::string() : found->second;
  }

  // Blocks.

  Block& block(std::int32_t i) { return e_.program.blocks[std::size_t(i)]; }
  std::int32_t current() const { return std::int32_t(e_.program.blocks.size()) - 1; }
  void begin_block() {
    Block b;
    b.begin = b.end = std::int32_t(e_.program.operations.size());
    b.line = line_;
    e_.program.blocks.push_back(b);
  }
  void end_block() {
    block(current()).end = std::int32_t(e_.program.operations.size());
    block(current()).line = line_;
    if (e_.program.operations.size() > max_operations) fail("the shader is too large");
  }

  // Values.

  void add_constant(const Instruction& i) {
    const Type& t = type(i.type);
    Slots slots;
    const auto zero = [&](Kind k) {
      return k == Kind::number ? e_.number(0) : k == Kind::integer ? e_.integer(0) : e_.truth(false);
    };
    switch (spv::Op(i.opcode)) {
    case spv::OpConstantTrue:
      slots = {e_.truth(true)};
      break;
    case spv::OpConstantFalse:
      slots = {e_.truth(false)};
      break;
    case spv::OpConstant:
      if (t.form == Type::Form::number)
        slots = {e_.number(double(std::bit_cast<float>(i.operands.at(0))))};
      else
        slots = {e_.integer(std::int32_t(i.operands.at(0)))};
      break;
    case spv::OpConstantComposite:
      for (const Id part : i.operands) {
        const Slots& p = globals_.at(part);
        slots.insert(slots.end(), p.begin(), p.end());
      }
      break;
    case spv::OpConstantNull:
    case spv::OpUndef:
      for (const Kind k : t.leaves)
        slots.push_back(zero(k));
      break;
    default:
      fail("a constant of a kind that is not supported");
    }
    globals_[i.result] = slots;
  }

  void add_global(const Instruction& i) {
    const Id pointee = type(i.type).element;
    const Slots slots = e_.fresh(leaves(pointee));
    const auto storage = spv::StorageClass(i.operands.at(0));
    const bool given = storage == spv::StorageClassUniformConstant || storage == spv::StorageClassInput ||
                       storage == spv::StorageClassUniform;
    global_pointers_[i.result] = {pointee, {slots}, -1, given};
    if (i.operands.size() > 1) e_.store(leaves(pointee), slots, globals_.at(i.operands[1]));
    if (slots.empty()) return;
    const Program::Variable v{name_of(i.result), leaves(pointee).front(), slots};
    if (storage == spv::StorageClassInput)
      e_.program.inputs.push_back(v);
    else if (storage == spv::StorageClassOutput)
      e_.program.outputs.push_back(v);
    else if (given)
      e_.program.uniforms.push_back(v);
  }

  const Slots& value(const Frame& f, Id id) const {
    if (const auto found = f.values.find(id); found != f.values.end()) return found->second;
    if (const auto found = globals_.find(id); found != globals_.end()) return found->second;
    fail("a value is used before it is computed");
  }
  const Pointer& pointer(const Frame& f, Id id) const {
    if (const auto found = f.pointers.find(id); found != f.pointers.end()) return found->second;
    if (const auto found = global_pointers_.find(id); found != global_pointers_.end()) return found->second;
    fail("a variable is used before it is declared");
  }

  /// First scalar and count of part `k` of a composite.
  std::pair<std::size_t, std::size_t> part(const Type& t, std::uint32_t k) const {
    if (t.form == Type::Form::structure) {
      std::size_t begin = 0;
      for (std::uint32_t i = 0; i < k; ++i)
        begin += leaves(t.members.at(i)).size();
      return {begin, leaves(t.members.at(k)).size()};
    }
    if (k >= t.count) fail(fmt::format("index {} outside an array of {}", k, t.count));
    const std::size_t size = leaves(t.element).size();
    return {k * size, size};
  }
  Id part_type(const Type& t, std::uint32_t k) const {
    return t.form == Type::Form::structure ? t.members.at(k) : t.element;
  }

  Slots choose(Slot index, const std::vector<Slots>& candidates, const std::vector<Kind>& kinds) {
    Slots chosen = candidates[0];
    for (std::size_t k = 1; k < candidates.size(); ++k) {
      const Slot is = e_.make(Op::equal_integer, index, e_.integer(std::int32_t(k)));
      for (std::size_t l = 0; l < chosen.size(); ++l)
        chosen[l] = e_.make(Emitter::choose_op(kinds[l]), is, candidates[k][l], chosen[l]);
    }
    return chosen;
  }
  Slots load(const Pointer& p) {
    if (p.index >= 0) return choose(p.index, p.candidates, leaves(p.type));
    return p.is_constant ? p.candidates[0] : e_.copy(leaves(p.type), p.candidates[0]);
  }
  void store(const Pointer& p, const Slots& from) {
    const std::vector<Kind>& kinds = leaves(p.type);
    for (std::size_t k = 0; k < p.candidates.size(); ++k) {
      if (p.index < 0) {
        e_.store(kinds, p.candidates[k], from);
        continue;
      }
      const Slot is = e_.make(Op::equal_integer, p.index, e_.integer(std::int32_t(k)));
      for (std::size_t l = 0; l < kinds.size(); ++l) {
        const Slot to = p.candidates[k][l];
        e_.emit(Emitter::store_op(kinds[l]), to, e_.make(Emitter::choose_op(kinds[l]), is, from[l], to));
      }
    }
  }
  void check_index(Slot index, std::uint32_t count) {
    e_.emit(Op::check_index, 0, index, std::int32_t(count), line_);
  }

  Pointer access(Frame& f, const Instruction& i) {
    Pointer p = pointer(f, i.operands.at(0));
    for (std::size_t k = 1; k < i.operands.size(); ++k) {
      const Slots& index = value(f, i.operands[k]);
      const Type& t = type(p.type);
      const std::int32_t* known = e_.constant_integer(index.at(0));
      if (known) {
        const auto [begin, count] = part(t, std::uint32_t(*known));
        for (Slots& c : p.candidates)
          c = Slots(c.begin() + std::ptrdiff_t(begin), c.begin() + std::ptrdiff_t(begin + count));
        p.type = part_type(t, std::uint32_t(*known));
        continue;
      }
      if (t.form == Type::Form::structure) fail("a member chosen by a computed index");
      check_index(index[0], t.count);
      std::vector<Slots> parts;
      for (const Slots& c : p.candidates)
        for (std::uint32_t n = 0; n < t.count; ++n) {
          const auto [begin, count] = part(t, n);
          parts.emplace_back(c.begin() + std::ptrdiff_t(begin), c.begin() + std::ptrdiff_t(begin + count));
        }
      if (parts.size() > 65536) fail("an array too large for a computed index");
      const Slot before =
          p.index < 0 ? -1 : e_.make(Op::multiply_integer, p.index, e_.integer(std::int32_t(t.count)));
      p.index = before < 0 ? index[0] : e_.make(Op::add_integer, before, index[0]);
      p.candidates = std::move(parts);
      p.type = t.element;
    }
    return p;
  }

  // Control.

  Edge edge(Frame& f, Id from, Id label, int which) {
    Edge edge;
    edge.begin = std::int32_t(e_.program.operations.size());
    for (const SpirvBlock& target : f.function->blocks) {
      if (target.label != label) continue;
      for (const Instruction& phi : target.phis)
        for (std::size_t k = 0; k + 1 < phi.operands.size(); k += 2)
          if (phi.operands[k + 1] == from)
            e_.store(leaves(phi.type), f.values.at(phi.result), value(f, phi.operands[k]));
    }
    edge.end = std::int32_t(e_.program.operations.size());
    f.fixups.push_back({current(), which, label});
    return edge;
  }

  void leave(Frame& f, const SpirvBlock& b) {
    end_block();
    const std::int32_t at = current();
    const Instruction& i = b.exit;
    switch (spv::Op(i.opcode)) {
    case spv::OpBranch: {
      const Edge yes = edge(f, b.label, i.operands.at(0), -1);
      block(at).yes = yes;
      return;
    }
    case spv::OpBranchConditional: {
      block(at).exit = Block::Exit::branch;
      block(at).condition = value(f, i.operands.at(0)).at(0);
      const Edge yes = edge(f, b.label, i.operands.at(1), -1), no = edge(f, b.label, i.operands.at(2), -2);
      block(at).yes = yes, block(at).no = no;
      return;
    }
    case spv::OpSwitch: {
      block(at).exit = Block::Exit::choice;
      block(at).condition = value(f, i.operands.at(0)).at(0);
      block(at).no = edge(f, b.label, i.operands.at(1), -2);
      for (std::size_t k = 2; k + 1 < i.operands.size(); k += 2) {
        const Edge to = edge(f, b.label, i.operands[k + 1], int(k / 2) - 1);
        block(at).cases.emplace_back(std::int32_t(i.operands[k]), to);
      }
      return;
    }
    case spv::OpReturnValue:
      e_.store(leaves(f.function->type), f.result, value(f, i.operands.at(0)));
      block(at).end = std::int32_t(e_.program.operations.size());
      f.returns.push_back(at);
      return;
    case spv::OpReturn:
      f.returns.push_back(at);
      return;
    case spv::OpUnreachable:
    case spv::OpKill:
    case spv::OpTerminateInvocation:
      block(at).yes.target = -1;
      return;
    default:
      fail("a block without an end");
    }
  }

  /// Emits the function's blocks, beginning in the current one; leaves `returns` for the caller to connect.
  void inline_function(Frame& f) {
    if (std::find(calls_.begin(), calls_.end(), f.function->id) != calls_.end())
      fail(fmt::format("the function {} calls itself", name_of(f.function->id)));
    calls_.push_back(f.function->id);
    f.result = e_.fresh(leaves_or_none(f.function->type));
    for (const SpirvBlock& b : f.function->blocks)
      for (const Instruction& phi : b.phis)
        f.values[phi.result] = e_.fresh(leaves(phi.type));
    bool first = true;
    for (const SpirvBlock& b : f.function->blocks) {
      if (!first) begin_block();
      first = false;
      f.block_of[b.label] = current();
      for (const Instruction& i : b.body)
        run(f, i);
      if (b.exit.line) line_ = b.exit.line;
      leave(f, b);
    }
    for (const Frame::Fixup& fix : f.fixups) {
      const auto target = f.block_of.find(fix.label);
      if (target == f.block_of.end()) fail("a jump to nowhere");
      Block& b = block(fix.block);
      (fix.which == -1   ? b.yes
       : fix.which == -2 ? b.no
                         : b.cases.at(std::size_t(fix.which)).second)
          .target = target->second;
    }
    calls_.pop_back();
  }
  std::vector<Kind> leaves_or_none(Id id) const {
    const auto found = m_.types.find(id);
    return found == m_.types.end() ? std::vector<Kind>() : found->second.leaves;
  }

  void call(Frame& f, const Instruction& i) {
    const auto callee = m_.functions.find(i.operands.at(0));
    if (callee == m_.functions.end()) fail("a function without a body");
    Frame inner;
    inner.function = &callee->second;
    if (callee->second.parameters.size() + 1 != i.operands.size())
      fail("a call with a wrong number of arguments");
    for (std::size_t k = 0; k < callee->second.parameters.size(); ++k) {
      const Instruction& parameter = callee->second.parameters[k];
      const Id argument = i.operands[k + 1];
      if (type(parameter.type).form == Type::Form::pointer)
        inner.pointers[parameter.result] = pointer(f, argument);
      else
        inner.values[parameter.result] = value(f, argument);
    }
    inline_function(inner);
    begin_block();
    for (const std::int32_t b : inner.returns)
      block(b).yes.target = current();
    f.values[i.result] = inner.result;
  }

  // Instructions.

  void run(Frame& f, const Instruction& i) {
    if (i.line) line_ = i.line;
    const auto arg = [&](std::size_t k) -> const Slots& { return value(f, i.operands.at(k)); };
    const auto set = [&](Slots slots) { f.values[i.result] = std::move(slots); };
    const auto unary = [&](Op op) { set(e_.map(op, arg(0))); };
    const auto binary = [&](Op op) { set(e_.map(op, arg(0), arg(1))); };
    const auto swapped = [&](Op op) { set(e_.map(op, arg(1), arg(0))); };
    const auto negated = [&](Op op, bool swap = false) {
      set(e_.map(Op::opposite, swap ? e_.map(op, arg(1), arg(0)) : e_.map(op, arg(0), arg(1))));
    };
    switch (spv::Op(i.opcode)) {
    case spv::OpVariable: {
      const Id pointee = type(i.type).element;
      f.pointers[i.result] = {pointee, {e_.fresh(leaves(pointee))}, -1, false};
      if (i.operands.size() > 1) store(f.pointers[i.result], arg(1));
      return;
    }
    case spv::OpLoad:
      return set(load(pointer(f, i.operands.at(0))));
    case spv::OpStore:
      return store(pointer(f, i.operands.at(0)), arg(1));
    case spv::OpCopyMemory:
      return store(pointer(f, i.operands.at(0)), load(pointer(f, i.operands.at(1))));
    case spv::OpAccessChain:
    case spv::OpInBoundsAccessChain: {
      Pointer p = access(f, i);
      f.pointers[i.result] = std::move(p);
      return;
    }
    case spv::OpFunctionCall:
      return call(f, i);
    case spv::OpCopyObject:
    case spv::OpCopyLogical:
      return set(arg(0));
    case spv::OpCompositeConstruct: {
      Slots all;
      for (std::size_t k = 0; k < i.operands.size(); ++k)
        all.insert(all.end(), arg(k).begin(), arg(k).end());
      return set(all);
    }
    case spv::OpCompositeExtract: {
      const auto [begin, count] = path(f, i.operands, 1, i.operands.at(0));
      const Slots& from = arg(0);
      return set(Slots(from.begin() + std::ptrdiff_t(begin), from.begin() + std::ptrdiff_t(begin + count)));
    }
    case spv::OpCompositeInsert: {
      const auto [begin, count] = path(f, i.operands, 2, i.operands.at(1));
      Slots whole = arg(1);
      std::copy_n(arg(0).begin(), count, whole.begin() + std::ptrdiff_t(begin));
      return set(whole);
    }
    case spv::OpVectorShuffle: {
      Slots both = arg(0), chosen;
      both.insert(both.end(), arg(1).begin(), arg(1).end());
      for (std::size_t k = 2; k < i.operands.size(); ++k)
        chosen.push_back(i.operands[k] == 0xffffffffu ? both.at(0) : both.at(i.operands[k]));
      return set(chosen);
    }
    case spv::OpVectorExtractDynamic: {
      const Slots vector = arg(0);
      const Slot index = arg(1).at(0);
      check_index(index, std::uint32_t(vector.size()));
      std::vector<Slots> parts;
      for (const Slot s : vector)
        parts.push_back({s});
      return set(choose(index, parts, leaves(i.type)));
    }
    case spv::OpVectorInsertDynamic: {
      Slots vector = arg(0);
      const Slot index = arg(2).at(0), component = arg(1).at(0);
      check_index(index, std::uint32_t(vector.size()));
      for (std::size_t k = 0; k < vector.size(); ++k)
        vector[k] =
            e_.make(Emitter::choose_op(leaves(i.type)[k]),
                    e_.make(Op::equal_integer, index, e_.integer(std::int32_t(k))), component, vector[k]);
      return set(vector);
    }
    case spv::OpFAdd:
      return binary(Op::add);
    case spv::OpFSub:
      return binary(Op::subtract);
    case spv::OpFMul:
    case spv::OpVectorTimesScalar:
    case spv::OpMatrixTimesScalar:
      return binary(Op::multiply);
    case spv::OpFDiv:
      return binary(Op::divide);
    case spv::OpFMod:
      return binary(Op::modulo);
    case spv::OpFRem:
      return binary(Op::remainder);
    case spv::OpFNegate:
      return unary(Op::negate);
    case spv::OpDot:
      return set({e_.dot(arg(0), arg(1))});
    case spv::OpMatrixTimesVector:
      return set(matrix_times(arg(0), arg(1)));
    case spv::OpVectorTimesMatrix: {
      const Slots vector = arg(0), matrix = arg(1);
      Slots result;
      for (std::size_t c = 0; c * vector.size() < matrix.size(); ++c)
        result.push_back(e_.dot(vector, column(matrix, c, vector.size())));
      return set(result);
    }
    case spv::OpMatrixTimesMatrix: {
      const Slots left = arg(0), right = arg(1);
      const std::size_t columns = type(i.type).count, inner = right.size() / columns;
      Slots result;
      for (std::size_t c = 0; c < columns; ++c) {
        const Slots one = matrix_times(left, column(right, c, inner));
        result.insert(result.end(), one.begin(), one.end());
      }
      return set(result);
    }
    case spv::OpTranspose: {
      const Slots from = arg(0);
      const std::size_t columns = type(i.type).count, rows = from.size() / columns; // of the result
      Slots result;
      for (std::size_t c = 0; c < columns; ++c)
        for (std::size_t r = 0; r < rows; ++r)
          result.push_back(from[r * columns + c]);
      return set(result);
    }
    case spv::OpOuterProduct: {
      Slots result;
      for (const Slot b : Slots(arg(1)))
        for (const Slot a : Slots(arg(0)))
          result.push_back(e_.make(Op::multiply, a, b));
      return set(result);
    }
    case spv::OpFOrdLessThan:
    case spv::OpFUnordLessThan:
      return binary(Op::less);
    case spv::OpFOrdGreaterThan:
    case spv::OpFUnordGreaterThan:
      return swapped(Op::less);
    case spv::OpFOrdLessThanEqual:
    case spv::OpFUnordLessThanEqual:
      return binary(Op::less_equal);
    case spv::OpFOrdGreaterThanEqual:
    case spv::OpFUnordGreaterThanEqual:
      return swapped(Op::less_equal);
    case spv::OpFOrdEqual:
    case spv::OpFUnordEqual:
      return binary(Op::equal);
    case spv::OpFOrdNotEqual:
    case spv::OpFUnordNotEqual:
      return binary(Op::not_equal);
    case spv::OpIsNan:
      return unary(Op::is_nan);
    case spv::OpIsInf:
      return unary(Op::is_infinite);
    case spv::OpLogicalAnd:
      return binary(Op::both);
    case spv::OpLogicalOr:
      return binary(Op::either);
    case spv::OpLogicalNot:
      return unary(Op::opposite);
    case spv::OpLogicalEqual:
      return binary(Op::same_truth);
    case spv::OpLogicalNotEqual:
      return negated(Op::same_truth);
    case spv::OpAny:
      return set({fold(Op::either, arg(0))});
    case spv::OpAll:
      return set({fold(Op::both, arg(0))});
    case spv::OpSelect: {
      const std::vector<Kind>& kinds = leaves(i.type);
      Slots result;
      for (std::size_t k = 0; k < kinds.size(); ++k)
        result.push_back(e_.make(Emitter::choose_op(kinds[k]), arg(0).size() == 1 ? arg(0)[0] : arg(0).at(k),
                                 arg(1)[k], arg(2)[k]));
      return set(result);
    }
    case spv::OpIAdd:
      return binary(Op::add_integer);
    case spv::OpISub:
      return binary(Op::subtract_integer);
    case spv::OpIMul:
      return binary(Op::multiply_integer);
    case spv::OpSDiv:
      return binary(Op::divide_signed);
    case spv::OpUDiv:
      return binary(Op::divide_unsigned);
    case spv::OpSRem:
      return binary(Op::remainder_signed);
    case spv::OpSMod:
      return binary(Op::modulo_signed);
    case spv::OpUMod:
      return binary(Op::modulo_unsigned);
    case spv::OpSNegate:
      return set(e_.map(Op::subtract_integer, {e_.integer(0)}, arg(0)));
    case spv::OpShiftLeftLogical:
      return binary(Op::shift_left);
    case spv::OpShiftRightArithmetic:
      return binary(Op::shift_right_signed);
    case spv::OpShiftRightLogical:
      return binary(Op::shift_right_unsigned);
    case spv::OpBitwiseAnd:
      return binary(Op::bits_and);
    case spv::OpBitwiseOr:
      return binary(Op::bits_or);
    case spv::OpBitwiseXor:
      return binary(Op::bits_xor);
    case spv::OpNot:
      return set(e_.map(Op::bits_xor, arg(0), {e_.integer(-1)}));
    case spv::OpIEqual:
      return binary(Op::equal_integer);
    case spv::OpINotEqual:
      return negated(Op::equal_integer);
    case spv::OpSLessThan:
      return binary(Op::less_signed);
    case spv::OpSGreaterThan:
      return swapped(Op::less_signed);
    case spv::OpSLessThanEqual:
      return binary(Op::less_equal_signed);
    case spv::OpSGreaterThanEqual:
      return swapped(Op::less_equal_signed);
    case spv::OpULessThan:
      return binary(Op::less_unsigned);
    case spv::OpUGreaterThan:
      return swapped(Op::less_unsigned);
    case spv::OpULessThanEqual:
      return binary(Op::less_equal_unsigned);
    case spv::OpUGreaterThanEqual:
      return swapped(Op::less_equal_unsigned);
    case spv::OpConvertSToF:
      return unary(Op::number_from_signed);
    case spv::OpConvertUToF:
      return unary(Op::number_from_unsigned);
    case spv::OpConvertFToS:
    case spv::OpConvertFToU:
      return unary(Op::integer_from_number);
    case spv::OpBitcast: {
      const Kind from = kind_of(f, i.operands.at(0)), to = leaves(i.type).front();
      if (from == to) return set(arg(0));
      return unary(from == Kind::number ? Op::bits_from_number : Op::number_from_bits);
    }
    case spv::OpExtInst:
      return extended(f, i);
    case spv::OpNop:
      return;
    default:
      fail("an instruction that is not supported here: textures, derivatives across pixels and the like have "
           "no "
           "meaning for one pair of directions");
    }
  }

  Kind kind_of(const Frame& f, Id id) const {
    // Every bitcast goes between number and integer: whichever the operand's instruction said.
    for (const SpirvBlock& b : f.function->blocks)
      for (const Instruction& i : b.body)
        if (i.result == id) return leaves(i.type).front();
    for (const Instruction& c : m_.constants)
      if (c.result == id) return leaves(c.type).front();
    fail("a value of unknown type");
  }

  /// Scalars that a path of literal indices leads to, from operand `first` on, in a value with this id's
  /// type.
  std::pair<std::size_t, std::size_t> path(const Frame& f, const std::vector<std::uint32_t>& operands,
                                           std::size_t first, Id composite) const {
    Id id = type_of(f, composite);
    std::size_t begin = 0, count = leaves(id).size();
    for (std::size_t k = first; k < operands.size(); ++k) {
      const Type& t = type(id);
      const auto [b, c] = part(t, operands[k]);
      begin += b, count = c;
      id = part_type(t, operands[k]);
    }
    return {begin, count};
  }
  Id type_of(const Frame& f, Id id) const {
    for (const Instruction& p : f.function->parameters)
      if (p.result == id) return p.type;
    for (const SpirvBlock& b : f.function->blocks) {
      for (const Instruction& i : b.phis)
        if (i.result == id) return i.type;
      for (const Instruction& i : b.body)
        if (i.result == id) return i.type;
    }
    for (const Instruction& c : m_.constants)
      if (c.result == id) return c.type;
    fail("a value of unknown type");
  }

  static Slots column(const Slots& matrix, std::size_t c, std::size_t rows) {
    return Slots(matrix.begin() + std::ptrdiff_t(c * rows), matrix.begin() + std::ptrdiff_t((c + 1) * rows));
  }
  /// Columns one after the other.
  Slots matrix_times(const Slots& matrix, const Slots& vector) {
    const std::size_t columns = vector.size(), rows = matrix.size() / columns;
    Slots sum;
    for (std::size_t c = 0; c < columns; ++c) {
      const Slots term = e_.map(Op::multiply, column(matrix, c, rows), {vector[c]});
      sum = c == 0 ? term : e_.map(Op::add, sum, term);
    }
    return sum;
  }
  Slot fold(Op op, const Slots& a) {
    Slot s = a[0];
    for (std::size_t k = 1; k < a.size(); ++k)
      s = e_.make(op, s, a[k]);
    return s;
  }

  void extended(Frame& f, const Instruction& i) {
    if (i.operands.at(0) != m_.glsl_set) fail("an unknown set of functions");
    const std::uint32_t function = i.operands.at(1);
    std::vector<Slots> arguments;
    if (function == GLSLstd450Modf) { // the whole part goes through a pointer
      const Slots x = value(f, i.operands.at(2)), whole = e_.map(Op::truncate, x);
      store(pointer(f, i.operands.at(3)), whole);
      f.values[i.result] = e_.map(Op::subtract, x, whole);
      return;
    }
    for (std::size_t k = 2; k < i.operands.size(); ++k)
      arguments.push_back(value(f, i.operands[k]));
    Slots result = glsl_function(e_, function, arguments);
    if (result.empty()) fail(fmt::format("{} is not supported", name_of_function(function)));
    f.values[i.result] = std::move(result);
  }

  /// Turns pow with a constant whole exponent into products.
  void find_whole_powers();
  /// Lets results that live and die within one block share slots, so that a program's working set stays in
  /// the nearest cache.
  void share_slots();

  const SpirvModule& m_;
  const std::string& name_;
  Emitter e_;
  std::map<Id, Slots> globals_;
  std::map<Id, Pointer> global_pointers_;
  std::vector<Id> calls_;
  int line_ = 0;
};

void Decoder::find_whole_powers() {
  Program& p = e_.program;
  // A variable that is written once, with a constant, is that constant: arguments of functions are such.
  constexpr Slot nobody = -1, several = -2;
  std::vector<Slot> from(std::size_t(p.numbers), nobody);
  for (const Operation& o : p.operations) {
    if (signature(o.op)[0] != 'n') continue;
    const bool is_copy = o.op == Op::copy || o.op == Op::store_number;
    Slot& source = from[std::size_t(o.dst)];
    source = is_copy && source == nobody ? o.a : several;
  }
  std::map<Slot, double> constants(p.number_constants.begin(), p.number_constants.end());
  for (Operation& o : p.operations) {
    if (o.op != Op::power) continue;
    Slot exponent = o.b;
    // Two variables may be copies of each other.
    for (std::size_t steps = 0; from[std::size_t(exponent)] >= 0 && steps < from.size(); ++steps)
      exponent = from[std::size_t(exponent)];
    const auto known = constants.find(exponent);
    if (known == constants.end() || from[std::size_t(exponent)] != nobody) continue;
    const double x = known->second;
    if (x >= 0 && x <= max_whole_power && x == std::floor(x)) o = {Op::whole_power, o.dst, o.a, Slot(x), 0};
  }
}

void Decoder::share_slots() {
  Program& p = e_.program;
  struct Use {
    std::int32_t block = -1, last = -1;
    bool fixed = false; ///< seen in several blocks, or known outside
  };
  std::array<std::vector<Use>, 3> use;
  const std::array<std::int32_t*, 3> counts{&p.numbers, &p.integers, &p.truths};
  for (std::size_t k = 0; k < 3; ++k)
    use[k].resize(std::size_t(*counts[k]));
  const auto kind = [](char c) { return c == 'n' ? 0 : c == 'i' ? 1 : c == 't' ? 2 : -1; };
  // Slots of an operation, the result first, each with its kind.
  const auto each_slot = [&](Operation& o, auto f) {
    const char* s = signature(o.op);
    for (const auto& [c, slot] : {std::pair{s[1], &o.a}, {s[2], &o.b}, {s[3], &o.c}, {s[0], &o.dst}})
      if (kind(c) >= 0) f(std::size_t(kind(c)), *slot, slot == &o.dst);
  };
  const auto fix = [&](std::size_t k, std::int32_t slot) { use[k][std::size_t(slot)].fixed = true; };
  for (const auto& [s, x] : p.number_constants)
    fix(0, s);
  for (const auto& [s, x] : p.integer_constants)
    fix(1, s);
  for (const auto& [s, x] : p.truth_constants)
    fix(2, s);
  for (const auto* list : {&p.uniforms, &p.inputs, &p.outputs})
    for (const auto& v : *list)
      for (const std::int32_t s : v.slots)
        fix(std::size_t(v.kind), s);
  std::vector<std::int32_t> block_of(p.operations.size(), -2); // -2: on an edge
  for (std::size_t b = 0; b < p.blocks.size(); ++b) {
    std::fill(block_of.begin() + p.blocks[b].begin, block_of.begin() + p.blocks[b].end, std::int32_t(b));
    if (p.blocks[b].exit == Block::Exit::branch) fix(2, p.blocks[b].condition);
    if (p.blocks[b].exit == Block::Exit::choice) fix(1, p.blocks[b].condition);
  }
  const auto is_store = [](Op op) {
    return op == Op::store_number || op == Op::store_integer || op == Op::store_truth;
  };
  for (std::size_t n = 0; n < p.operations.size(); ++n)
    each_slot(p.operations[n], [&](std::size_t k, std::int32_t slot, bool is_result) {
      Use& u = use[k][std::size_t(slot)];
      // What is stored to keeps its lanes of earlier times.
      if ((is_result && is_store(p.operations[n].op)) || block_of[n] == -2) u.fixed = true;
      if (u.block >= 0 && u.block != block_of[n]) u.fixed = true;
      u.block = block_of[n];
      u.last = std::int32_t(n);
    });
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<std::int32_t> renamed(use[k].size(), -1);
    std::int32_t next = 0;
    for (std::size_t s = 0; s < use[k].size(); ++s)
      if (use[k][s].fixed) renamed[s] = next++;
    std::vector<std::int32_t> unused, dying;
    for (std::size_t n = 0; n < p.operations.size(); ++n) {
      dying.clear();
      each_slot(p.operations[n], [&](std::size_t kind_here, std::int32_t& slot, bool) {
        if (kind_here != k) return;
        const std::size_t s = std::size_t(slot);
        if (renamed[s] < 0) { // a result: operands were named when they were results
          renamed[s] = unused.empty() ? next++ : unused.back();
          if (!unused.empty()) unused.pop_back();
        }
        slot = renamed[s];
        if (!use[k][s].fixed && use[k][s].last == std::int32_t(n) &&
            std::find(dying.begin(), dying.end(), slot) == dying.end())
          dying.push_back(slot);
      });
      unused.insert(unused.end(), dying.begin(),
                    dying.end()); // after the result, which is written while they are read
    }
    for (Block& b : p.blocks) {
      if (k == 2 && b.exit == Block::Exit::branch) b.condition = renamed[std::size_t(b.condition)];
      if (k == 1 && b.exit == Block::Exit::choice) b.condition = renamed[std::size_t(b.condition)];
    }
    const auto rename = [&](auto& list) {
      for (auto& entry : list)
        entry.first = renamed[std::size_t(entry.first)];
    };
    if (k == 0) rename(p.number_constants);
    if (k == 1) rename(p.integer_constants);
    if (k == 2) rename(p.truth_constants);
    for (auto* list : {&p.uniforms, &p.inputs, &p.outputs})
      for (auto& v : *list)
        if (std::size_t(v.kind) == k)
          for (std::int32_t& s : v.slots)
            s = renamed[std::size_t(s)];
    *counts[k] = std::max(next, 1);
  }
}

} // namespace

Program decode_spirv(std::span<const std::uint32_t> words, const std::string& name,
                     const LineFinder& line_of) {
  const SpirvModule module = parse_spirv(words, name, line_of);
  try {
    return Decoder(module, name).decode();
  } catch (const std::out_of_range&) {
    throw Error(name + ": the SPIR-V module refers to what is not there");
  }
}

} // namespace nacre::shader
