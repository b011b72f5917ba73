// A glTF 2.0 file that holds one material, with the KHR extensions its parameters need.
// Source: glTF 2.0 specification, section 3.9, and the registry of Khronos's extensions.

#include "fit/export/target.h"
#include "optics/fresnel.h"

#include <nlohmann/json.hpp>

namespace nacre {
namespace {

LobeSpec surface() { return default_lobe(model_index("gltf")); }

/// Facets of alpha_x, alpha_y, or alpha: roughness is the root of the smaller, KHR_materials_anisotropy
/// widens the other, the tangent's or turned by a quarter.
void set_roughness(LobeSpec& to, const LobeSpec& from) {
  const bool both = model_info(from).has("alpha_x");
  if (!both && !model_info(from).has("alpha")) return set(to, "roughness", 0);
  const double y = number(from, both ? "alpha_y" : "alpha"), x = both ? number(from, "alpha_x") : y;
  const double narrow = std::min(x, y), wide = std::max(x, y);
  set(to, "roughness", std::sqrt(narrow));
  if (wide > narrow) set(to, "anisotropy", std::sqrt((wide - narrow) / (1 - narrow)));
  if (y > x) set(to, "anisotropy_rotation", pi / 2);
}

std::optional<MaterialSpec> express(const MaterialSpec& material) {
  if (material.lobes.size() != 1 || material.lobes[0].measured) return {};
  const LobeSpec& lobe = material.lobes[0];
  const std::string& model = model_info(lobe).name;
  LobeSpec out = surface();
  set(out, "metallic", 0);
  if (model == "lambert") {
    auto reflectance = color(lobe, "reflectance");
    for (double& x : reflectance)
      x *= lobe.weight;
    if (*std::max_element(reflectance.begin(), reflectance.end()) > 1) return {};
    set(out, "base_color", reflectance);
    set(out, "specular", 0);
    return MaterialSpec{material.name, {out}};
  }
  if (lobe.weight != 1) return {};
  if (model == "gltf") return material;
  if (model == "ggx_schlick") {
    set(out, "metallic", 1);
    set(out, "base_color", color(lobe, "f0"));
  } else if (model == "ggx_conductor" || model == "beckmann_conductor" || model == "smooth_conductor") {
    set(out, "metallic", 1);
    std::array<double, 3> f0;
    for (std::size_t c = 0; c < 3; ++c)
      f0[c] = fresnel_conductor(1.0, color(lobe, "eta")[c], color(lobe, "k")[c]) *
              color(lobe, "specular_reflectance")[c];
    set(out, "base_color", f0);
  } else if (model == "ggx_plastic" || model == "beckmann_plastic" || model == "smooth_plastic") {
    set(out, "base_color", color(lobe, "diffuse_reflectance"));
    set(out, "ior", number(lobe, "eta"));
  } else if (model == "ggx_dielectric" || model == "beckmann_dielectric" || model == "smooth_dielectric" ||
             model == "thin_dielectric") {
    if (!(number(lobe, "eta") >= 1 && number(lobe, "eta") <= 3)) return {};
    set(out, "transmission", 1);
    set(out, "base_color", color(lobe, "specular_transmittance"));
    set(out, "ior", number(lobe, "eta"));
  } else {
    return {};
  }
  set_roughness(out, lobe);
  return MaterialSpec{material.name, {out}};
}

std::string write(const MaterialSpec& material, const std::string& name,
                  const std::vector<std::string>& remarks) {
  const LobeSpec& m = material.lobes[0];
  const auto& base = color(m, "base_color");
  nlohmann::json extensions = nlohmann::json::object();
  const LobeSpec plain = surface();
  const auto given = [&](std::string_view parameter) {
    return color(m, parameter) != color(plain, parameter);
  };
  if (given("ior")) extensions["KHR_materials_ior"] = {{"ior", number(m, "ior")}};
  if (given("specular") || given("specular_color"))
    extensions["KHR_materials_specular"] = {{"specularFactor", number(m, "specular")},
                                            {"specularColorFactor", color(m, "specular_color")}};
  if (given("clearcoat"))
    extensions["KHR_materials_clearcoat"] = {{"clearcoatFactor", number(m, "clearcoat")},
                                             {"clearcoatRoughnessFactor", number(m, "clearcoat_roughness")}};
  if (given("sheen_color"))
    extensions["KHR_materials_sheen"] = {{"sheenColorFactor", color(m, "sheen_color")},
                                         {"sheenRoughnessFactor", number(m, "sheen_roughness")}};
  if (given("transmission"))
    extensions["KHR_materials_transmission"] = {{"transmissionFactor", number(m, "transmission")}};
  if (given("diffuse_transmission"))
    extensions["KHR_materials_diffuse_transmission"] = {
        {"diffuseTransmissionFactor", number(m, "diffuse_transmission")},
        {"diffuseTransmissionColorFactor", color(m, "diffuse_transmission_color")}};
  if (given("anisotropy"))
    extensions["KHR_materials_anisotropy"] = {{"anisotropyStrength", number(m, "anisotropy")},
                                              {"anisotropyRotation", number(m, "anisotropy_rotation")}};
  if (given("iridescence"))
    extensions["KHR_materials_iridescence"] = {
        {"iridescenceFactor", number(m, "iridescence")},
        {"iridescenceIor", number(m, "iridescence_ior")},
        {"iridescenceThicknessMaximum", number(m, "iridescence_thickness")}};
  nlohmann::json entry{{"name", name},
                       {"pbrMetallicRoughness",
                        {{"baseColorFactor", {base[0], base[1], base[2], 1}},
                         {"metallicFactor", number(m, "metallic")},
                         {"roughnessFactor", number(m, "roughness")}}},
                       {"extras", {{"remarks", remarks}}}};
  nlohmann::json file{{"asset", {{"version", "2.0"}, {"generator", "Nacre"}}}};
  if (!extensions.empty()) {
    for (const auto& [extension, value] : extensions.items())
      file["extensionsUsed"].push_back(extension);
    entry["extensions"] = extensions;
  }
  file["materials"] = {entry};
  return file.dump(2) + "\n";
}

std::vector<std::string> remarks(const MaterialSpec& material) {
  if (number(material.lobes[0], "transmission") > 0)
    return {"Without a volume a transmitting surface is thin in glTF; add KHR_materials_volume for a solid."};
  return {};
}

} // namespace

Target gltf_target() {
  return {".gltf", "glTF 2.0", {"gltf:metallic=0,roughness=0.5", "gltf:metallic=0,specular=0"},
          express, write,      remarks};
}

} // namespace nacre
