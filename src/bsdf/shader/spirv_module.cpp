#include "bsdf/shader/spirv_module.h"

#include "core/error.h"

#include <fmt/format.h>
#define SPV_ENABLE_UTILITY_CODE // HasResultAndType
#include <glslang/SPIRV/spirv.hpp>

namespace nacre::shader {
namespace {

constexpr std::size_t max_leaves = 4096; // scalars of one variable

std::string text_at(std::span<const std::uint32_t> words) {
  std::string text;
  for (const std::uint32_t w : words)
    for (int shift = 0; shift < 32; shift += 8) {
      const char c = char(w >> shift & 0xff);
      if (c == 0) return text;
      text += c;
    }
  return text;
}

class Parser {
public:
  Parser(std::span<const std::uint32_t> words, const std::string& name, const LineFinder& line_of)
      : words_(words), name_(name), line_of_(line_of) {}

  SpirvModule parse() {
    if (words_.size() < 5 || words_[0] != spv::MagicNumber) fail("the front end gave no SPIR-V module");
    SpirvBlock* block = nullptr;
    SpirvFunction* function = nullptr;
    for (std::size_t at = 5; at < words_.size();) {
      const std::uint32_t length = words_[at] >> 16;
      if (length == 0 || at + length > words_.size()) fail("an instruction is cut off");
      const auto operands = words_.subspan(at + 1, length - 1);
      Instruction i = instruction(std::uint16_t(words_[at] & 0xffff), operands);
      at += length;
      switch (spv::Op(i.opcode)) {
      case spv::OpLine:
        line_ = int(i.operands.at(1));
        continue;
      case spv::OpNoLine:
        continue; // the last known line says more than none
      case spv::OpName:
        module_.names[i.operands.at(0)] = text_at(operands.subspan(1));
        continue;
      case spv::OpExtInstImport:
        if (text_at(operands.subspan(1)) == "GLSL.std.450") module_.glsl_set = i.result;
        continue;
      case spv::OpEntryPoint:
        module_.entry = i.operands.at(1);
        continue;
      case spv::OpVariable:
        check_size(i);
        if (!function)
          module_.variables.push_back(std::move(i));
        else if (block)
          block->body.push_back(std::move(i));
        continue;
      case spv::OpFunction:
        function = &module_.functions[i.result];
        function->id = i.result;
        function->type = i.type;
        continue;
      case spv::OpFunctionParameter:
        if (function) function->parameters.push_back(std::move(i));
        continue;
      case spv::OpFunctionEnd:
        function = nullptr, block = nullptr;
        continue;
      case spv::OpLabel:
        if (!function) fail("a block outside a function");
        function->blocks.emplace_back();
        block = &function->blocks.back();
        block->label = i.result;
        continue;
      default:
        break;
      }
      if (is_type(i)) {
        add_type(i);
      } else if (is_constant(i)) {
        if (const std::size_t excess = type(i.type).excess)
          fail(fmt::format("a constant has {} numbers, more than the {} of a variable", excess, max_leaves));
        module_.constants.push_back(std::move(i));
      } else if (block) {
        if (i.opcode == spv::OpPhi)
          block->phis.push_back(std::move(i));
        else if (is_exit(i))
          block->exit = std::move(i);
        else if (i.opcode != spv::OpSelectionMerge && i.opcode != spv::OpLoopMerge)
          block->body.push_back(std::move(i));
      } // else decorations, modes, capabilities, sources: nothing that changes a value
    }
    return std::move(module_);
  }

private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(line_ > 0 ? fmt::format("{}:{}: {}", name_, line_, what)
                          : fmt::format("{}: {}", name_, what));
  }

  Instruction instruction(std::uint16_t opcode, std::span<const std::uint32_t> operands) const {
    Instruction i;
    i.opcode = opcode;
    i.line = line_;
    bool has_result = false, has_type = false;
    spv::HasResultAndType(spv::Op(opcode), &has_result, &has_type);
    std::size_t k = 0;
    if (operands.size() < std::size_t(has_result) + std::size_t(has_type))
      fail("an instruction is too short");
    if (has_type) i.type = operands[k++];
    if (has_result) i.result = operands[k++];
    i.operands.assign(operands.begin() + std::ptrdiff_t(k), operands.end());
    return i;
  }
  static bool is_type(const Instruction& i) {
    return i.opcode >= spv::OpTypeVoid && i.opcode <= spv::OpTypePipe;
  }
  static bool is_constant(const Instruction& i) {
    return (i.opcode >= spv::OpConstantTrue && i.opcode <= spv::OpSpecConstantOp) || i.opcode == spv::OpUndef;
  }
  static bool is_exit(const Instruction& i) {
    return (i.opcode >= spv::OpBranch && i.opcode <= spv::OpUnreachable) ||
           i.opcode == spv::OpTerminateInvocation;
  }

