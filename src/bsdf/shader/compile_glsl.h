#pragma once
// GLSL to SPIR-V. The one place that knows the front end (glslang).

#include "bsdf/shader/glsl_text.h"

#include <cstdint>
#include <vector>

namespace nacre::shader {

/// A fragment shader of desktop GLSL 4.10: the user's text between what comes before and after it.
/// @param before  declarations, with #line directives of their own
/// @param after   a main function that calls the user's
/// @param wanted  what the user's text has to declare, for the message where main does not compile
/// @throws Error with the line of each of the first errors
std::vector<std::uint32_t> compile_glsl(const std::string& before, const GlslText& glsl,
                                        const std::string& after, const std::string& wanted);

} // namespace nacre::shader
