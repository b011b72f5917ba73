// Disney's BRDF Explorer: a .brdf file of parameters with their ranges and a GLSL function.
// Source of the format: Disney's BRDF Explorer, its own .brdf files.

#include "core/error.h"
#include "fit/export/brdf_shaders.h"
#include "fit/export/target.h"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace nacre {
namespace {

const Shader* shader(std::span<const Shader> shaders, std::string_view name) {
  const auto found =
      std::find_if(shaders.begin(), shaders.end(), [&](const auto& s) { return s.name == name; });
  return found == shaders.end() ? nullptr : &*found;
}

std::optional<MaterialSpec> express(const MaterialSpec& material) {
  for (const LobeSpec& lobe : material.lobes)
    if (lobe.measured || !shader(model_shaders(), model_info(lobe).name)) return {};
  return material;
}

/// The shader after those that it calls, each once.
void append(std::string& text, std::set<std::string_view>& written, const Shader& s) {
  if (!written.insert(s.name).second) return;
  for (const std::string_view called : s.calls)
    append(text, written, *shader(shared_shaders(), called));
  text += s.text;
}

/// What a lobe's parameters are called in the file: as the model has them, behind the lobe's name where there
/// are several.
std::string prefix(const MaterialSpec& m, std::size_t lobe) {
  if (m.lobes.size() == 1) return "";
  const std::string& name = model_info(m.lobes[lobe]).name;
  const auto same = std::count_if(m.lobes.begin(), m.lobes.end(),
                                  [&](const LobeSpec& other) { return is_model(other, name); });
  return same > 1 ? fmt::format("{}{}_", name, lobe + 1) : name + "_";
}

std::string write(const MaterialSpec& material, const std::string&, const std::vector<std::string>& remarks) {
  std::string parameters, functions, sum;
  std::set<std::string_view> written;
  const auto declare = [&](const std::string& name, double lo, double hi, double value) {
    parameters += fmt::format("float {} {} {} {}\n", name, digits(lo), digits(hi), digits(value));
  };
  for (std::size_t l = 0; l < material.lobes.size(); ++l) {
    const LobeSpec& lobe = material.lobes[l];
    const ModelInfo& model = model_info(lobe);
    append(functions, written, *shader(model_shaders(), model.name));
    std::string call = model.name + "(wo, wi";
    for (std::size_t i = 0; i < model.parameters.size(); ++i) {
      const ParameterInfo& p = model.parameters[i];
      const std::string name = prefix(material, l) + p.name;
      if (!p.per_channel) {
        declare(name, p.lo, p.hi, lobe.values[i][0]);
        call += ", " + name;
      } else if (p.lo >= 0 && p.hi <= 1) {
        parameters += fmt::format("color {} {}\n", name, digits(lobe.values[i], " "));
        call += ", " + name;
      } else { // beyond what a colour can be there
        for (std::size_t c = 0; c < 3; ++c)
          declare(fmt::format("{}_{}", name, "rgb"[c]), p.lo, p.hi, lobe.values[i][c]);
        call += fmt::format(", vec3({0}_r, {0}_g, {0}_b)", name);
      }
    }
    call += ")";
    if (lobe.weight != 1) {
      const std::string name = prefix(material, l) + "weight";
      declare(name, 0, std::max(1.0, lobe.weight), lobe.weight);
      call = name + " * " + call;
    }
    sum += (sum.empty() ? "" : " +\n         ") + call;
  }
  std::string text = "analytic\n";
  for (const std::string& remark : remarks)
    text += "# " + remark + "\n";
  return text + "\n::begin parameters\n" + parameters +
         "::end parameters\n\n::begin shader\n\nconst float PI = 3.14159265358979323846;\n" + functions +
         "\nvec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n"
         "  vec3 wi = vec3(dot(L, X), dot(L, Y), dot(L, N)), wo = vec3(dot(V, X), dot(V, Y), dot(V, N));\n"
         "  if (wi.z <= 0.0 || wo.z <= 0.0) return vec3(0.0);\n"
         "  return " +
         sum + ";\n}\n\n::end shader\n";
}

} // namespace

Target brdf_target() {
  return {".brdf",
          "Disney BRDF Explorer",
          {"ggx_schlick+lambert", "ggx_conductor+lambert", "disney_2012"},
          express,
          write,
          [](const auto&) { return std::vector<std::string>(); }};
}

} // namespace nacre