  const Type& type(Id id) const {
    const auto found = module_.types.find(id);
    if (found == module_.types.end()) fail("a type is used before it is declared");
    return found->second;
  }

  void add_type(const Instruction& i) {
    using Form = Type::Form;
    Type t;
    const auto repeat = [&](Form form, Id element, std::uint32_t count) {
      t.form = form;
      t.element = element;
      t.count = count;
      const std::vector<Kind>& one = type(element).leaves;
      const std::size_t numbers = std::max(one.size(), type(element).excess) * count;
      if (numbers > max_leaves) {
        t.excess = numbers;
        return;
      }
      for (std::uint32_t k = 0; k < count; ++k)
        t.leaves.insert(t.leaves.end(), one.begin(), one.end());
    };
    switch (spv::Op(i.opcode)) {
    case spv::OpTypeBool:
      t.form = Form::truth, t.leaves = {Kind::truth};
      break;
    case spv::OpTypeInt:
      if (i.operands.at(0) != 32) fail("integers of other than 32 bits");
      t.form = Form::integer, t.is_signed = i.operands.at(1) != 0, t.leaves = {Kind::integer};
      break;
    case spv::OpTypeFloat:
      if (i.operands.at(0) != 32) fail("double precision is not supported: use float");
      t.form = Form::number, t.leaves = {Kind::number};
      break;
    case spv::OpTypeVector:
      repeat(Form::vector, i.operands.at(0), i.operands.at(1));
      break;
    case spv::OpTypeMatrix:
      repeat(Form::matrix, i.operands.at(0), i.operands.at(1));
      break;
    case spv::OpTypeArray:
      repeat(Form::array, i.operands.at(0), array_length(i.operands.at(1)));
      break;
    case spv::OpTypeStruct:
      t.form = Form::structure;
      t.members.assign(i.operands.begin(), i.operands.end());
      for (const Id member : t.members) {
        const auto& leaves = type(member).leaves;
        t.excess += std::max(leaves.size(), type(member).excess);
        t.leaves.insert(t.leaves.end(), leaves.begin(), leaves.end());
      }
      if (t.excess > max_leaves)
        t.leaves.clear();
      else
        t.excess = 0;
      break;
    case spv::OpTypePointer:
      t.form = Form::pointer;
      t.element = i.operands.at(1);
      break;
    case spv::OpTypeImage:
    case spv::OpTypeSampler:
    case spv::OpTypeSampledImage:
      fail("textures are not supported");
    default:
      break; // void, functions: no values
    }
    module_.types[i.result] = std::move(t);
  }

  /// A type that is too large is an error where something is of it: that has a name, and with it a line.
  void check_size(const Instruction& variable) {
    const std::size_t excess = type(type(variable.type).element).excess;
    if (excess == 0) return;
    const auto found = module_.names.find(variable.result);
    const std::string name = found == module_.names.end() ? "" : found->second;
    if (const int line = line_of_(name); line > 0) line_ = line;
    fail(fmt::format("{} has {} numbers, more than the {} of a variable",
                     name.empty() ? "a variable" : "'" + name + "'", excess, max_leaves));
  }

  std::uint32_t array_length(Id id) const {
    for (const Instruction& c : module_.constants)
      if (c.result == id && c.opcode == spv::OpConstant && !c.operands.empty()) return c.operands[0];
    fail("the length of an array is not a constant");
  }

  std::span<const std::uint32_t> words_;
  const std::string& name_;
  const LineFinder& line_of_;
  SpirvModule module_;
  int line_ = 0;
};

} // namespace

SpirvModule parse_spirv(std::span<const std::uint32_t> words, const std::string& name,
                        const LineFinder& line_of) {
  try {
    return Parser(words, name, line_of).parse();
  } catch (const std::out_of_range&) {
    throw Error(name + ": an instruction of the SPIR-V module is too short");
  }
}

} // namespace nacre::shader
