#include "fit/layout.h"

#include "core/error.h"

#include <cctype>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace nacre {
namespace {

/// The fitted parameter named like `parameter` with its final x as y, or u as v; -1 if there is none.
int partner(const ModelInfo& model, std::size_t parameter, const std::vector<bool>& varies) {
  std::string name = model.parameters[parameter].name;
  const int last = std::tolower(static_cast<unsigned char>(name.back()));
  if (last != 'x' && last != 'u') return -1;
  ++name.back();
  for (std::size_t i = 0; i < model.parameters.size(); ++i)
    if (varies[i] && model.parameters[i].name == name &&
        model.parameters[i].per_channel == model.parameters[parameter].per_channel)
      return int(i);
  return -1;
}

/// A parameter that is 0 for a surface that looks the same when turned: Disney's, glTF's and OpenPBR's. (The
/// anisotropy of a phase function is none.)
bool is_anisotropy(const std::string& name) {
  return name == "anisotropic" || name == "anisotropy" || name.ends_with("roughness_anisotropy");
}

/// Rules by name, which know whether each of them has met its parameter.
class Names {
public:
  explicit Names(const MaterialSpec& material) : material_(material) {}

  bool match(const std::string& rule, int lobe, int parameter) {
    const std::string& name =
        model_info(material_.lobes[std::size_t(lobe)]).parameters[std::size_t(parameter)].name;
    return rule == name || rule == lobe_label(material_, lobe) + "." + name;
  }
  /// @throws Error if `rule` is the name of no parameter
  void check(const std::string& rule) {
    std::vector<std::string> known;
    for (std::size_t l = 0; l < material_.lobes.size(); ++l)
      for (const ParameterInfo& p : model_info(material_.lobes[l]).parameters) {
        known.push_back(p.name);
        known.push_back(lobe_label(material_, int(l)) + "." + p.name);
      }
    if (std::find(known.begin(), known.end(), rule) == known.end())
      throw Error(fmt::format("{} has no parameter '{}'{}", material_.name, rule, suggestion(rule, known)));
  }

private:
  const MaterialSpec& material_;
};

} // namespace

bool same_model(const LobeSpec& a, const LobeSpec& b) {
  if (a.is_table() || b.is_table() || a.model != b.model) return false;
  return model_info(a).name == model_info(b).name;
}

std::string lobe_label(const MaterialSpec& material, int lobe) {
  const LobeSpec& one = material.lobes[std::size_t(lobe)];
  int same = 0; // lobes of this model: numbered where there are several
  for (const LobeSpec& l : material.lobes)
    same += same_model(l, one);
  const std::string& name = model_info(one).name;
  return (one.user ? std::filesystem::path(name).filename().string() : name) +
         (same > 1 ? fmt::format("#{}", lobe + 1) : "");
}

double FreeParameter::coordinate(double value) const { return logarithmic ? std::log(value) : value; }
double FreeParameter::value(double coordinate) const {
  return std::clamp(logarithmic ? std::exp(coordinate) : coordinate, lo, hi);
}
double FreeParameter::slope(double coordinate) const { return logarithmic ? std::exp(coordinate) : 1; }

