#include "spectra/ior.h"

#include "spectra/data/conductor_ior.h"

#include <algorithm>
#include <cmath>
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
  return {SpectrumSource::tabulated(lambda_nm, eta), SpectrumSource::tabulated(lambda_nm, k),
          std::string(table.source)};
}

const std::map<std::string, ConductorIor, std::less<>>& metals() {
  static const auto map = [] {
    std::map<std::string, ConductorIor, std::less<>> m;
    for (const auto& table : data::conductor_ior_tables())
      m.emplace(table.name, from_table(table));
    // F = ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2) is 1 at every angle for eta = 0: the ideal mirror.
    m.emplace("none", ConductorIor{SpectrumSource::constant(0), SpectrumSource::constant(1), "ideal mirror"});
    return m;
  }();
  return map;
}

// What scene files of Mitsuba mean by a name, and substances without a dispersion formula. A name that is in
// both tables keeps the scene files' number, a rounding of n_d but for bk7. Gases at 0 degrees Celsius and 1
// atm, liquids at 20 degrees: Haynes (ed.), CRC Handbook of Chemistry and Physics; plastics: data sheets.
const std::map<std::string, double, std::less<>>& scene_dielectrics() {
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
      {"pyrex", 1.470},
      {"acrylic glass", 1.49},
      {"polypropylene", 1.49},
      {"bk7", 1.5046},
      {"sodium chloride", 1.544},
      {"amber", 1.55},
      {"pet", 1.5750},
      {"cubic zirconia", 2.15},
      {"diamond", 2.419},
  };
  return map;
}

const std::map<std::string, DielectricIor, std::less<>>& glasses() {
  static const auto map = [] {
    std::map<std::string, DielectricIor, std::less<>> m;
    for (const auto& row : data::dielectric_ior_rows()) {
      const std::string name(row.names.substr(0, row.names.find(',')));
      const DielectricIor ior{name,
                              std::string(row.source),
                              row.form,
                              {row.coefficients.begin(), row.coefficients.end()},
                              row.lambda_min_nm,
                              row.lambda_max_nm};
      for (std::string_view rest = row.names; !rest.empty();) {
        const std::string_view alias = rest.substr(0, rest.find(','));
        m.emplace(alias, ior);
        rest.remove_prefix(std::min(rest.size(), alias.size() + 1));
      }
    }
    return m;
  }();
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

double DielectricIor::eval(double lambda_nm) const {
  const double x = lambda_nm * 1e-3, x2 = x * x;
  const auto& c = coefficients;
  const auto sum = [&](std::size_t first, auto term) {
    double y = 0;
    for (std::size_t i = first; i + 1 < c.size(); i += 2)
      y += term(c[i], c[i + 1]);
    return y;
  };
  switch (form) {
  case data::DispersionForm::sellmeier:
    return std::sqrt(1 + c[0] + sum(1, [&](double b, double pole) { return b * x2 / (x2 - pole); }));
  case data::DispersionForm::sellmeier_poles:
    return std::sqrt(1 + c[0] + sum(1, [&](double b, double pole) { return b * x2 / (x2 - pole * pole); }));
  case data::DispersionForm::pole:
    return std::sqrt(c[0] + sum(1, [&](double b, double pole) { return b / (x2 - pole); }));
  case data::DispersionForm::gas:
    return 1 + sum(0, [&](double b, double pole) { return b / (pole - 1 / x2); });
  case data::DispersionForm::cauchy:
    break;
  }
  double n = 0;
  for (std::size_t i = c.size(); i-- > 0;)
    n = n / x2 + c[i];
  return n;
}

// Spectral lines: ISO 7944.
double DielectricIor::n_d() const { return eval(587.5618); }
double DielectricIor::v_d() const { return (n_d() - 1) / (eval(486.1327) - eval(656.2725)); }

const DielectricIor* find_glass(std::string_view name) {
  std::string lower(name);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  const auto found = glasses().find(lower);
  return found == glasses().end() ? nullptr : &found->second;
}

const std::vector<std::string>& glass_names() {
  static const auto names = names_of(glasses());
  return names;
}

std::optional<double> find_dielectric(std::string_view name) {
  const auto found = scene_dielectrics().find(name);
  if (found != scene_dielectrics().end()) return found->second;
  const DielectricIor* glass = find_glass(name);
  return glass == nullptr ? std::nullopt : std::optional(glass->n_d());
}

const std::vector<std::string>& dielectric_names() {
  static const auto names = [] {
    std::vector<std::string> all = names_of(scene_dielectrics());
    all.insert(all.end(), glass_names().begin(), glass_names().end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }();
  return names;
}

} // namespace nacre
