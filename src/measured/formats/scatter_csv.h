#pragma once
// Nacre's plain list of samples, for data from instruments and programs that have no format of their own
// (.csv).
//
//   # nacre-bsdf 1; angles=degrees; channels=rgb; value=bsdf; symmetry=found
//   theta_i,phi_i,theta_o,phi_o,r,g,b
//   30,0,30,180,1.25,1.2,1.1
//
// The first line is the schema: the version, then settings in any order.
//   channels=grey | rgb | nm:400,410,...   required; linear sRGB; wavelengths in nm, increasing
//   angles=degrees | radians               degrees unless said
//   value=bsdf | cosine_bsdf               f in 1/sr, or f |cos theta_o|; bsdf unless said
//   symmetry=found | none | isotropic | bilateral   what ScatteredBsdf may assume; found unless said
// Then a line of column names in any order: theta_i, phi_i, theta_o, phi_o (phi_i may be missing: 0), and the
// values f, or r, g, b, or 400nm, 410nm, ... . Then a line a sample. Directions point away from the surface;
// theta up to 90 degrees lies in front of it, beyond behind. The specular direction is at phi_o = phi_i +
// 180. Fields are separated by commas; lines that begin with # are comments. The interpolation is
// ScatteredBsdf's.

#include "measured/measured_bsdf.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace nacre {

bool is_scatter_csv(std::span<const std::uint8_t> bytes);
/// @throws Error with line and column
std::shared_ptr<const MeasuredBsdf> parse_scatter_csv(std::span<const std::uint8_t> bytes,
                                                      std::string_view name);
/// All samples, angles in degrees.
std::vector<std::uint8_t> encode_scatter_csv(const MeasuredBsdf& measured);

} // namespace nacre
