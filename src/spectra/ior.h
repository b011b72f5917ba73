#pragma once
// Indices of refraction of named substances: facts from measurement, each with its source.

#include "spectra/data/dielectric_ior.h"
#include "spectra/spectrum_source.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

/// Complex index of refraction eta + i k of a metal.
struct ConductorIor {
  SpectrumSource eta, k;
  std::string source = {};
};

/// Index of refraction of a transparent substance by a published dispersion formula.
struct DielectricIor {
  std::string name, source;
  data::DispersionForm form;
  std::vector<double> coefficients;
  double lambda_min_nm, lambda_max_nm; ///< where the source fitted it; beyond, it is extrapolated

  /// @param lambda_nm  in [360, 830]
  double eval(double lambda_nm) const;
  /// Index at the helium d line, 587.5618 nm: the number by which glasses are sold.
  double n_d() const;
  /// Abbe number (n_d - 1) / (n_F - n_C): high where dispersion is low.
  double v_d() const;
};

/// The metal or absorbing solid of that chemical symbol or compound name ("Au", "TiN", "a-C"), "none" for the
/// ideal mirror, or null. Lives as long as the program.
const ConductorIor* find_metal(std::string_view name);
/// Names `find_metal` knows, sorted; to suggest a near one when a name is misspelt.
const std::vector<std::string>& metal_names();
/// The glass, crystal, liquid or plastic of that name ("BK7", "SF11", "water"; capitals do not matter), or
/// null. Lives as long as the program.
const DielectricIor* find_glass(std::string_view name);
/// Names `find_glass` knows, in lower case, sorted.
const std::vector<std::string>& glass_names();
/// Index of refraction at the sodium or helium d line (587.6 to 589.3 nm) of a transparent substance, if
/// known: what scene files mean by the name, else n_d of find_glass. "bk7" is 1.5046 here and 1.5168 there.
std::optional<double> find_dielectric(std::string_view name);
/// Names `find_dielectric` knows, sorted.
const std::vector<std::string>& dielectric_names();

} // namespace nacre
