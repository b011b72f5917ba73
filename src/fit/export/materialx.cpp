// MaterialX: nodes of its library for physically based shading where they are the material's own lobes, else
// the node open_pbr_surface. Source: MaterialX Physically Based Shading Nodes 1.39; OpenPBR Surface 1.1.

#include "fit/export/target.h"

#include <fmt/format.h>

namespace nacre {
namespace {

std::optional<MaterialSpec> express(const MaterialSpec& material) {
  MaterialSpec m = material;
  if (m.lobes.size() == 1 && m.lobes[0].weight == 1 &&
      (is_model(m.lobes[0], "openpbr") || is_model(m.lobes[0], "openpbr_thin")))
    return m;
  for (LobeSpec& lobe : m.lobes) {
    if (lobe.weight > 1 || !is_one_of(lobe, {"lambert", "oren_nayar", "ggx_schlick", "ggx_conductor",
                                             "smooth_conductor", "ggx_dielectric", "smooth_dielectric"}))
      return {};
    const std::string& model = model_info(lobe).name;
    if (model == "oren_nayar" && number(lobe, "sigma") > 1) return {};
    if (model_info(lobe).has("separable")) set(lobe, "separable", 0);
    if (model.ends_with("dielectric")) // one tint for both
      set(lobe, "specular_transmittance", color(lobe, "specular_reflectance"));
  }
  return m;
}

std::string input(int depth, std::string_view name, std::string_view type, const std::string& value) {
  return fmt::format("{:{}}<input name=\"{}\" type=\"{}\" value=\"{}\" />\n", "", 2 * depth, name, type,
                     value);
}
std::string connection(int depth, std::string_view name, std::string_view type, const std::string& node) {
  return fmt::format("{:{}}<input name=\"{}\" type=\"{}\" nodename=\"{}\" />\n", "", 2 * depth, name, type,
                     node);
}

/// A node of one lobe, and where the lobe has a colour of its own a second that multiplies.
/// @return its text and the name of what it gives
std::pair<std::string, std::string> lobe_node(const LobeSpec& lobe, const std::string& name) {
  const std::string& model = model_info(lobe).name;
  const auto rgb = [&](std::string_view parameter) { return digits(color(lobe, parameter), ", "); };
  std::string kind, inputs = input(2, "weight", "float", digits(lobe.weight)), tint;
  if (model == "lambert" || model == "oren_nayar") {
    kind = "oren_nayar_diffuse_bsdf";
    inputs += input(2, "color", "color3", rgb("reflectance")) +
              input(2, "roughness", "float", digits(model == "lambert" ? 0 : number(lobe, "sigma")));
  } else {
    const bool both = model_info(lobe).has("alpha_x"), one = model_info(lobe).has("alpha");
    const double x = both ? number(lobe, "alpha_x") : one ? number(lobe, "alpha") : 0;
    const double y = both ? number(lobe, "alpha_y") : x;
    inputs += input(2, "roughness", "vector2", digits(x) + ", " + digits(y)) +
              input(2, "distribution", "string", "ggx");
    if (model == "ggx_schlick") {
      kind = "generalized_schlick_bsdf";
      inputs += input(2, "color0", "color3", rgb("f0")) + input(2, "color90", "color3", "1, 1, 1") +
                input(2, "exponent", "float", "5") + input(2, "scatter_mode", "string", "R");
    } else if (model.ends_with("conductor")) {
      kind = "conductor_bsdf";
      inputs += input(2, "ior", "color3", rgb("eta")) + input(2, "extinction", "color3", rgb("k"));
      if (color(lobe, "specular_reflectance") != std::array{1.0, 1.0, 1.0})
        tint = rgb("specular_reflectance");
    } else {
      kind = "dielectric_bsdf";
      inputs += input(2, "ior", "float", digits(number(lobe, "eta"))) +
                input(2, "tint", "color3", rgb("specular_reflectance")) +
                input(2, "scatter_mode", "string", "RT");
    }
  }
  std::string text = fmt::format("  <{0} name=\"{1}\" type=\"BSDF\">\n{2}  </{0}>\n", kind, name, inputs);
  if (tint.empty()) return {text, name};
  text += fmt::format("  <multiply name=\"{}_tinted\" type=\"BSDF\">\n{}{}  </multiply>\n", name,
                      connection(2, "in1", "BSDF", name), input(2, "in2", "color3", tint));
  return {text, name + "_tinted"};
}

std::string open_pbr(const LobeSpec& m, const std::string& name) {
  std::string text = fmt::format("  <open_pbr_surface name=\"{}\" type=\"surfaceshader\">\n", name);
  for (const ParameterInfo& p : model_info(m).parameters) {
    if (p.is_wavelength()) continue;
    text += p.per_channel
                ? input(2, p.name, "color3", digits(color(m, p.name), ", "))
                : input(2, p.name == "eta" ? "specular_ior" : p.name, "float", digits(number(m, p.name)));
  }
  if (model_info(m).laws.thin) text += input(2, "geometry_thin_walled", "boolean", "true");
  return text + "  </open_pbr_surface>\n";
}

std::string write(const MaterialSpec& material, const std::string& name,
                  const std::vector<std::string>& remarks) {
  std::string text = "<?xml version=\"1.0\"?>\n" + xml_comment(remarks) +
                     "<materialx version=\"1.39\" colorspace=\"lin_rec709\">\n";
  const std::string shader = name + "_surface";
  if (model_info(material.lobes[0]).name.starts_with("openpbr")) {
    text += open_pbr(material.lobes[0], shader);
  } else {
    std::string sum;
    for (std::size_t i = 0; i < material.lobes.size(); ++i) {
      const auto [node, result] = lobe_node(material.lobes[i], fmt::format("{}_lobe{}", name, i + 1));
      text += node;
      if (i == 0) {
        sum = result;
        continue;
      }
      const std::string next = fmt::format("{}_sum{}", name, i);
      text += fmt::format("  <add name=\"{}\" type=\"BSDF\">\n{}{}  </add>\n", next,
                          connection(2, "in1", "BSDF", sum), connection(2, "in2", "BSDF", result));
      sum = next;
    }
    text += fmt::format("  <surface name=\"{}\" type=\"surfaceshader\">\n{}  </surface>\n", shader,
                        connection(2, "bsdf", "BSDF", sum));
  }
  text += fmt::format("  <surfacematerial name=\"{}\" type=\"material\">\n{}  </surfacematerial>\n", name,
                      connection(2, "surfaceshader", "surfaceshader", shader));
  return text + "</materialx>\n";
}

std::vector<std::string> remarks(const MaterialSpec& material) {
  for (const LobeSpec& lobe : material.lobes)
    if (model_info(lobe).name.starts_with("ggx_"))
      return {"MaterialX leaves it to the renderer whether facets give back the light of multiple bounces; "
              "the error is that of single reflection."};
  return {};
}

} // namespace

Target materialx_target() {
  return {".mtlx", "MaterialX", {"ggx_schlick+lambert", "openpbr"}, express, write, remarks};
}

} // namespace nacre
