#pragma once
#include <span>
#include <string_view>

namespace nacre::data {

/// How an index follows from wavelength x in micrometres and coefficients in published order.
enum class DispersionForm {
  sellmeier,       ///< A, B1, C1, ...: n^2 = 1 + A + sum of B x^2 / (x^2 - C), C in um^2
  sellmeier_poles, ///< the same with C in um, squared in the formula
  pole,            ///< A, B1, C1, ...: n^2 = A + sum of B / (x^2 - C)
  cauchy,          ///< A, B, C, ...: n = A + B / x^2 + C / x^4 + ...
  gas,             ///< B1, C1, ...: n = 1 + sum of B / (C - 1 / x^2), C in um^-2
};

struct DielectricIorRow {
  std::string_view names; ///< lower case, separated by commas, the first is the usual one
  DispersionForm form;
  std::span<const double> coefficients;
  double lambda_min_nm, lambda_max_nm; ///< where the source fitted it
  std::string_view source;
};

/// Dispersion formulas of transparent substances, at 20 to 27 degrees Celsius (air: 15), relative to air for
/// glasses and plastics, to vacuum for air and water. Coefficients as published, collected from the public
/// refractiveindex.info database; birefringent crystals have an entry per ray, -o and -e.
std::span<const DielectricIorRow> dielectric_ior_rows();

} // namespace nacre::data
