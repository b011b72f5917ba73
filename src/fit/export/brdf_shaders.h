#pragma once
// The models that are also written as GLSL, for programs that take a reflectance function as a shader.

#include <span>
#include <string_view>
#include <vector>

namespace nacre {

/// A function of GLSL 4.10: of a model `vec3 NAME(vec3 wo, vec3 wi, parameters...)` with the parameters that
/// the model declares, in their order, a colour as vec3; or what such functions call.
struct Shader {
  std::string_view name;
  std::vector<std::string_view> calls; ///< other shaders by name; these and what they call come before it
  std::string_view text;
};

/// Called by models.
std::span<const Shader> shared_shaders();
/// Named like the models of the list. Directions are those of bsdf/model.h, both above the surface.
std::span<const Shader> model_shaders();

} // namespace nacre
