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
};

/// Measured complex indices of refraction over the visible range, sorted by name.
/// Source: Palik (ed.) 1985 and 1991, Handbook of Optical Constants of Solids, as compiled in the public
/// luxpop.com database and distributed with Mitsuba; visible part and one node on either side.
/// Rows of AlAs without a measured eta (394 to 435 nm) are left out.
std::span<const ConductorIorTable> conductor_ior_tables();

} // namespace nacre::data
