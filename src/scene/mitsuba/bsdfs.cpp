// Materials: Mitsuba's BSDF plugins as lobes of Nacre's models under modifiers.

#include "bsdf/list.h"
#include "core/error.h"
#include "core/text_scanner.h"
#include "measured/measured_bsdf.h"
#include "scene/mitsuba/context.h"
#include "scene/scene_material.h"
#include "spectra/ior.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace nacre::mitsuba {
namespace {

const std::vector<std::string> known_bsdfs{
    "diffuse",      "conductor", "roughconductor", "dielectric", "roughdielectric",   "plastic",
    "roughplastic", "twosided",  "mask",           "normalmap",  "bumpmap",           "blendbsdf",
    "principled",   "merl",      "nacre",          "measured",   "measured_polarized"};

/// Mitsuba's plugins, and Nacre's models by their names.
std::vector<std::string> known_types() {
  std::vector<std::string> names = known_bsdfs;
  for (const ModelInfo& model : model_infos())
    names.push_back(model.name);
  return names;
}
const ModelInfo* listed_model(std::string_view type) {
  for (const ModelInfo& model : model_infos())
    if (model.name == type) return &model;
  return nullptr;
}

using Values = std::map<std::string, ParameterSource, std::less<>>;

/// A lobe with these parameters, the model's defaults for the others.
Lobe make_lobe(const Node& node, std::string_view model, Values values) {
  const ModelInfo& info = find_model(model);
  Lobe lobe;
  lobe.model = info.name;
  for (const ParameterInfo& parameter : info.parameters) {
    const auto given = values.find(parameter.name);
    if (given != values.end())
      lobe.parameters.push_back(given->second);
    else if (parameter.per_channel && parameter.initial >= 0)
      lobe.parameters.emplace_back(SpectrumSource::constant(static_cast<float>(parameter.initial)));
    else
      lobe.parameters.emplace_back(static_cast<float>(parameter.initial));
    const auto* scalar = std::get_if<float>(&lobe.parameters.back());
    if (scalar != nullptr && !(*scalar >= float(parameter.lo) && *scalar <= float(parameter.hi)))
      node.fail(fmt::format("'{}' of the model {} must lie in [{:g}, {:g}], found {:g}", parameter.name,
                            info.name, parameter.lo, parameter.hi, *scalar));
  }
  return lobe;
}

double ior(Parameters& p, std::string_view name, double initial) {
  const Node* node = p.find(name);
  if (node == nullptr) return initial;
  double value = 0;
  if (node->tag == "string") {
    const Attribute& substance = node->require("value");
    const auto found = find_dielectric(substance.value);
    if (!found)
      node->fail_at(substance, "no index of refraction is known for " + in_quotes(substance.value) +
                                   suggestion(substance.value, dielectric_names()));
    value = *found;
  } else if (node->tag == "float" || node->tag == "integer") {
    value = read_number(*node, node->require("value"));
  } else {
    node->fail("'" + std::string(name) + "' must be a number or the name of a substance, found <" +
               node->tag + ">");
  }
  if (!(value > 0)) node->fail("an index of refraction must be positive");
  return value;
}

constexpr double air = 1.000277, bk7 = 1.5046, polypropylene = 1.49; // Mitsuba 3's defaults

float relative_ior(Parameters& p, double inside) {
  inside = ior(p, "int_ior", inside);
  return static_cast<float>(inside / ior(p, "ext_ior", air));
}

/// eta and k, by the name of a metal or as spectra.
void conductor_ior(Context& context, Parameters& p, Values& values) {
  const bool by_values = p.has("eta") || p.has("k");
  const std::string material = p.text("material", by_values || !p.node().is_old ? "none" : "Cu");
  SpectrumSource eta, k;
  if (by_values) {
    if (material != "none") p.at("material").fail("'material' and 'eta', 'k' exclude each other");
    eta = context.spectrum(p, "eta", SpectrumUse::unbounded, 0);
    k = context.spectrum(p, "k", SpectrumUse::unbounded, 1);
  } else if (material == "none") { // reflects everything: F = ((0 - 1)^2 + 1) / ((0 + 1)^2 + 1) = 1
    p.ignore({"eta", "k"});
    eta = SpectrumSource::constant(0);
    k = SpectrumSource::constant(1);
  } else {
    const ConductorIor* metal = find_metal(material);
    if (metal == nullptr)
      p.at("material")
          .fail("no index of refraction is known for the metal " + in_quotes(material) +
                suggestion(material, metal_names()));
    eta = metal->eta;
    k = metal->k;
  }
  const double outside = ior(p, "ext_eta", 1); // Mitsuba 0.x
  values["eta"] = eta.scaled(static_cast<float>(1 / outside));
  values["k"] = k.scaled(static_cast<float>(1 / outside));
}

void color(Context& context, Parameters& p, Values& values, const std::string& name) {
  if (auto value = context.color(p, name, SpectrumUse::reflectance)) values[name] = std::move(*value);
}

/// A roughness as the models take it: positive, and a number too small for them raised to what they can do.
ParameterSource roughness(Context& context, Parameters& p, std::string_view name, ParameterSource initial,
                          std::string_view model) {
  ParameterSource value = context.number(p, name).value_or(std::move(initial));
  const auto* alpha = std::get_if<float>(&value);
  if (alpha == nullptr) return value;
  if (!(*alpha >= 0)) p.at(name).fail("'" + std::string(name) + "' must not be negative");
  for (const ParameterInfo& info : find_model(model).parameters)
    if ((info.name == "alpha" || info.name == "alpha_x") && *alpha < static_cast<float>(info.lo)) {
      context.warn(p.at(name), "'" + std::string(name) + "' is raised to " + std::to_string(info.lo) +
                                   ", the smallest this model takes; use the smooth plugin for a mirror");
      value = static_cast<float>(info.lo);
      break;
    }
  return value;
}

std::string rough_model(Parameters& p, const std::string& kind) {
  p.ignore({"sample_visible"});
  return p.choice("distribution", "beckmann", {"beckmann", "ggx"}) + "_" + kind;
}

/// alpha, or alpha_u and alpha_v.
void anisotropic_roughness(Context& context, Parameters& p, const std::string& model, Values& values) {
  if (p.has("alpha_u") || p.has("alpha_v")) {
    if (p.has("alpha")) p.at("alpha").fail("'alpha' and 'alpha_u', 'alpha_v' exclude each other");
    if (!p.has("alpha_u") || !p.has("alpha_v")) p.node().fail("'alpha_u' and 'alpha_v' belong together");
    values["alpha_x"] = roughness(context, p, "alpha_u", 0.1f, model);
    values["alpha_y"] = roughness(context, p, "alpha_v", 0.1f, model);
  } else {
    values["alpha_x"] = values["alpha_y"] = roughness(context, p, "alpha", 0.1f, model);
  }
  values["separable"] = 1.0f;
}

Lobe measurement(Parameters& p) {
  Lobe lobe;
  lobe.model = measured_lobe;
  const std::string file = p.file();
  // A .brdf file scatters by its defaults.
  lobe.measured = file.ends_with(".brdf") ? parse_material(file).lobes.front().measured : read_measured(file);
  return lobe;
}

/// Burley's model of 2015, under Mitsuba's names and with its defaults.
void principled(Context& context, Parameters& p, Values& values) {
  color(context, p, values, "base_color");
  for (const char* name : {"metallic", "roughness", "anisotropic", "sheen", "clearcoat", "spec_trans"})
    if (auto value = context.number(p, name)) values[name] = std::move(*value);
  values["specular_tint"] = context.number(p, "spec_tint").value_or(0.0f);
  values["sheen_tint"] = context.number(p, "sheen_tint").value_or(0.0f);
  values["clearcoat_gloss"] = context.number(p, "clearcoat_gloss").value_or(0.0f);
  if (p.has("eta") && p.has("specular")) p.at("specular").fail("'eta' and 'specular' exclude each other");
  if (p.has("eta")) {
    values["eta"] = static_cast<float>(p.number("eta", 1.5));
  } else { // 8 % of it is the reflectance at normal incidence
    const double specular = p.number("specular", 0.5);
    if (!(specular >= 0 && specular <= 1)) p.at("specular").fail("'specular' must lie in [0, 1]");
    values["eta"] = std::max(1.05f, static_cast<float>(2 / (1 - std::sqrt(0.08 * specular)) - 1));
  }
  p.ignore({"diffuse_reflectance_sampling_rate", "main_specular_sampling_rate", "clearcoat_sampling_rate"});
}

/// The parameters of a listed model, each under its declared name.
void declared_parameters(Context& context, Parameters& p, const ModelInfo& model, Values& values) {
  for (const ParameterInfo& parameter : model.parameters) {
    const SpectrumUse use = parameter.hi <= 1 ? SpectrumUse::reflectance : SpectrumUse::unbounded;
    // A spectrum is never negative: what may be is one number for all wavelengths.
    const bool is_color = parameter.per_channel && parameter.lo >= 0;
    auto value = is_color ? context.color(p, parameter.name, use) : context.number(p, parameter.name);
    if (value) values[parameter.name] = std::move(*value);
  }
}

/// `nacre`: a material as the command line takes it, in `material`, or from a file that a fit wrote.
Material whole_material(Parameters& p) {
  if (p.has("material") == p.has("filename"))
    p.node().fail(
        "bsdf 'nacre' needs either 'material', such as ggx_schlick:alpha=0.1+lambert, or 'filename'");
  if (p.has("filename")) {
    const std::string file = p.file();
    return located(p.at("filename"), [&] { return scene_material(parse_material(file)); });
  }
  const auto find = [&](const std::string& file) { return p.file_named_in("material", file); };
  return located(p.at("material"),
                 [&] { return scene_material(parse_material(p.text("material", ""), find)); });
}

std::optional<Lobe> leaf(Context& context, Parameters& p) {
  Values values;
  const std::string& type = p.type();
  std::string model;
  if (type == "diffuse") {
    model = "lambert";
    color(context, p, values, "reflectance");
  } else if (type == "conductor" || type == "roughconductor") {
    model = "smooth_conductor";
    if (type == "roughconductor") {
      model = rough_model(p, "conductor");
      anisotropic_roughness(context, p, model, values);
    }
    conductor_ior(context, p, values);
    color(context, p, values, "specular_reflectance");
  } else if (type == "dielectric" || type == "roughdielectric") {
    model = "smooth_dielectric";
    if (type == "roughdielectric") {
      model = rough_model(p, "dielectric");
      anisotropic_roughness(context, p, model, values);
    }
    values["eta"] = relative_ior(p, bk7);
    color(context, p, values, "specular_reflectance");
    color(context, p, values, "specular_transmittance");
  } else if (type == "plastic" || type == "roughplastic") {
    model = "smooth_plastic";
    if (type == "roughplastic") {
      model = rough_model(p, "plastic");
      values["alpha"] = roughness(context, p, "alpha", 0.1f, model);
      values["separable"] = 1.0f;
    }
    values["eta"] = relative_ior(p, polypropylene);
    values["nonlinear"] = p.boolean("nonlinear", false) ? 1.0f : 0.0f;
    color(context, p, values, "diffuse_reflectance");
    color(context, p, values, "specular_reflectance");
  } else if (type == "principled") {
    model = "disney_2015";
    principled(context, p, values);
  } else if (type == "merl" || type == "measured" || type == "measured_polarized") {
    return measurement(p);
  } else if (const ModelInfo* listed = listed_model(type)) {
    model = type;
    declared_parameters(context, p, *listed, values);
  } else {
    return std::nullopt;
  }
  return make_lobe(p.node(), model, std::move(values));
}

bool transmits(const Material& material) {
  return std::any_of(material.lobes.begin(), material.lobes.end(), [](const Lobe& lobe) {
    const ModelInfo* model = listed_model(lobe.model);
    return model != nullptr && model->laws.transmits;
  });
}

const Node& only_nested(Parameters& p) {
  const auto nested = p.objects("bsdf");
  if (nested.size() != 1)
    p.node().fail("bsdf '" + p.type() + "' takes one nested bsdf, found " + std::to_string(nested.size()));
  return *nested[0];
}

/// A number in [0, 1] or a texture.
ParameterSource share(Context& context, Parameters& p, std::string_view name, float initial) {
  ParameterSource value = context.number(p, name).value_or(initial);
  if (const auto* v = std::get_if<float>(&value); v != nullptr && !(*v >= 0 && *v <= 1))
    p.at(name).fail("'" + std::string(name) + "' must lie in [0, 1]");
  return value;
}

/// How the map that is about to be laid over the material changes it: Nacre's own parameter `method`.
void set_normal_mapping(Parameters& p, Material& material) {
  if (material.normal_map || material.bump_map)
    p.node().fail("a normal or bump map on another is not supported");
  if (p.choice("method", "turned_frame", {"turned_frame", "microfacet"}) == "turned_frame") return;
  if (transmits(material)) p.at("method").fail("'microfacet' cannot hold a bsdf that transmits light");
  material.normal_mapping = NormalMapping::microfacet;
}

} // namespace

