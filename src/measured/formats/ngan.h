#pragma once
// The four anisotropic materials of Ngan, Durand and Matusik 2005 (Experimental Analysis of BRDF Models:
// brushed aluminium, two satins, velvet), `.dat` files: a header of 16 little-endian int32, then float32.
//
// Header: counts of bins n[0..3] of theta_in, theta_out, phi_diff, phi_in; [6] = 1, these angles; [7] = 0,
// uniform bins; [9] = 1 where phi_diff covers only 0 to 180 degrees; [10] = 3 channels; the rest reserved.
// Then planes R, G, B, in each of which phi_in is fastest, then phi_diff, theta_out, theta_in. Bins cover
// theta 0 to 90 and the azimuths a turn; values belong to their middles, and hold in the half bins at the
// normal and the horizon. phi_diff is the azimuth of wo minus that of wi. Negative numbers are holes. The
// numbers are read as f as they stand; the files state no unit. With half the azimuths the other half is the
// mirror image of the sample: f(phi_in, phi_diff) = f(-phi_in, -phi_diff). Source of the layout: BRDF
// Explorer (Disney), BRDFMeasuredAniso, which quotes the data's own description.

#include "measured/measured_bsdf.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace nacre {

bool is_ngan(std::span<const std::uint8_t> bytes);
/// @throws Error with the byte offset
std::shared_ptr<const MeasuredBsdf> parse_ngan(std::span<const std::uint8_t> bytes, std::string_view name);

} // namespace nacre
