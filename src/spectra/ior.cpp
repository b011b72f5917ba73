#include "spectra/ior.h"

#include "spectra/data/conductor_ior.h"

#include <map>

namespace nacre {
namespace {

// A table is extended by its end values to the ends of the visible range: an index of 0 there would be no
// metal.
ConductorIor from_table(const data::ConductorIorTable& table) {
  std::vector<float> lambda_nm, eta, k;
  const auto append = [&](float lambda, const data::ConductorIorRow& row) {
    lambda_nm.push_back(lambda);
    eta.push_back(row.eta);
    k.push_back(row.k);
  };
  if (table.rows.front().lambda_nm > lambda_min_nm) append(lambda_min_nm, table.rows.front());
  for (const auto& row : table.rows)
    append(row.lambda_nm, row);
  if (table.rows.back().lambda_nm < lambda_max_nm) append(lambda_max_nm, table.rows.back());
  return {SpectrumSource::tabulated(lambda_nm, eta), SpectrumSource::tabulated(lambda_nm, k)};
}

const std::map<std::string, ConductorIor, std::less<>>& metals() {
  static const auto map = [] {
    std::map<std::string, ConductorIor, std::less<>> m;
    for (const auto& table : data::conductor_ior_tables())
      m.emplace(table.name, from_table(table));
    // F = ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2) is 1 at every angle for eta = 0: the ideal mirror.
    m.emplace("none", ConductorIor{SpectrumSource::constant(0), SpectrumSource::constant(1)});
    return m;
  }();
  return map;
}

// Gases at 0 degrees Celsius and 1 atm, liquids at 20 degrees. Haynes (ed.), CRC Handbook of Chemistry and
// Physics, for pure substances; data sheets for glasses and plastics (Schott N-BK7: 1.5168 at 587.6 nm; "bk7"
// keeps the 1.5046 that scene files of Mitsuba mean).
const std::map<std::string, double, std::less<>>& dielectrics() {
  static const std::map<std::string, double, std::less<>> map{
      {"vacuum", 1.0},
      {"helium", 1.000036},
      {"hydrogen", 1.000132},
      {"air", 1.000277},
      {"carbon dioxide", 1.00045},
      {"ice", 1.31},
      {"water ice", 1.31},
      {"water", 1.3330},
      {"acetone", 1.36},
      {"ethanol", 1.361},
      {"carbon tetrachloride", 1.461},
      {"glycerol", 1.4729},
      {"glycerin", 1.4729},
      {"benzene", 1.501},
      {"silicone oil", 1.52045},
      {"bromine", 1.661},
      {"fused quartz", 1.458},
      {"silica", 1.458},
      {"pyrex", 1.470},
      {"acrylic glass", 1.49},
      {"polypropylene", 1.49},
      {"bk7", 1.5046},
      {"n-bk7", 1.5168},
      {"sodium chloride", 1.544},
      {"amber", 1.55},
      {"pet", 1.5750},
      {"polycarbonate", 1.585},
      {"sapphire", 1.77},
      {"cubic zirconia", 2.15},
      {"diamond", 2.419},
  };
  return map;
}

template <class Map>
std::vector<std::string> names_of(const Map& map) {
  std::vector<std::string> names;
  for (const auto& entry : map)
    names.push_back(entry.first);
  return names;
}

} // namespace

const ConductorIor* find_metal(std::string_view name) {
  const auto found = metals().find(name);
  return found == metals().end() ? nullptr : &found->second;
}

const std::vector<std::string>& metal_names() {
  static const auto names = names_of(metals());
  return names;
}

std::optional<double> find_dielectric(std::string_view name) {
  const auto found = dielectrics().find(name);
  return found == dielectrics().end() ? std::nullopt : std::optional(found->second);
}

const std::vector<std::string>& dielectric_names() {
  static const auto names = names_of(dielectrics());
  return names;
}

} // namespace nacre
