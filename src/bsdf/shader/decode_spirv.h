#pragma once
// From SPIR-V, as a GLSL front end writes it for a fragment shader, to the machine's program.

#include "bsdf/shader/spirv_module.h"

#include <span>

namespace nacre::shader {

/// Inlines all functions from `main` on; recursion is an error. Names of uniforms, inputs and outputs are
/// those of OpName.
/// @param name     of the shader, for messages
/// @param line_of  of a variable, which itself knows of none
/// @throws Error with the line for what the machine does not run: textures, derivatives by pixel, double
/// precision and the like; and for a module that is not well-formed
Program decode_spirv(std::span<const std::uint32_t> words, const std::string& name,
                     const LineFinder& line_of);

} // namespace nacre::shader