Material Context::build_material(const Node& node) {
  const Opened opened(*this, node);
  Parameters p(node, document);
  Material material;
  if (auto lobe = leaf(*this, p)) {
    material.lobes.push_back(std::move(*lobe));
  } else if (p.type() == "nacre") {
    material = whole_material(p);
  } else if (p.type() == "twosided") {
    const auto nested = p.objects("bsdf");
    if (nested.size() == 2) node.fail("bsdf 'twosided' with another bsdf for the back is not supported");
    if (nested.size() != 1)
      node.fail("bsdf 'twosided' takes one nested bsdf, found " + std::to_string(nested.size()));
    material = build_material(*nested[0]);
    if (transmits(material)) node.fail("bsdf 'twosided' cannot hold a bsdf that transmits light");
    material.two_sided = true;
  } else if (p.type() == "mask") {
    const ParameterSource opacity = share(*this, p, "opacity", 0.5f);
    material = build_material(only_nested(p));
    if (material.opacity) node.fail("a mask within a mask is not supported");
    material.opacity = opacity;
  } else if (p.type() == "normalmap") {
    const Node* map = p.find("normalmap");
    if (map == nullptr) {
      const auto unnamed = p.objects("texture"); // Mitsuba 0.x
      map = unnamed.empty() ? nullptr : unnamed[0];
    }
    if (map == nullptr || map->tag != "texture") node.fail("bsdf 'normalmap' needs a texture 'normalmap'");
    material = build_material(only_nested(p));
    set_normal_mapping(p, material);
    material.normal_map = texture(*map, TextureUse::data);
    if (!std::holds_alternative<BitmapTexture>(material.normal_map->kind))
      map->fail("a normal map must be a bitmap");
    if (Parameters(*map, document).boolean("raw", false) == false)
      warn(*map, "this normal map is decoded as an sRGB picture; normals are usually stored with raw=true");
  } else if (p.type() == "bumpmap") {
    const auto maps = p.objects("texture");
    if (maps.size() != 1)
      node.fail("bsdf 'bumpmap' takes one texture of heights, found " + std::to_string(maps.size()));
    const double scale = p.number("scale", 1);
    material = build_material(only_nested(p));
    set_normal_mapping(p, material);
    material.bump_map = texture(*maps[0], TextureUse::data);
    material.bump_scale = static_cast<float>(scale);
    if (!std::holds_alternative<BitmapTexture>(material.bump_map->kind))
      maps[0]->fail("a bump map must be a bitmap: other textures have no slope");
  } else if (p.type() == "blendbsdf") {
    const ParameterSource weight = share(*this, p, "weight", 0.5f);
    if (!std::holds_alternative<float>(weight)) p.at("weight").fail("a texture as weight is not supported");
    const auto nested = p.objects("bsdf");
    if (nested.size() != 2)
      node.fail("bsdf 'blendbsdf' takes two nested bsdfs, found " + std::to_string(nested.size()));
    const float w = std::get<float>(weight);
    for (int i = 0; i < 2; ++i) {
      Material part = build_material(*nested[i]);
      if (part.two_sided || part.opacity || part.normal_map || part.bump_map)
        nested[i]->fail(
            "bsdf 'blendbsdf' cannot hold twosided, mask, normalmap or bumpmap; put it inside those");
      for (Lobe& part_lobe : part.lobes) {
        part_lobe.weight *= i == 0 ? 1 - w : w;
        material.lobes.push_back(std::move(part_lobe));
      }
    }
  } else {
    unknown_plugin(node, known_types());
  }
  p.finish();
  return material;
}

int Context::material(const Node& node) {
  const auto known = materials_.find(&node);
  if (known != materials_.end()) return known->second;
  Material material = build_material(node);
  material.id = node.get("id").empty() ? node.get("type") : node.get("id");
  scene.materials.push_back(std::move(material));
  return materials_[&node] = static_cast<int>(scene.materials.size()) - 1;
}

int Context::default_material() {
  if (default_material_ < 0) {
    Material material;
    material.id = "default";
    material.lobes.push_back(
        make_lobe(document.scene, "lambert", {{"reflectance", SpectrumSource::constant(0.5f)}}));
    scene.materials.push_back(std::move(material));
    default_material_ = static_cast<int>(scene.materials.size()) - 1;
  }
  return default_material_;
}

} // namespace nacre::mitsuba
