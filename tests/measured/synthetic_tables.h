#pragma once
// Tables for tests.

#include "measured/merl_table.h"
#include "measured/published_fits.h"

#include <map>
#include <string>

namespace nacre {

inline MerlTable diffuse_table(double value = 0.25) {
  return MerlTable::tabulate(12, 10, 16, [=](double, double, double) -> std::array<double, 3> {
    return {value, value, value};
  });
}

/// Smooth lobe about theta_h = 0 of the given width that grows with theta_d and depends on phi_d.
inline MerlTable glossy_table(double width = 0.3, int n = 90, int n_phi = 180) {
  return MerlTable::tabulate(n, n, n_phi, [=](double h, double d, double phi) -> std::array<double, 3> {
    const double f =
        0.05 + std::exp(-sqr(h / width)) * (0.2 + 0.5 * sqr(std::sin(d))) * (1 + 0.3 * std::cos(2 * phi));
    return {f, 0.5 * f, 0.2 * f};
  });
}

/// The published fits as tables, made once a process.
inline const MerlTable& published_table(const std::string& material) {
  static std::map<std::string, MerlTable> made;
  auto found = made.find(material);
  if (found == made.end()) found = made.emplace(material, demo_table(material)).first;
  return found->second;
}

} // namespace nacre