ParameterLayout::ParameterLayout(MaterialSpec start, const ParameterRules& rules) : start_(std::move(start)) {
  for (const LobeSpec& lobe : start_.lobes)
    if (lobe.is_table())
      throw Error(fmt::format("{}: a measured table has no parameters to fit", start_.name));
  Names names(start_);
  for (const auto* list : {&rules.shared, &rules.freed})
    for (const std::string& rule : *list)
      names.check(rule);
  for (const auto& rule : rules.fixed)
    names.check(rule.name);
  for (const auto& rule : rules.bounds)
    names.check(rule.name);
  const auto any_matches = [&](const std::vector<std::string>& list, std::size_t lobe, std::size_t p) {
    return std::any_of(list.begin(), list.end(),
                       [&](const auto& rule) { return names.match(rule, int(lobe), int(p)); });
  };

  for (std::size_t lobe = 0; lobe < start_.lobes.size(); ++lobe) {
    LobeSpec& spec = start_.lobes[lobe];
    const ModelInfo& model = model_info(spec);
    std::vector<bool> varies;
    for (std::size_t p = 0; p < model.parameters.size(); ++p) {
      const ParameterInfo& info = model.parameters[p];
      const bool freed = any_matches(rules.freed, lobe, p);
      if (freed && spec.user && spec.user->is_switch(p))
        throw Error(fmt::format("{}.{} is a switch, on or off, and cannot be fitted", model.name, info.name));
      varies.push_back((info.fitted && !(rules.isotropic && is_anisotropy(info.name))) || freed);
      for (const auto& rule : rules.fixed) {
        if (!names.match(rule.name, int(lobe), int(p))) continue;
        if (freed || std::any_of(rules.bounds.begin(), rules.bounds.end(), [&](const auto& bound) {
              return names.match(bound.name, int(lobe), int(p));
            }))
          throw Error(
              fmt::format("{}.{} is to be fixed and {}", model.name, info.name, freed ? "freed" : "bounded"));
        varies.back() = false;
        if (!rule.value) continue;
        if (!(*rule.value >= info.lo && *rule.value <= info.hi))
          throw Error(fmt::format("{}.{} lies in [{:g}, {:g}], found {:g}", model.name, info.name, info.lo,
                                  info.hi, *rule.value));
        spec.values[p].fill(*rule.value);
      }
    }
    auto& index = index_.emplace_back(model.parameters.size(), std::array{-1, -1, -1});
    for (std::size_t p = 0; p < model.parameters.size(); ++p) {
      const ParameterInfo& info = model.parameters[p];
      if (!varies[p] || index[p][0] >= 0) continue;
      double lo = info.lo, hi = info.hi;
      for (const auto& rule : rules.bounds) {
        if (!names.match(rule.name, int(lobe), int(p))) continue;
        if (!(rule.lo >= info.lo && rule.hi <= info.hi && rule.lo < rule.hi))
          throw Error(
              fmt::format("bounds of {}.{} are two ascending numbers in [{:g}, {:g}], found {:g}:{:g}",
                          model.name, info.name, info.lo, info.hi, rule.lo, rule.hi));
        lo = rule.lo;
        hi = rule.hi;
      }
      const int tied = rules.isotropic ? partner(model, p, varies) : -1;
      const bool each = info.per_channel && !any_matches(rules.shared, lobe, p);
      for (int channel = 0; channel < 3; ++channel) {
        if (channel == 0 || each)
          free_.push_back({int(lobe), int(p), each ? channel : -1, lo, hi, lo > 0 && hi >= 100 * lo, tied});
        index[p][std::size_t(channel)] = size() - 1;
      }
      if (tied >= 0) index[std::size_t(tied)] = index[p];
    }
  }
  if (free_.empty()) throw Error(fmt::format("{}: no parameter is left to fit", start_.name));
  start_ = material(coordinates(start_));
}

int ParameterLayout::index(int lobe, int parameter, int channel) const {
  return index_[std::size_t(lobe)][std::size_t(parameter)][std::size_t(channel)];
}

std::string ParameterLayout::label(int i) const {
  const FreeParameter& p = (*this)[i];
  const std::string label =
      lobe_label(start_, p.lobe) + "." +
      model_info(start_.lobes[std::size_t(p.lobe)]).parameters[std::size_t(p.parameter)].name;
  return p.channel < 0 ? label : label + "." + "rgb"[p.channel];
}

std::vector<double> ParameterLayout::coordinates(const MaterialSpec& material) const {
  std::vector<double> x;
  for (const FreeParameter& p : free_) {
    const auto& values = material.lobes[std::size_t(p.lobe)].values[std::size_t(p.parameter)];
    // One number for three takes the mean of theirs.
    const double value =
        p.channel < 0 ? (values[0] + values[1] + values[2]) / 3 : values[std::size_t(p.channel)];
    x.push_back(p.coordinate(std::clamp(value, p.lo, p.hi)));
  }
  return x;
}

MaterialSpec ParameterLayout::material(std::span<const double> coordinates) const {
  MaterialSpec material = start_;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const FreeParameter& p = free_[i];
    auto& values = material.lobes[std::size_t(p.lobe)].values;
    const double value = p.value(coordinates[i]);
    for (int channel = 0; channel < 3; ++channel)
      if (p.channel < 0 || p.channel == channel) {
        values[std::size_t(p.parameter)][std::size_t(channel)] = value;
        if (p.tied >= 0) values[std::size_t(p.tied)][std::size_t(channel)] = value;
      }
  }
  for (LobeSpec& lobe : material.lobes)
    if (lobe.user) lobe = user_lobe(lobe.user, std::move(lobe.values), lobe.weight);
  return material;
}

} // namespace nacre
