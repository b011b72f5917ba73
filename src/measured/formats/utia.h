#pragma once
// The UTIA BRDF Database: 150 anisotropic materials (Filip and Vavra 2014, Template-Based Sampling of
// Anisotropic BRDFs, Computer Graphics Forum 33(7)), `.bin` files of 3 x 6 x 48 x 6 x 48 little-endian
// doubles.
//
// Colour planes R, G, B, one after the other; within a plane phi_v is fastest, then theta_v, phi_i, theta_i,
// with theta = 0, 15, ..., 75 and phi = 0, 7.5, ..., 352.5 degrees, each about the normal. The numbers are
// taken as linear RGB and as f, as ALTA (from the authors' own reader) and Sztrajman's reader take them.
// Negative numbers come from the database's own interpolation: they are read as 0 and counted in the facts.
//
// Both azimuths step alike, so that the table is turned, without resampling, to azimuths that are relative to
// the incidence's: interpolation does not smear highlights there (AngleGrid). The values at 75 degrees hold
// to the horizon. At theta_i = 0 all phi_i are one direction: each wo there gets the mean of what they say.

#include "measured/measured_bsdf.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace nacre {

/// True for exactly the size of such a file.
bool is_utia(std::span<const std::uint8_t> bytes);
/// @throws Error with the byte offset
std::shared_ptr<const MeasuredBsdf> parse_utia(std::span<const std::uint8_t> bytes, std::string_view name);

} // namespace nacre
