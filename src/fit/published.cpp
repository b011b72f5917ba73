#include "fit/published.h"

#include "core/error.h"
#include "core/file.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace nacre {
namespace {

using Json = nlohmann::json;
using Values = std::array<double, 3>;

/// One entry of a material with the place for messages.
class Entry {
public:
  Entry(const Json& json, std::string where) : json_(json), where_(std::move(where)) {
    if (!json_.is_object())
      throw Error(where_ + ": a lobe is an object, found " + std::string(json_.type_name()));
  }
  std::string text(const char* key) const {
    const Json& value = at(key);
    if (!value.is_string()) throw Error(fmt::format("{}: '{}' is a name", where_, key));
    return value.get<std::string>();
  }
  double number(const char* key) const { return finite(at(key), key); }
  Values three(const char* key) const { return three(at(key), key); }
  /// Row `i` of a list of three numbers each.
  Values row(const char* key, std::size_t i) const {
    const Json& value = at(key);
    if (!value.is_array() || value.size() <= i)
      throw Error(fmt::format("{}: '{}' has {} rows of three numbers", where_, key, i + 1));
    return three(value[i], key);
  }
  const std::string& where() const { return where_; }

private:
  const Json& at(const char* key) const {
    if (!json_.contains(key)) throw Error(fmt::format("{}: '{}' is missing", where_, key));
    return json_.at(key);
  }
  double finite(const Json& value, const char* key) const {
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      throw Error(fmt::format("{}: '{}' is a number, found {}", where_, key, value.dump()));
    return value.get<double>();
  }
  Values three(const Json& value, const char* key) const {
    if (!value.is_array() || value.size() != 3)
      throw Error(fmt::format("{}: '{}' is three numbers, found {}", where_, key, value.dump()));
    return {finite(value[0], key), finite(value[1], key), finite(value[2], key)};
  }
  const Json& json_;
  std::string where_;
};

class LobeMaker {
public:
  LobeMaker(std::string_view model, const Entry& entry)
      : lobe_(default_lobe(model_index(model))), model_(find_model(model)), entry_(entry) {}
  LobeMaker& set(std::string_view parameter, const Values& values) {
    const std::size_t p = model_.parameter_index(parameter);
    const ParameterInfo& info = model_.parameters[p];
    for (const double v : values)
      if (!(v >= info.lo && v <= info.hi))
        throw Error(fmt::format("{}: {}.{} lies in [{:g}, {:g}], found {:g}", entry_.where(), model_.name,
                                info.name, info.lo, info.hi, v));
    lobe_.values[p] = values;
    return *this;
  }
  LobeMaker& set(std::string_view parameter, double value) {
    return set(parameter, Values{value, value, value});
  }
  operator LobeSpec() const { return lobe_; }

private:
  LobeSpec lobe_;
  const ModelInfo& model_;
  const Entry& entry_;
};

struct Mapping {
  const char* name;
  Metric metric; ///< of the paper
  const char* model;
  ParameterRules rules;
  LobeSpec (*lobe)(const Entry&);
};

ParameterRules one_fresnel(const char* fresnel) {
  ParameterRules rules;
  rules.shared = {fresnel};
  rules.freed = {"specular_reflectance"};
  return rules;
}

const std::vector<Mapping>& mappings() {
  static const std::vector<Mapping> list = [] {
    ParameterRules lafortune; // only the ratio of the coefficients counts
    lafortune.shared = {"cz", "exponent"};
    lafortune.fixed = {{"cx", -1.0}, {"cy", -1.0}};
    ParameterRules he = one_fresnel("eta");
    he.fixed = {{"k", 0.0}};
    ParameterRules sgd;
    sgd.freed = {"lambda", "log_c", "k", "theta0"};
    return std::vector<Mapping>{
        {"NganWard",
         Metric::cosine,
         "ward",
         {},
         [](const Entry& e) -> LobeSpec {
           return LobeMaker("ward", e)
               .set("specular_reflectance", e.three("albedo"))
               .set("alpha_x", e.number("roughness"))
               .set("alpha_y", e.number("roughness"));
         }},
        {"NganWardDuer",
         Metric::cosine,
         "ward_duer",
         {},
         [](const Entry& e) -> LobeSpec {
           return LobeMaker("ward_duer", e)
               .set("specular_reflectance", e.three("albedo"))
               .set("alpha_x", e.number("roughness"))
               .set("alpha_y", e.number("roughness"));
         }},
        {"NganBlinnPhong",
         Metric::cosine,
         "blinn_phong",
         {},
         [](const Entry& e) -> LobeSpec {
           return LobeMaker("blinn_phong", e)
               .set("specular_reflectance", e.three("albedo"))
               .set("exponent", e.number("sharpness"));
         }},
        {"NganLafortune", Metric::cosine, "lafortune", lafortune,
         [](const Entry& e) -> LobeSpec {
           return LobeMaker("lafortune", e)
               .set("specular_reflectance", e.three("albedo"))
               .set("cx", e.number("Cxy"))
               .set("cy", e.number("Cxy"))
               .set("cz", e.number("Cz"))
               .set("exponent", e.number("sharpness"));
         }},
        // "eta" of the file is the reflectance at normal incidence.
        {"NganCookTorrance", Metric::cosine, "cook_torrance_schlick:divisor=3.14159265358979",
         one_fresnel("f0"),
         [](const Entry& e) -> LobeSpec {
           return LobeMaker("cook_torrance_schlick", e)
               .set("specular_reflectance", e.three("albedo"))
               .set("f0", e.number("eta"))
               .set("m", e.number("roughness"))
               .set("divisor", pi);
         }},
        {"NganAshikhminShirley", Metric::cosine, "ashikhmin_shirley", one_fresnel("f0"),
         [](const Entry& e) -> LobeSpec {
           return LobeMaker("ashikhmin_shirley", e)
               .set("specular_reflectance", e.three("albedo"))
               .set("f0", e.number("fresnelReflectance"))
               .set("n_u", e.number("sharpness"))
               .set("n_v", e.number("sharpness"));
         }},
        // The wavelengths are those that the fits are evaluated with elsewhere; a fitted factor and length
        // make up for others.
        {"NganHe", Metric::cosine, "he:wavelength=0.645/0.526/0.444", he,
         [](const Entry& e) -> LobeSpec {
           return LobeMaker("he", e)
               .set("specular_reflectance", e.three("albedo"))
               .set("eta", e.number("eta"))
               .set("k", 0)
               .set("sigma", e.number("roughness"))
               .set("tau", e.number("autocorrelation"))
               .set("wavelength", Values{0.645, 0.526, 0.444});
         }},
        // "fresnelReflectance" of the file is an index.
        {"LowAshikhminShirley", Metric::log, "ashikhmin_shirley_exact", one_fresnel("eta"),
         [](const Entry& e) -> LobeSpec {
           return LobeMaker("ashikhmin_shirley_exact", e)
               .set("specular_reflectance", e.three("albedo"))
               .set("eta", e.number("fresnelReflectance"))
               .set("n_u", e.number("sharpness"))
               .set("n_v", e.number("sharpness"));
         }},
        {"LowCookTorrance", Metric::log, "cook_torrance", one_fresnel("eta"),
         [](const Entry& e) -> LobeSpec {
           return LobeMaker("cook_torrance", e)
               .set("specular_reflectance", e.three("albedo"))
               .set("eta", e.number("eta"))
               .set("m", e.number("roughness"));
         }},
        {"LowMicrofacetFit",
         Metric::log,
         "low_microfacet",
         {},
         [](const Entry& e) -> LobeSpec {
           return LobeMaker("low_microfacet", e)
               .set("A", e.three("A"))
               .set("B", e.number("B"))
               .set("C", e.number("C"))
               .set("eta", e.number("eta"));
         }},
        {"LowSmooth",
         Metric::log,
         "low_smooth",
         {},
         [](const Entry& e) -> LobeSpec {
           return LobeMaker("low_smooth", e)
               .set("A", e.three("A"))
               .set("B", e.number("B"))
               .set("C", e.number("C"))
               .set("eta", e.number("eta"));
         }},
        {"Bagher", Metric::cube_root, "sgd:published_masking=1", sgd, [](const Entry& e) -> LobeSpec {
           const Values f0 = e.row("eta", 0), f1 = e.row("eta", 1), c = e.three("c");
           return LobeMaker("sgd", e)
               .set("specular", e.three("albedo"))
               .set("alpha", e.three("alpha"))
               .set("p", e.three("p"))
               .set("r0", {f0[0] - f1[0], f0[1] - f1[1], f0[2] - f1[2]})
               .set("f1", f1)
               .set("lambda", e.three("Lambda"))
               .set("log_c", {std::log(c[0]), std::log(c[1]), std::log(c[2])})
               .set("k", e.three("k"))
               .set("theta0", e.three("theta0"))
               .set("published_masking", 1);
         }}};
  }();
  return list;
}

PublishedFit read_fit(const std::string& material, const Json& lobes, const std::string& file,
                      const std::string& set) {
  const std::string where = file + ": " + material;
  if (!lobes.is_array() || lobes.empty() || lobes.size() > 4)
    throw Error(where + ": a material is a list of 1 to 4 lobes");
  PublishedFit fit{material, {}, {material, {}}, {}};
  fit.options.model.clear();
  std::string diffuse;
  for (const Json& json : lobes) {
    const Entry entry(json, where);
    const std::string model = entry.text("model");
    if (model == "Lambertian") {
      fit.published.lobes.push_back(LobeMaker("lambert", entry).set("reflectance", entry.three("albedo")));
      diffuse += "+lambert";
      continue;
    }
    std::vector<std::string> names{"Lambertian"};
    const Mapping* mapping = nullptr;
    for (const Mapping& m : mappings()) {
      names.push_back(m.name);
      if (model == m.name) mapping = &m;
    }
    if (!mapping)
      throw Error(fmt::format("{}: unknown model '{}'{}", where, model, suggestion(model, names)));
    fit.published.lobes.push_back(mapping->lobe(entry));
    fit.model += (fit.model.empty() ? "" : "+") + model;
    fit.options.model += (fit.options.model.empty() ? "" : "+") + std::string(mapping->model);
    fit.options.metric = mapping->metric;
    fit.options.rules = mapping->rules;
  }
  if (fit.options.model.empty())
    fit.options.model = diffuse.substr(1);
  else
    fit.options.model += diffuse;
  if (set.ends_with("E1")) fit.options.metric = Metric::cosine;
  if (set.ends_with("E2")) fit.options.metric = Metric::log;
  return fit;
}

} // namespace

