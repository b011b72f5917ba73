#pragma once
// Disney's .brdf files: a parameter block and a GLSL function. Source: the format as BRDF Explorer reads it,
// Walt Disney Animation Studios 2011.

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

struct BrdfFile {
  struct Parameter {
    enum class Form { number, truth, color } form;
    std::string name;
    double lo = 0, hi = 1;
    std::array<double, 3> initial{};
    int line = 0;
  };
  std::string name; ///< of the file, for messages
  std::vector<Parameter> parameters;
  std::string shader;  ///< GLSL
  int shader_line = 0; ///< of its first line in the file
};

/// Text beyond this many bytes is no such file.
inline constexpr std::size_t max_brdf_bytes = 1 << 20;

/// Of the text around its sections nothing is read, nor are sections of other names: as BRDF Explorer does.
/// @throws Error with line and column for what is not such a file
BrdfFile parse_brdf_file(std::string_view text, std::string_view name);
/// The text of a file. @throws Error, before anything is read, for one that is too large or no plain file
std::string read_brdf_text(const std::string& path);

} // namespace nacre
