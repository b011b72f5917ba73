#pragma once
// GLSL to SPIR-V. The one place that knows the front end (glslang).

#include <cstdint>
#include <string>
#include <vector>

namespace nacre::shader {

/// A fragment shader of desktop GLSL 4.10. Lines are counted as the text's #line directives say.
/// @param name  of the file, for messages
/// @throws Error with the line of each of the first errors
std::vector<std::uint32_t> compile_glsl(const std::string& text, const std::string& name);

} // namespace nacre::shader