const PublishedFit* PublishedSet::find(std::string_view material) const {
  for (const PublishedFit& fit : fits)
    if (fit.material == material) return &fit;
  return nullptr;
}

PublishedSet published_from_json(const Json& json, const std::string& file) {
  if (!json.is_object() || !json.contains("materials") || !json.at("materials").is_object())
    throw Error(file + ": published fits are an object with \"materials\"");
  PublishedSet set{std::filesystem::path(file).stem().string(), json.value("source", std::string()), {}};
  for (const auto& [material, lobes] : json.at("materials").items())
    set.fits.push_back(read_fit(material, lobes, file, set.name));
  return set;
}

PublishedSet read_published(const std::string& path) {
  const std::vector<std::uint8_t> bytes = read_file(path);
  Json json;
  try {
    json = Json::parse(bytes.begin(), bytes.end());
  } catch (const Json::parse_error& e) {
    throw Error(fmt::format("{}: byte {}: not JSON ({})", path, e.byte, e.what()));
  }
  return published_from_json(json, path);
}

PublishedComparison compare_with_published(const FitData& data, const PublishedSet& set,
                                           const PublishedFit& published, FitOptions options) {
  options.model = published.options.model;
  options.metric = published.options.metric;
  options.rules = published.options.rules;
  PublishedComparison c{published.material, set.name, published.model, options.metric, 0, 0, {}};
  c.published = metric_errors(data.measured(), published.published, options.max_theta_deg).of(options.metric);
  c.fit = fit(data, options);
  c.fitted = c.fit.errors.of(options.metric);
  return c;
}

} // namespace nacre
