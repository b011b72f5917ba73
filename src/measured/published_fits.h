#pragma once
// Published parameters of the hundred measured materials of the MERL database: real materials without the
// measurement files, whose licence does not let them travel with a program.
//
// Source: Loew, Kronander, Ynnerman, Unger 2012, BRDF Models for Accurate and Efficient Rendering of Glossy
// Surfaces, supplementary material: microfacet model, fits under their metric E2. The model: Lambert, plus
// Cook and Torrance's form with the ABC distribution S in place of D.

#include "measured/merl_table.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

struct PublishedFit {
  std::string_view material;     ///< as in the MERL database: "alum-bronze"
  std::array<double, 3> diffuse; ///< albedo, RGB
  std::array<double, 3> a;       ///< height of S, RGB, 1/sr
  double b, c;                   ///< S = a / (1 + b (1 - cos theta_h))^c
  double eta;                    ///< relative refractive index of the Fresnel factor
};

std::span<const PublishedFit> published_fits();
std::vector<std::string> published_materials();
/// @throws Error naming the nearest material
const PublishedFit& published_fit(std::string_view material);

/// RGB in 1/sr; 0 for directions below the horizon.
std::array<double, 3> evaluate(const PublishedFit& fit, const HalfDifference<double>& angles);

/// The fit as a table at the MERL database's resolution, holes below the horizon.
/// @throws Error naming the nearest material
MerlTable demo_table(std::string_view material);

} // namespace nacre
