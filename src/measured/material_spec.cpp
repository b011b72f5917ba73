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
  const ModelInfo& model = model_info(lobe);
  const ParameterInfo& parameter = model.parameters[i];
  if (x.size() != 1 && !(x.size() == 3 && parameter.per_channel))
    throw Error(fmt::format("{}: expected {}, found {} numbers", what,
                            parameter.per_channel ? "one number or three (R/G/B)" : "one number", x.size()));
  for (std::size_t c = 0; c < 3; ++c) {
    lobe.values[i][c] = x[x.size() == 3 ? c : 0];
    check_domain(model, parameter, lobe.values[i][c]);
  }
  if (lobe.user && lobe.user->is_switch(i) && x[0] != 0 && x[0] != 1)
    throw Error(fmt::format("{}: a switch is 0 or 1, found {}", what, x[0]));
}

/// "metal=Au" sets eta and k, "glass=BK7" eta, and k to 0 where there is one: returns the places of what is
/// set.
std::vector<std::size_t> set_substance(LobeSpec& lobe, std::string_view kind, std::string_view name) {
  const ModelInfo& model = model_info(lobe);
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

constexpr std::string_view shader_ending = ".brdf";

/// Length of a lobe's name: up to the first ':' behind the ending of a file, which may hold one itself, or
/// up to the first of all.
std::size_t name_length(std::string_view lobe) {
  for (std::size_t at = lobe.find(shader_ending); at != std::string_view::npos;
       at = lobe.find(shader_ending, at + 1)) {
    const std::size_t end = at + shader_ending.size();
    if (end == lobe.size() || lobe[end] == ':') return end;
  }
  return std::min(lobe.find(':'), lobe.size());
}

bool names_shader(std::string_view lobe) {
  return lobe.substr(0, name_length(lobe)).ends_with(shader_ending);
}

/// Where nobody else looks for files: they lie where their name says.
std::string as_written(const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::exists(name, error)) return name;
  std::vector<std::string> near;
  const fs::path path(name), folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (at->path().extension() == path.extension()) near.push_back(at->path().filename().string());
  throw Error::in_file(name, "no such file" + suggestion(path.filename().string(), near));
}

LobeSpec shader_lobe(const std::string& name, const FileFinder& find) {
  const auto model = UserModel::parse(read_brdf_text(find ? find(name) : as_written(name)), name);
  return user_lobe(model, model->initial_values());
}

LobeSpec named_lobe(const std::string& name, const FileFinder& find) {
  return names_shader(name) ? shader_lobe(name, find) : default_lobe(model_index(name));
}

/// After its values have changed.
void set_measured(LobeSpec& lobe) {
  if (lobe.user) lobe.measured = std::make_shared<const UserBsdf>(lobe.user, lobe.values);
}

LobeSpec parse_lobe(std::string_view text, const FileFinder& find) {
  double weight = 1;
  if (const std::size_t star = text.find('*'); star != std::string_view::npos) {
    const std::string_view factor = text.substr(0, star);
    text.remove_prefix(star + 1);
    weight = parse_number(factor, fmt::format("weight of {}", text.substr(0, text.find(':'))));
  }
  const std::size_t colon = name_length(text);
  LobeSpec lobe = named_lobe(std::string(text.substr(0, colon)), find);
  lobe.weight = weight;
  check_weight(model_info(lobe).name, weight);
  if (colon == text.size()) return lobe;
  const ModelInfo& model = model_info(lobe);
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
  set_measured(lobe);
  return lobe;
}

void check_lobe_count(std::size_t count, std::string_view what) {
  if (count == 0 || count > std::size_t(Bsdf<float, 3>::max_lobes))
    throw Error(
        fmt::format("{}: a material has 1 to {} lobes, found {}", what, Bsdf<float, 3>::max_lobes, count));
}

