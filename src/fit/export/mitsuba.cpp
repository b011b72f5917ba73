// Mitsuba 3 XML: plugins for the lobes, blendbsdf for sums.
// Source: Mitsuba 3 documentation, section BSDFs.

#include "fit/export/target.h"

#include <fmt/format.h>

namespace nacre {
namespace {

bool is_rough(const std::string& model) {
  return model.ends_with("_conductor") || model.ends_with("_dielectric") || model.ends_with("_plastic");
}

/// What a lobe's f is proportional to; nothing for those that cannot be scaled.
std::vector<std::string> scaled(const LobeSpec& lobe) {
  const std::string& model = model_info(lobe).name;
  if (model == "lambert") return {"reflectance"};
  if (model.ends_with("_conductor")) return {"specular_reflectance"};
  if (model.ends_with("_dielectric")) return {"specular_reflectance", "specular_transmittance"};
  return {};
}

std::optional<MaterialSpec> express(const MaterialSpec& material) {
  MaterialSpec m = material;
  for (LobeSpec& lobe : m.lobes) {
    if (!is_one_of(lobe, {"lambert", "smooth_conductor", "ggx_conductor", "beckmann_conductor",
                          "smooth_dielectric", "ggx_dielectric", "beckmann_dielectric", "thin_dielectric",
                          "smooth_plastic", "ggx_plastic", "beckmann_plastic", "disney_2015"}))
      return {};
    // Mitsuba masks and shadows by the product of both.
    if (model_info(lobe).has("separable")) set(lobe, "separable", 1);
  }
  if (m.lobes.size() == 1 && m.lobes[0].weight == 1) return m;
  return as_mixture(m, scaled);
}

std::string line(int depth, const std::string& text) {
  return std::string(std::size_t(2 * depth), ' ') + text + "\n";
}
std::string color_line(int depth, const LobeSpec& lobe, std::string_view from, std::string_view to) {
  return line(depth, fmt::format("<rgb name=\"{}\" value=\"{}\"/>", to, digits(color(lobe, from), ", ")));
}
std::string number_line(int depth, std::string_view name, double value) {
  return line(depth, fmt::format("<float name=\"{}\" value=\"{}\"/>", name, digits(value)));
}

std::string plugin(const LobeSpec& lobe, int depth, const std::string& attributes) {
  const std::string& model = model_info(lobe).name;
  const auto open = [&](std::string_view type) {
    return line(depth, fmt::format("<bsdf type=\"{}\"{}>", type, attributes));
  };
  const int inside = depth + 1;
  const bool smooth = model.starts_with("smooth_");
  const std::string kind = model.substr(model.find('_') + 1);
  std::string text;
  if (model == "lambert") {
    text = open("diffuse") + color_line(inside, lobe, "reflectance", "reflectance");
  } else if (model == "disney_2015") {
    text = open("principled") + color_line(inside, lobe, "base_color", "base_color");
    for (const char* name : {"metallic", "eta", "roughness", "anisotropic", "sheen", "sheen_tint",
                             "clearcoat", "clearcoat_gloss", "spec_trans"})
      text += number_line(inside, name, number(lobe, name));
    text += number_line(inside, "spec_tint", number(lobe, "specular_tint"));
  } else {
    text = open(model == "thin_dielectric" ? "thindielectric" : smooth ? kind : "rough" + kind);
    if (is_rough(model) && !smooth && model != "thin_dielectric") {
      text += line(inside, fmt::format("<string name=\"distribution\" value=\"{}\"/>",
                                       model.starts_with("ggx") ? "ggx" : "beckmann"));
      if (kind == "plastic") {
        text += number_line(inside, "alpha", number(lobe, "alpha"));
      } else {
        text += number_line(inside, "alpha_u", number(lobe, "alpha_x"));
        text += number_line(inside, "alpha_v", number(lobe, "alpha_y"));
      }
    }
    if (kind == "conductor") {
      text += color_line(inside, lobe, "eta", "eta") + color_line(inside, lobe, "k", "k");
    } else {
      text += number_line(inside, "int_ior", number(lobe, "eta")) + number_line(inside, "ext_ior", 1);
    }
    if (kind == "plastic") {
      text += color_line(inside, lobe, "diffuse_reflectance", "diffuse_reflectance");
      text += line(
          inside, fmt::format("<boolean name=\"nonlinear\" value=\"{}\"/>", number(lobe, "nonlinear") > 0.5));
    }
    text += color_line(inside, lobe, "specular_reflectance", "specular_reflectance");
    if (kind == "dielectric")
      text += color_line(inside, lobe, "specular_transmittance", "specular_transmittance");
  }
  return text + line(depth, "</bsdf>");
}

/// Lobes from `first` on, whose weights sum to `total`.
std::string blend(const MaterialSpec& m, std::size_t first, double total, int depth,
                  const std::string& attributes) {
  if (first + 1 == m.lobes.size()) return plugin(m.lobes[first], depth, attributes);
  const double rest = std::max(total - m.lobes[first].weight, 0.0);
  return line(depth, fmt::format("<bsdf type=\"blendbsdf\"{}>", attributes)) +
         number_line(depth + 1, "weight", rest / total) + plugin(m.lobes[first], depth + 1, "") +
         blend(m, first + 1, rest, depth + 1, "") + line(depth, "</bsdf>");
}

std::string write(const MaterialSpec& material, const std::string& name,
                  const std::vector<std::string>& remarks) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n" + xml_comment(remarks) + "<scene version=\"3.0.0\">\n";
  text += blend(material, 0, 1, 1, fmt::format(" id=\"{}\"", name));
  return text + "</scene>\n";
}

std::vector<std::string> remarks(const MaterialSpec& material) {
  std::vector<std::string> lines;
  if (is_model(material.lobes[0], "disney_2015"))
    lines.push_back("The error is that of Burley's model of 2015, on which the plugin principled is based.");
  return lines;
}

} // namespace

Target mitsuba_target() {
  return {".xml",
          "Mitsuba 3",
          {"ggx_plastic:separable=1", "beckmann_plastic:separable=1", "ggx_conductor:separable=1",
           "0.5*ggx_conductor:separable=1+0.5*lambert", "disney_2015"},
          express,
          write,
          remarks};
}

} // namespace nacre
