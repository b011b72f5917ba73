#include "explorer/materials.h"

#include "core/error.h"
#include "core/file.h"
#include "explorer/arguments.h"
#include "explorer/desk.h"
#include "explorer/protocol.h"
#include "measured/user_bsdf.h"

#include <algorithm>

namespace nacre {
namespace {

using nlohmann::json;

constexpr std::size_t most_kept = 48;

bool names_file(const std::string& text) {
  const auto ending = std::filesystem::path(text).extension();
  return ending == ".json" || ending == ".brdf" || is_measured_file(text);
}

/// The text form of a material cannot lead to a file by itself.
void check_text(const std::string& text) {
  if (text.starts_with('/') || text.starts_with('.'))
    throw Error::in_file(text,
                         "not a material: expected a model with its parameters, or a measurement, .json or "
                         ".brdf file below the folder that the explorer was started in");
}

std::array<double, 3> value_of(const json& value, const std::string& what) {
  if (value.is_number()) {
    const double x = value.get<double>();
    return {x, x, x};
  }
  if (value.is_boolean()) return value.get<bool>() ? std::array{1.0, 1.0, 1.0} : std::array{0.0, 0.0, 0.0};
  if (value.is_array() && value.size() == 3 &&
      std::all_of(value.begin(), value.end(), [](const json& x) { return x.is_number(); }))
    return value.get<std::array<double, 3>>();
  throw Error(what + ": expected a number or three");
}

/// A lobe like any other, so that what is done with models is done with it.
MaterialSpec user_material(std::shared_ptr<const UserModel> model, const json& values) {
  const ModelInfo& info = model->info();
  auto all = model->initial_values();
  if (!values.is_null()) {
    if (!values.is_object()) throw Error("'values' is an object of parameters");
    for (const auto& [name, value] : values.items())
      all[info.parameter_index(name)] = value_of(value, info.name + ": " + name);
  }
  const std::string name = std::filesystem::path(info.name).stem().string();
  return {name, {user_lobe(std::move(model), std::move(all))}};
}

} // namespace

template <class T, class F>
std::shared_ptr<const T> MaterialCache::kept(const std::string& key, F make) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.key == key; });
    if (found != kept_.end()) {
      std::rotate(found, found + 1, kept_.end());
      return std::static_pointer_cast<const T>(kept_.back().value);
    }
  }
  std::shared_ptr<const T> made = make();
  const std::lock_guard lock(mutex_);
  if (kept_.size() == most_kept) kept_.erase(kept_.begin());
  kept_.push_back({key, made});
  return made;
}

std::shared_ptr<const UserModel> MaterialCache::compile(const std::string& source, const std::string& name) {
  return kept<UserModel>("brdf\n" + name + "\n" + source, [&] { return UserModel::parse(source, name); });
}

std::shared_ptr<const MaterialSpec> MaterialCache::from_file(const std::string& name, const Folder& folder) {
  namespace fs = std::filesystem;
  const fs::path path = folder.existing(name);
  std::error_code error;
  const auto size = fs::file_size(path, error);
  const auto time = fs::last_write_time(path, error).time_since_epoch().count();
  const std::string key = fmt::format("file\n{}\n{}\n{}", path.string(), size, time);
  return kept<MaterialSpec>(key, [&] {
    if (path.extension() == ".brdf") {
      return std::make_shared<const MaterialSpec>(
          user_material(compile(read_brdf_text(path.string()), folder.name_of(path)), nullptr));
    }
    if (!names_file(path.string()))
      throw Error::in_file(name, "not a material: expected a measurement, a .json or a .brdf file");
    MaterialSpec material =
        parse_material(path.string(), [&](const std::string& named) { return folder.found(named); });
    if (material.name == path.string()) material.name = path.stem().string();
    return std::make_shared<const MaterialSpec>(std::move(material));
  });
}

std::shared_ptr<const MaterialSpec> MaterialCache::resolve(const json& material, const Folder& folder) {
  const Arguments a(material, "material.");
  if (a.has("text")) {
    const std::string text = a.text("text");
    if (names_file(text) && text.find('=') == std::string::npos) return from_file(text, folder);
    check_text(text);
    const auto parse = [&] {
      return std::make_shared<const MaterialSpec>(
          parse_material(text, [&](const std::string& named) { return folder.found(named); }));
    };
    // A file may change.
    return text.find(".brdf") == std::string::npos ? kept<MaterialSpec>("text\n" + text, parse) : parse();
  }
  if (a.has("file")) {
    const std::string name = a.text("file");
    if (!a.has("values")) return from_file(name, folder);
    const auto path = folder.existing(name);
    return std::make_shared<const MaterialSpec>(
        user_material(compile(read_brdf_text(path.string()), folder.name_of(path)), material["values"]));
  }
  if (a.has("brdf")) {
    const Arguments brdf = a.object("brdf");
    return std::make_shared<const MaterialSpec>(user_material(
        compile(brdf.long_text("source"), brdf.text("name")), a.has("values") ? material["values"] : json()));
  }
  if (a.has("lobes"))
    return std::make_shared<const MaterialSpec>(material_from_json(
        material, a.text("name", "material"), [&](const std::string& named) { return folder.found(named); }));
  throw Error("a material has 'text', 'file', 'brdf' or 'lobes'");
}

