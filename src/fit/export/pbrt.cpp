// Named materials of pbrt-v4, mix for sums. Source: pbrt-v4 User's Guide, input file format, section
// Materials; Pharr, Jakob and Humphreys 2023, sections 9.4 to 9.7 and 14.3.

#include "fit/export/target.h"
#include "spectra/spectrum_source.h"

#include <fmt/format.h>

namespace nacre {
namespace {

std::vector<std::string> scaled(const LobeSpec& lobe) {
  if (is_model(lobe, "lambert")) return {"reflectance"};
  return {};
}

std::optional<MaterialSpec> express(const MaterialSpec& material) {
  MaterialSpec m = material;
  for (LobeSpec& lobe : m.lobes) {
    if (!is_one_of(lobe, {"lambert", "smooth_conductor", "ggx_conductor", "smooth_dielectric",
                          "ggx_dielectric", "thin_dielectric", "smooth_plastic", "ggx_plastic"}))
      return {};
    // Heights of masking and shadowing are correlated, interfaces have no colour of their own, and light
    // takes on colour with each bounce below a coat.
    if (model_info(lobe).has("separable")) set(lobe, "separable", 0);
    if (model_info(lobe).has("nonlinear")) set(lobe, "nonlinear", 1);
    for (const char* factor : {"specular_reflectance", "specular_transmittance"})
      if (model_info(lobe).has(factor)) set(lobe, factor, 1);
  }
  if (m.lobes.size() == 1 && m.lobes[0].weight == 1) return m;
  return as_mixture(m, scaled);
}

/// The spectrum of an index that is given in RGB, as pairs of nm and value: the one Nacre renders with.
std::string index_spectrum(const std::array<double, 3>& rgb) {
  if (rgb[0] == rgb[1] && rgb[1] == rgb[2]) return fmt::format("360 {0} 830 {0}", digits(rgb[0]));
  const auto spectrum = SpectrumSource::rgb_unbounded(float(rgb[0]), float(rgb[1]), float(rgb[2]));
  std::string pairs;
  for (int nm = 360; nm <= 830; nm += 10)
    pairs += fmt::format("{}{} {:.6g}", pairs.empty() ? "" : " ", nm, spectrum.eval(float(nm)));
  return pairs;
}

std::string definition(const LobeSpec& lobe, const std::string& name) {
  const std::string& model = model_info(lobe).name;
  const bool smooth = model.starts_with("smooth_");
  const auto value = [](std::string_view type, std::string_view parameter, const std::string& text) {
    return fmt::format("  \"{} {}\" [ {} ]\n", type, parameter, text);
  };
  const auto roughness = [&] {
    return value("float", "uroughness", digits(smooth ? 0 : number(lobe, "alpha_x"))) +
           value("float", "vroughness", digits(smooth ? 0 : number(lobe, "alpha_y"))) +
           value("bool", "remaproughness", "false");
  };
  std::string type, text;
  if (model == "lambert") {
    type = "diffuse";
    text = value("rgb", "reflectance", digits(color(lobe, "reflectance"), " "));
  } else if (model.ends_with("conductor")) {
    type = "conductor";
    text = value("spectrum", "eta", index_spectrum(color(lobe, "eta"))) +
           value("spectrum", "k", index_spectrum(color(lobe, "k"))) + roughness();
  } else if (model.ends_with("plastic")) {
    type = "coateddiffuse";
    text = value("rgb", "reflectance", digits(color(lobe, "diffuse_reflectance"), " ")) +
           value("float", "eta", digits(number(lobe, "eta"))) +
           value("float", "roughness", digits(smooth ? 0 : number(lobe, "alpha"))) +
           value("bool", "remaproughness", "false") + value("float", "thickness", "0");
  } else {
    type = model == "thin_dielectric" ? "thindielectric" : "dielectric";
    text = value("float", "eta", digits(number(lobe, "eta")));
    if (type == "dielectric") text += roughness();
  }
  return fmt::format("MakeNamedMaterial \"{}\"\n  \"string type\" [ \"{}\" ]\n{}", name, type, text);
}

std::string write(const MaterialSpec& material, const std::string& name,
                  const std::vector<std::string>& remarks) {
  std::string text;
  for (const std::string& remark : remarks)
    text += "# " + remark + "\n";
  const std::size_t n = material.lobes.size();
  if (n == 1) return text + definition(material.lobes[0], name);
  for (std::size_t i = 0; i < n; ++i)
    text += definition(material.lobes[i], fmt::format("{}-lobe{}", name, i + 1));
  // From the last pair outwards: `amount` is the share of the second of two.
  std::string rest = fmt::format("{}-lobe{}", name, n);
  double below = material.lobes[n - 1].weight;
  for (std::size_t i = n - 1; i-- > 0;) {
    const double both = material.lobes[i].weight + below;
    const std::string mixed = i == 0 ? name : fmt::format("{}-mix{}", name, i + 1);
    text += fmt::format("MakeNamedMaterial \"{}\"\n  \"string type\" [ \"mix\" ]\n  \"string materials\" [ "
                        "\"{}-lobe{}\" \"{}\" ]\n  \"float amount\" [ {} ]\n",
                        mixed, name, i + 1, rest, digits(below / both));
    rest = mixed;
    below = both;
  }
  return text;
}

std::vector<std::string> remarks(const MaterialSpec& material) {
  std::vector<std::string> lines;
  for (const LobeSpec& lobe : material.lobes)
    if (model_info(lobe).name.ends_with("plastic")) {
      lines.push_back("pbrt walks at random between coat and base; the error is that of the analytic " +
                      model_info(lobe).name + ".");
      break;
    }
  return lines;
}

} // namespace

Target pbrt_target() {
  return {".pbrt", "pbrt-v4", {"ggx_plastic", "ggx_conductor", "0.5*ggx_conductor+0.5*lambert"},
          express, write,     remarks};
}

} // namespace nacre
