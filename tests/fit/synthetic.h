#pragma once
// Small tables of known materials, with or without noise.

#include "core/random.h"
#include "fit/fit.h"
#include "measured/material_spec.h"

namespace nacre {

/// A normal number of mean 0 and variance 1, a function of its arguments alone (Box and Muller 1958).
inline double normal(std::uint64_t seed, std::uint64_t index) {
  const double u = 1 - unit_double(hash(seed, index, 0)), v = unit_double(hash(seed, index, 1));
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * pi * v);
}

/// The material at the nodes of a table, holes below the horizon, each value times 1 + noise * normal.
inline MerlTable tabulate(const std::string& material, double noise = 0, std::uint64_t seed = 0,
                          std::array<int, 3> size = {30, 30, 60}) {
  const MaterialSpec spec = parse_material(material); // a file's lobe lives in it
  const auto bsdf = make_bsdf<double>(spec);
  return MerlTable::tabulate(size[0], size[1], size[2], [&](double theta_h, double theta_d, double phi_d) {
    const auto [wo, wi] = directions(HalfDifference<double>{theta_h, theta_d, phi_d});
    if (!(wo.z > 0 && wi.z > 0)) return std::array{-1.0, -1.0, -1.0};
    const auto f = bsdf.eval(wo, wi);
    std::array<double, 3> rgb;
    const std::uint64_t node =
        hash(seed, std::int64_t(theta_h * 1e6), std::int64_t(theta_d * 1e6), std::int64_t(phi_d * 1e6));
    for (std::size_t c = 0; c < 3; ++c)
      rgb[c] = f[int(c)] * std::max(0.0, 1 + noise * normal(node, c));
    return rgb;
  });
}

/// What a material has for a parameter of a fit.
inline double value_in(const MaterialSpec& material, const FittedParameter& p) {
  const LobeSpec& lobe = material.lobes[std::size_t(p.lobe)];
  return lobe.values[model_info(lobe).parameter_index(p.name)][std::size_t(std::max(p.channel, 0))];
}

} // namespace nacre
