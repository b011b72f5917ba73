#include "measured/material_spec.h"

#include "core/error.h"
#include "core/file.h"
#include "spectra/ior.h"
#include "spectra/named_ior.h"

#include <charconv>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

/// Cuts at each '+' but the sign of an exponent, as in 1.5e+06.
std::vector<std::string_view> split_lobes(std::string_view text) {
  const auto digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
  const auto exponent_sign = [&](std::size_t i) {
    return i >= 2 && (text[i - 1] == 'e' || text[i - 1] == 'E') && (digit(i - 2) || text[i - 2] == '.') &&
           digit(i + 1);
  };
  std::vector<std::string_view> parts;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '+' && !exponent_sign(i)) {
      parts.push_back(text.substr(begin, i - begin));
      begin = i + 1;
    }
  parts.push_back(text.substr(begin));
  return parts;
}

double parse_number(std::string_view text, std::string_view what) {
  double x = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(x))
    throw Error(fmt::format("{}: expected a number, found '{}'", what, text));
  return x;
}

void check_domain(const ModelInfo& model, const ParameterInfo& parameter, double x) {
  if (!(x >= parameter.lo && x <= parameter.hi))
    throw Error(fmt::format("{}: {} = {} lies outside its domain [{}, {}]", model.name, parameter.name, x,
                            parameter.lo, parameter.hi));
}

void set_value(LobeSpec& lobe, std::size_t i, const std::vector<double>& x, std::string_view what) {
  const ModelInfo& model = model_infos()[std::size_t(lobe.model)];
  const ParameterInfo& parameter = model.parameters[i];
  if (x.size() != 1 && !(x.size() == 3 && parameter.per_channel))
    throw Error(fmt::format("{}: expected {}, found {} numbers", what,
                            parameter.per_channel ? "one number or three (R/G/B)" : "one number", x.size()));
  for (std::size_t c = 0; c < 3; ++c) {
    lobe.values[i][c] = x[x.size() == 3 ? c : 0];
    check_domain(model, parameter, lobe.values[i][c]);
  }
}

/// "metal=Au" sets eta and k, "glass=BK7" eta, and k to 0 where there is one: returns the places of what is
/// set.
std::vector<std::size_t> set_substance(LobeSpec& lobe, std::string_view kind, std::string_view name) {
  const ModelInfo& model = model_infos()[std::size_t(lobe.model)];
  const std::string what = fmt::format("{}: {}", model.name, kind);
  if (!model.has("eta") || (kind == "metal" && !model.has("k")))
    throw Error(fmt::format("{} sets {}, which the model does not have", what,
                            kind == "metal" ? "eta and k" : "eta"));
  if (kind == "glass") {
    const std::size_t eta = model.parameter_index("eta");
    const auto index = glass_eta(name);
    if (!index)
      throw Error(fmt::format("{}: no substance '{}'{}", what, name, suggestion(name, glass_names())));
    set_value(lobe, eta, {*index}, what);
    if (!model.has("k")) return {eta};
    set_value(lobe, model.parameter_index("k"), {0}, what);
    return {eta, model.parameter_index("k")};
  }
  const std::size_t eta = model.parameter_index("eta"), k = model.parameter_index("k");
  if (!model.parameters[eta].per_channel) throw Error(what + ": the model has one eta for all colours");
  const auto index = metal_rgb(name);
  if (!index)
    throw Error(fmt::format("{}: no substance '{}'{}", what, name, suggestion(name, metal_names())));
  const auto clamped = [&](std::size_t i, const RGB& x) {
    const ParameterInfo& p = model.parameters[i];
    return std::vector{std::clamp(double(x[0]), p.lo, p.hi), std::clamp(double(x[1]), p.lo, p.hi),
                       std::clamp(double(x[2]), p.lo, p.hi)};
  };
  set_value(lobe, eta, clamped(eta, index->eta), what);
  set_value(lobe, k, clamped(k, index->k), what);
  return {eta, k};
}

