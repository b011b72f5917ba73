#pragma once
// Which Fresnel term a classic facet model's paper or its published fits use, as a template argument: the
// parameter that describes the facets' material, and their reflectance.

#include "optics/fresnel.h"

#include <string_view>

namespace nacre {

/// Fresnel's equations for a dielectric; Cook and Torrance 1982, p. 11, write them with c and g.
template <class R>
struct ExactFacet {
  static constexpr bool is_exact = true;
  static constexpr std::string_view parameter = "eta",
                                    meaning = "index of the facets / outside, (1 + sqrt F0) / (1 - sqrt F0)";
  static constexpr double lo = 1, hi = 100, initial = 1.5; // 100: reflectance 0.96, metals
  static R reflectance(const R& cos_m, const R& eta) {
    return dielectric_amplitudes<R>(cos_m, R(1), eta).reflectance();
  }
};

/// Schlick's approximation from the reflectance at normal incidence.
template <class R>
struct SchlickFacet {
  static constexpr bool is_exact = false;
  static constexpr std::string_view parameter = "f0",
                                    meaning = "reflectance of the facets at normal incidence";
  static constexpr double lo = 0, hi = 1, initial = 0.04;
  static R reflectance(const R& cos_m, const R& f0) { return fresnel_schlick(cos_m, f0); }
};

} // namespace nacre