MaterialSpec read_json_material(const std::string& path, const FileFinder& find) {
  const std::string text = read_text_file(find ? find(path) : path);
  try {
    return material_from_json(nlohmann::json::parse(text), path, find);
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
  const ModelInfo& model = model_info(lobe);
  for (std::size_t i = 0; i < model.parameters.size(); ++i)
    values.insert(values.end(), lobe.values[i].begin(),
                  lobe.values[i].begin() + (model.parameters[i].per_channel ? 3 : 1));
  return values;
}

LobeSpec user_lobe(std::shared_ptr<const UserModel> model, std::vector<std::array<double, 3>> values,
                   double weight) {
  LobeSpec lobe;
  lobe.user = std::move(model);
  lobe.values = std::move(values);
  lobe.weight = weight;
  set_measured(lobe);
  return lobe;
}

const ModelInfo& model_info(const LobeSpec& lobe) {
  return lobe.user ? lobe.user->info() : model_infos()[std::size_t(lobe.model)];
}

namespace {

MaterialSpec parse_any_material(const std::string& text, const FileFinder& find) {
  const std::filesystem::path path(text);
  if (path.extension() == ".json") return read_json_material(text, find);
  if (is_measured_file(text)) {
    LobeSpec lobe;
    lobe.measured = read_measured(find ? find(text) : text);
    return {path.stem().string(), {lobe}};
  }
  std::error_code too_long_for_a_name;
  const std::vector<std::string_view> lobes = split_lobes(text);
  const bool has_shader = std::any_of(lobes.begin(), lobes.end(), names_shader);
  if (has_shader && (lobes.size() == 1 || (path.extension() == shader_ending &&
                                           std::filesystem::exists(path, too_long_for_a_name))))
    return {text, {lobes.size() == 1 ? parse_lobe(text, find) : shader_lobe(text, find)}};
  if (std::filesystem::exists(path, too_long_for_a_name))
    throw Error::in_file(text, "not a material: expected a measurement such as .binary, or a .json file");
  if (!has_shader && text.find('/') != std::string::npos && text.find('=') == std::string::npos)
    throw Error::in_file(text, "no such file");
  MaterialSpec material{text, {}};
  for (const std::string_view lobe : lobes)
    material.lobes.push_back(parse_lobe(lobe, find));
  check_lobe_count(material.lobes.size(), text);
  return material;
}

} // namespace

MaterialSpec parse_material(const std::string& text, const FileFinder& find) {
  MaterialSpec material = parse_any_material(text, find);
  material.argument = text;
  return material;
}

MaterialSpec material_from_json(const nlohmann::json& json, const std::string& file, const FileFinder& find) {
  const auto beside = [&](const std::string& name) {
    const auto path = std::filesystem::path(file).parent_path() / name;
    std::error_code error;
    if (!names_shader(name) || path == name) return name;
    if (!find) return std::filesystem::exists(path, error) ? path.string() : name;
    try {
      find(path.string());
    } catch (const Error&) {
      return name;
    }
    return path.string();
  };
  try {
    MaterialSpec material{json.value("name", file), {}};
    for (const auto& entry : json.at("lobes")) {
      LobeSpec lobe = named_lobe(beside(entry.at("model").get<std::string>()), find);
      const ModelInfo& model = model_info(lobe);
      lobe.weight = entry.value("weight", 1.0);
      check_weight(model.name, lobe.weight);
      for (const auto& [name, value] : entry.at("parameters").items()) {
        const std::vector<double> x =
            value.is_array() ? value.get<std::vector<double>>() : std::vector<double>{value.get<double>()};
        set_value(lobe, model.parameter_index(name), x, model.name + ": " + name);
      }
      set_measured(lobe);
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
    if (lobe.is_table())
      throw Error(material.name + ": a measured table is not written as JSON; keep its file");
    const ModelInfo& model = model_info(lobe);
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
    if (lobe.is_table()) {
      text += material.name;
      continue;
    }
    const ModelInfo& model = model_info(lobe);
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