void check_weight(const std::string& model, double weight) {
  if (!(weight >= 0 && weight <= 1e6))
    throw Error(fmt::format("{}: weight = {} lies outside its domain [0, 1e+06]", model, weight));
}

LobeSpec parse_lobe(std::string_view text) {
  double weight = 1;
  if (const std::size_t star = text.find('*'); star != std::string_view::npos) {
    const std::string_view factor = text.substr(0, star);
    text.remove_prefix(star + 1);
    weight = parse_number(factor, fmt::format("weight of {}", text.substr(0, text.find(':'))));
  }
  const std::size_t colon = text.find(':');
  LobeSpec lobe = default_lobe(model_index(text.substr(0, colon)));
  lobe.weight = weight;
  check_weight(model_infos()[std::size_t(lobe.model)].name, weight);
  if (colon == std::string_view::npos) return lobe;
  const ModelInfo& model = model_infos()[std::size_t(lobe.model)];
  std::vector<bool> given(model.parameters.size());
  for (const std::string_view assignment : split(text.substr(colon + 1), ',')) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string_view::npos)
      throw Error(fmt::format("{}: expected PARAM=VALUE, found '{}'", model.name, assignment));
    const std::string_view name = assignment.substr(0, equals);
    if ((name == "metal" || name == "glass") && !model.has(name)) {
      for (const std::size_t i : set_substance(lobe, name, assignment.substr(equals + 1))) {
        if (given[i]) throw Error(fmt::format("{}: {} is given twice", model.name, model.parameters[i].name));
        given[i] = true;
      }
      continue;
    }
    std::vector<std::size_t> places;
    if (name == "alpha" && !model.has(name) && model.has("alpha_x")) // both, for isotropic roughness
      places = {model.parameter_index("alpha_x"), model.parameter_index("alpha_y")};
    else
      places = {model.parameter_index(name)};
    const std::string what = fmt::format("{}: {}", model.name, name);
    std::vector<double> x;
    for (const std::string_view number : split(assignment.substr(equals + 1), '/'))
      x.push_back(parse_number(number, what));
    for (const std::size_t i : places) {
      if (given[i]) throw Error(fmt::format("{}: {} is given twice", model.name, model.parameters[i].name));
      given[i] = true;
      set_value(lobe, i, x, what);
    }
  }
  return lobe;
}

void check_lobe_count(std::size_t count, std::string_view what) {
  if (count == 0 || count > std::size_t(Bsdf<float, 3>::max_lobes))
    throw Error(
        fmt::format("{}: a material has 1 to {} lobes, found {}", what, Bsdf<float, 3>::max_lobes, count));
}

MaterialSpec read_json_material(const std::string& path) {
  const std::string text = read_text_file(path);
  try {
    return material_from_json(nlohmann::json::parse(text), path);
  } catch (const nlohmann::json::parse_error& e) {
    int line = 1, column = 1;
    for (std::size_t i = 0; i + 1 < e.byte && i < text.size(); ++i) {
      column = text[i] == '\n' ? 1 : column + 1;
      line += text[i] == '\n';
    }
    throw Error::in_text(path, line, column, "not valid JSON");
  }
}

} // namespace

LobeSpec default_lobe(int model) {
  // Dominant wavelengths of the primaries of sRGB (IEC 61966-2-1) under D65: what stands for a channel where
  // interference or diffraction asks for one.
  constexpr std::array<double, 3> primaries_nm{611.4, 549.1, 464.2};
  LobeSpec lobe;
  lobe.model = model;
  for (const ParameterInfo& p : model_infos()[std::size_t(model)].parameters) {
    lobe.values.push_back({p.initial, p.initial, p.initial});
    if (!p.is_wavelength()) continue;
    for (std::size_t c = 0; c < 3; ++c)
      lobe.values.back()[c] = primaries_nm[c] * p.wavelength_unit();
  }
  return lobe;
}

std::vector<double> parameter_vector(const LobeSpec& lobe) {
  std::vector<double> values;
  const ModelInfo& model = model_infos()[std::size_t(lobe.model)];
  for (std::size_t i = 0; i < model.parameters.size(); ++i)
    values.insert(values.end(), lobe.values[i].begin(),
                  lobe.values[i].begin() + (model.parameters[i].per_channel ? 3 : 1));
  return values;
}

