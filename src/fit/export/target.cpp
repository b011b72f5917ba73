#include "fit/export/target.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <numeric>

namespace nacre {

std::string models_of(const MaterialSpec& material) {
  std::string names;
  for (const LobeSpec& lobe : material.lobes)
    names += (names.empty() ? "" : "+") + (lobe.is_table() ? std::string("measured") : model_info(lobe).name);
  return names;
}

std::string digits(double x) { return fmt::format("{:.9g}", x); }
std::string digits(const std::array<double, 3>& rgb, std::string_view separator) {
  return fmt::format("{1:.9g}{0}{2:.9g}{0}{3:.9g}", separator, rgb[0], rgb[1], rgb[2]);
}

std::string xml_comment(const std::vector<std::string>& lines) {
  std::string text = "<!--\n";
  for (std::string line : lines) {
    for (std::size_t at; (at = line.find("--")) != std::string::npos;)
      line.replace(at, 2, "- ");
    text += "  " + line + "\n";
  }
  return text + "-->\n";
}

std::optional<MaterialSpec> as_mixture(const MaterialSpec& material,
                                       std::vector<std::string> (*scaled)(const LobeSpec&)) {
  MaterialSpec mixture = material;
  std::vector<double> least; // share that a lobe needs, its colours then being as bright as they may be
  double fixed = 0, scalable = 0;
  for (const LobeSpec& lobe : material.lobes) {
    double brightest = 0;
    const auto names = scaled(lobe);
    for (const std::string& name : names)
      for (const double x : color(lobe, name))
        brightest = std::max(brightest, x);
    least.push_back(lobe.weight * (names.empty() ? 1 : brightest));
    (names.empty() ? fixed : scalable) += least.back();
  }
  constexpr double rounding = 1e-9;
  if (fixed + scalable > 1 + rounding) return {};
  for (std::size_t i = 0; i < mixture.lobes.size(); ++i) {
    LobeSpec& lobe = mixture.lobes[i];
    const auto names = scaled(lobe);
    if (names.empty() || !(least[i] > 0)) continue;
    const double share = (1 - fixed) * least[i] / scalable;
    if (!(share > 0)) return {};
    for (const std::string& name : names) {
      auto value = color(lobe, name);
      for (double& x : value)
        x = std::min(x * lobe.weight / share, 1.0);
      set(lobe, name, value);
    }
    lobe.weight = share;
  }
  for (std::size_t i = mixture.lobes.size(); i-- > 0;) // black ones
    if (!(least[i] > 0)) mixture.lobes.erase(mixture.lobes.begin() + std::ptrdiff_t(i));
  const double sum = std::accumulate(mixture.lobes.begin(), mixture.lobes.end(), 0.0,
                                     [](double total, const LobeSpec& lobe) { return total + lobe.weight; });
  if (sum < 1 - rounding) {
    if (mixture.lobes.size() == std::size_t(Bsdf<float, 3>::max_lobes)) return {};
    LobeSpec black = default_lobe(model_index("lambert"));
    set(black, "reflectance", 0);
    black.weight = 1 - sum;
    mixture.lobes.push_back(black);
  }
  return mixture;
}

namespace {

std::optional<MaterialSpec> anything(const MaterialSpec& material) {
  for (const LobeSpec& lobe : material.lobes)
    if (lobe.measured) return {};
  return material;
}
std::string write_json(const MaterialSpec& material, const std::string&,
                       const std::vector<std::string>& remarks) {
  nlohmann::json json = to_json(material);
  json["remarks"] = remarks;
  return json.dump(2) + "\n";
}

} // namespace

Target json_target() {
  return {".json",  "Nacre material", {"ggx_schlick+lambert"},
          anything, write_json,       [](const auto&) { return std::vector<std::string>(); }};
}

} // namespace nacre