json declarations(const ModelInfo& model, const std::vector<std::array<double, 3>>* values) {
  json list = json::array();
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const ParameterInfo& p = model.parameters[i];
    json entry{
        {"name", p.name}, {"unit", p.unit},       {"meaning", p.meaning},      {"lo", p.lo},
        {"hi", p.hi},     {"initial", p.initial}, {"is_color", p.per_channel}, {"is_switch", !p.fitted}};
    if (values && p.per_channel) entry["value"] = (*values)[i];
    if (values && !p.per_channel) entry["value"] = (*values)[i][0];
    list.push_back(std::move(entry));
  }
  return list;
}

json resolved(const MaterialSpec& material) { return to_json(material); }

namespace {

/// Declarations of a user's file; colours begin with three numbers.
json user_declarations(const UserModel& model, const std::vector<std::array<double, 3>>& values) {
  json list = declarations(model.info(), &values);
  for (std::size_t i = 0; i < list.size(); ++i)
    if (list[i]["is_color"].get<bool>()) list[i]["initial"] = model.initial_values()[i];
  return list;
}

json laws_json(const Laws& laws) {
  return {{"reciprocal", laws.reciprocal},
          {"transmits", laws.transmits},
          {"thin", laws.thin},
          {"energy_gain", laws.energy_gain},
          {"stochastic", laws.stochastic}};
}

} // namespace

json model_json(const ModelInfo& model) {
  return {{"name", model.name},
          {"summary", model.summary},
          {"source", model.source},
          {"laws", laws_json(model.laws)},
          {"parameters", declarations(model)}};
}

Answer answer_material(const Arguments& request, const Desk& desk) {
  const auto material = desk.materials.resolve(request.at("material"), desk.folder);
  Answer answer;
  json& h = answer.header;
  h["name"] = material->name;
  h["kind"] = "model";
  h["lobes"] = json::array();
  bool isotropic = true;
  for (const LobeSpec& lobe : material->lobes) {
    if (!lobe.measured) {
      const ModelInfo& model = model_info(lobe);
      for (std::size_t i = 0; i < model.parameters.size(); ++i) {
        // A pair of numbers along tangent and bitangent that differ.
        const std::string& name = model.parameters[i].name;
        if (name.ends_with("_x") && model.has(name.substr(0, name.size() - 1) + "y"))
          isotropic &=
              lobe.values[i] == lobe.values[model.parameter_index(name.substr(0, name.size() - 1) + "y")];
        if (name.find("anisotrop") != std::string::npos) isotropic &= lobe.values[i][0] == 0;
      }
      h["lobes"].push_back({{"model", model.name},
                            {"weight", lobe.weight},
                            {"parameters", declarations(model, &lobe.values)}});
      continue;
    }
    isotropic &= lobe.measured->is_isotropic();
    if (lobe.user) {
      h["kind"] = "user";
      h["lobes"].push_back({{"model", lobe.user->info().name},
                            {"weight", lobe.weight},
                            {"parameters", user_declarations(*lobe.user, lobe.values)}});
      continue;
    }
    h["kind"] = "measured";
    h["lobes"].push_back(
        {{"model", lobe.measured->kind()}, {"weight", lobe.weight}, {"parameters", json::array()}});
    h["facts"] = {{"kind", lobe.measured->kind()}};
    for (const auto& [label, text] : lobe.measured->facts())
      h["facts"][label] = text;
    if (const auto* table = dynamic_cast<const MerlTable*>(lobe.measured.get()))
      h["holes"] = table->hole_count();
  }
  h["is_isotropic"] = isotropic;
  return answer;
}

Answer answer_compile(const Arguments& request, const Desk& desk) {
  const Arguments brdf = request.object("brdf");
  const std::string source = brdf.long_text("source"), name = brdf.text("name");
  Answer answer;
  try {
    const auto model = desk.materials.compile(source, name);
    // A loop without end shows only when it runs.
    UserBsdf(model, model->initial_values())
        .rgb(spherical_direction(0.5, 0.3), spherical_direction(0.7, 2.0));
    answer.header["parameters"] = user_declarations(*model, model->initial_values());
  } catch (const Error& e) {
    answer.header["errors"] = json::array();
    const std::string text = e.what();
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      const json error = json::parse(encode_error(0, text.substr(begin, end - begin)).bytes)["error"];
      answer.header["errors"].push_back({{"line", error.value("line", 0)},
                                         {"column", error.value("column", 0)},
                                         {"message", error["message"]}});
      begin = end + 1;
    }
  }
  return answer;
}

} // namespace nacre