MaterialSpec parse_material(const std::string& text) {
  const std::filesystem::path path(text);
  if (path.extension() == ".json") return read_json_material(text);
  if (is_measured_file(text)) {
    LobeSpec lobe;
    lobe.measured = read_measured(text);
    return {path.stem().string(), {lobe}};
  }
  std::error_code too_long_for_a_name;
  if (std::filesystem::exists(path, too_long_for_a_name))
    throw Error::in_file(text, "not a material: expected a measurement such as .binary, or a .json file");
  if (text.find('/') != std::string::npos && text.find('=') == std::string::npos)
    throw Error::in_file(text, "no such file");
  MaterialSpec material{text, {}};
  for (const std::string_view lobe : split_lobes(text))
    material.lobes.push_back(parse_lobe(lobe));
  check_lobe_count(material.lobes.size(), text);
  return material;
}

MaterialSpec material_from_json(const nlohmann::json& json, const std::string& file) {
  try {
    MaterialSpec material{json.value("name", file), {}};
    for (const auto& entry : json.at("lobes")) {
      LobeSpec lobe = default_lobe(model_index(entry.at("model").get<std::string>()));
      const ModelInfo& model = model_infos()[std::size_t(lobe.model)];
      lobe.weight = entry.value("weight", 1.0);
      check_weight(model.name, lobe.weight);
      for (const auto& [name, value] : entry.at("parameters").items()) {
        const std::vector<double> x =
            value.is_array() ? value.get<std::vector<double>>() : std::vector<double>{value.get<double>()};
        set_value(lobe, model.parameter_index(name), x, model.name + ": " + name);
      }
      material.lobes.push_back(std::move(lobe));
    }
    check_lobe_count(material.lobes.size(), file);
    return material;
  } catch (const nlohmann::json::exception&) {
    throw Error::in_file(file,
                         "not a material: expected \"lobes\": [{\"model\": NAME, \"parameters\": {NAME: "
                         "NUMBER or [R, G, B], ...}}, ...], as 'nacre fit -o' writes them");
  } catch (const Error& e) {
    throw Error::in_file(file, e.what());
  }
}

nlohmann::json to_json(const MaterialSpec& material) {
  nlohmann::json json{{"name", material.name}, {"lobes", nlohmann::json::array()}};
  for (const LobeSpec& lobe : material.lobes) {
    if (lobe.measured)
      throw Error(material.name + ": a measured table is not written as JSON; keep its file");
    const ModelInfo& model = model_infos()[std::size_t(lobe.model)];
    nlohmann::json parameters = nlohmann::json::object();
    for (std::size_t i = 0; i < model.parameters.size(); ++i) {
      if (model.parameters[i].per_channel)
        parameters[model.parameters[i].name] = lobe.values[i];
      else
        parameters[model.parameters[i].name] = lobe.values[i][0];
    }
    json["lobes"].push_back({{"model", model.name}, {"weight", lobe.weight}, {"parameters", parameters}});
  }
  return json;
}

std::string to_text(const MaterialSpec& material) {
  std::string text;
  for (const LobeSpec& lobe : material.lobes) {
    if (!text.empty()) text += '+';
    if (lobe.measured) {
      text += material.name;
      continue;
    }
    const ModelInfo& model = model_infos()[std::size_t(lobe.model)];
    if (lobe.weight != 1) text += fmt::format("{}*", lobe.weight);
    text += model.name;
    for (std::size_t i = 0; i < model.parameters.size(); ++i) {
      const auto& v = lobe.values[i];
      text += i == 0 ? ':' : ',';
      text += model.parameters[i].per_channel && (v[0] != v[1] || v[1] != v[2])
                  ? fmt::format("{}={}/{}/{}", model.parameters[i].name, v[0], v[1], v[2])
                  : fmt::format("{}={}", model.parameters[i].name, v[0]);
    }
  }
  return text;
}

} // namespace nacre
