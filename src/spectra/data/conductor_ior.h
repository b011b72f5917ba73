#pragma once
#include <span>
#include <string_view>

namespace nacre::data {

struct ConductorIorRow {
  float lambda_nm, eta, k;
};
struct ConductorIorTable {
  std::string_view name;
  std::span<const ConductorIorRow> rows; ///< wavelengths strictly increasing
  std::string_view source;
};

/// Measured complex indices of refraction over the visible range, sorted by name.
/// Each table names its source; Palik's as distributed with Mitsuba, the others as collected in the public
/// refractiveindex.info database. Visible part and one node on either side. Rows of AlAs without a measured
/// eta (394 to 435 nm) are left out.
std::span<const ConductorIorTable> conductor_ior_tables();

} // namespace nacre::data
