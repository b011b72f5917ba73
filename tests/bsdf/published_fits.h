#pragma once
// Published fits of measured materials, a Lambertian and one lobe each, with the values that another program
// computes for them.

#include "core/spectrum.h"
#include "core/vec.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace nacre::published_fits {

struct Row {
  double theta_i, theta_o, phi; ///< degrees
  std::array<double, 3> f;      ///< with the Lambertian
  Vec3d wo, wi;
};
struct Fit {
  std::string set, material;
  std::array<double, 3> diffuse_albedo;
  nlohmann::json lobe;
  std::vector<Row> rows;
  std::string text(const Row& row) const {
    std::ostringstream s;
    s << set << " " << material << " theta_i " << row.theta_i << " theta_o " << row.theta_o << " phi "
      << row.phi;
    return s.str();
  }
};

/// All fits of fits/`set`.json with their rows of reference/bbm_fits.csv; empty where the data is absent.
inline std::vector<Fit> read(const std::string& set) {
  const std::string data = std::string(NACRE_SOURCE_DIR) + "/../shared/data/";
  std::ifstream fits(data + "fits/" + set + ".json"), values(data + "reference/bbm_fits.csv");
  std::vector<Fit> result;
  if (!fits || !values) return result;
  std::map<std::string, std::vector<Row>> rows;
  for (std::string line; std::getline(values, line);) {
    if (line.compare(0, set.size() + 1, set + ",") != 0) continue;
    std::istringstream in(line.substr(set.size() + 1));
    std::string material, numbers;
    std::getline(in, material, ',');
    std::getline(in, numbers);
    std::replace(numbers.begin(), numbers.end(), ',', ' ');
    std::istringstream n(numbers);
    Row r{};
    if (!(n >> r.theta_i >> r.theta_o >> r.phi >> r.f[0] >> r.f[1] >> r.f[2])) continue;
    r.wo = spherical_direction(r.theta_o * pi / 180, 0.0);
    r.wi = spherical_direction(r.theta_i * pi / 180, r.phi * pi / 180);
    rows[material].push_back(r);
  }
  const auto materials = nlohmann::json::parse(fits)["materials"];
  for (const auto& [material, lobes] : materials.items())
    result.push_back(
        {set, material, lobes[0]["albedo"].get<std::array<double, 3>>(), lobes[1], rows[material]});
  return result;
}

/// The worst relative deviation of model plus Lambertian from the values of a fit's rows, and where.
struct Deviation {
  double worst = 0;
  int count = 0, beyond = 0; ///< values compared, and those that deviate by more than 1e-3
  std::string where = {};
  void add(double ours, double theirs, const std::string& text) {
    const double d = std::abs(ours - theirs) / std::abs(theirs);
    ++count;
    if (d > 1e-3) ++beyond;
    if (d > worst) worst = d, where = text + " " + std::to_string(ours) + " for " + std::to_string(theirs);
  }
};

/// @param make    model (R = double, C = 3) of a fit's lobe
/// @param counts  whether a row is to be compared
template <class Make, class Counts>
Deviation compare(const std::string& set, Make make, Counts counts) {
  Deviation all;
  for (const Fit& fit : read(set)) {
    const auto model = make(fit.lobe);
    for (const Row& row : fit.rows) {
      if (!counts(row)) continue;
      const auto f = model.eval(row.wo, row.wi);
      for (int c = 0; c < 3; ++c)
        all.add(f[c] + fit.diffuse_albedo[std::size_t(c)] * inv_pi, row.f[std::size_t(c)], fit.text(row));
    }
  }
  return all;
}
template <class Make>
Deviation compare(const std::string& set, Make make) {
  return compare(set, make, [](const Row&) { return true; });
}

inline Spectrum<double, 3> albedo(const nlohmann::json& lobe) {
  return Spectrum<double, 3>(lobe["albedo"].get<std::array<double, 3>>());
}

} // namespace nacre::published_fits
