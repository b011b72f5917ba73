#pragma once
// A SPIR-V module taken apart: types, constants, variables and functions as lists of instructions.
// Source: SPIR-V Specification 1.6, Khronos.

#include "bsdf/shader/program.h"

#include <functional>
#include <map>
#include <span>
#include <vector>

namespace nacre::shader {

using Id = std::uint32_t;

struct Instruction {
  std::uint16_t opcode = 0;
  Id type = 0, result = 0;             ///< 0: none
  std::vector<std::uint32_t> operands; ///< without those two
  int line = 0;                        ///< in the source; 0: unknown
};

struct Type {
  enum class Form {
    none,
    truth,
    integer,
    number,
    vector,
    matrix,
    array,
    structure,
    pointer
  } form = Form::none;
  bool is_signed = false;
  Id element = 0;           ///< of vector, matrix (its column), array; pointee of a pointer
  std::vector<Id> members;  ///< of a structure
  std::uint32_t count = 0;  ///< of vector, matrix, array
  std::vector<Kind> leaves; ///< its scalars, in order; of a pointer none
  std::size_t excess =
      0; ///< the number of its scalars where that is beyond what a variable may have; 0: it is not
};

struct SpirvBlock {
  Id label = 0;
  std::vector<Instruction> phis, body;
  Instruction exit; ///< the terminator
};

struct SpirvFunction {
  Id id = 0, type = 0;
  std::vector<Instruction> parameters;
  std::vector<SpirvBlock> blocks;
};

struct SpirvModule {
  std::map<Id, Type> types;
  std::map<Id, std::string> names;
  std::vector<Instruction> constants; ///< and specialisation constants, undefined values; in order
  std::vector<Instruction> variables; ///< global
  std::map<Id, SpirvFunction> functions;
  Id entry = 0, glsl_set = 0;
};

/// The line where the text first has a word.
using LineFinder = std::function<int(std::string_view word)>;

/// @throws Error for what is no well-formed module, or uses types that the machine lacks
SpirvModule parse_spirv(std::span<const std::uint32_t> words, const std::string& name,
                        const LineFinder& line_of);

} // namespace nacre::shader
