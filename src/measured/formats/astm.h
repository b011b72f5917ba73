#pragma once
// ASTM E1392 / E2387 text files (.astm), as goniophotometers and BSDFProcessor exchange them.
//
// Lines "KEYWORD text" up to one "VARS name,name,...", then a line of numbers a sample, separated by commas
// or blanks. Angles of VARS: theta_i, phi_i, theta_s, phi_s (also with _r or _o for the scattered direction),
// in any order; both directions away from the surface, so that the specular direction is at phi_s = phi_i +
// 180, and theta_s > 90 is transmission. A negative theta lies at the opposite azimuth. Without phi_i light
// comes from 180 degrees, without phi_s the scan is in the plane of incidence with theta_s > 0 on the
// specular side. Values: one column of any name (BSDF, BRDF, BTDF: f in 1/sr; the name with "cos" in front: f
// cos theta_s, divided here), or R,G,B; X,Y,Z (CIE, read as linear sRGB); or names with a wavelength,
// "550nm". Columns beyond the values are named in the facts.
//
// The standards mean degrees; files exist in radians (Cornell's, which libbsdf reads): they are told by no
// theta above pi/2, no azimuth above 2 pi, and a theta above half a radian. NUM_POINTS, where given, must be
// reached. A keyword SYMMETRY (found, none, isotropic, bilateral) is Nacre's own. The interpolation is
// ScatteredBsdf's. Sources: ASTM E1392-96, E2387-05; libbsdf (Kimura), AstmReader.

#include "measured/measured_bsdf.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace nacre {

/// @throws Error with line and column
std::shared_ptr<const MeasuredBsdf> parse_astm(std::span<const std::uint8_t> bytes, std::string_view name);
/// All samples, angles in degrees.
std::vector<std::uint8_t> encode_astm(const MeasuredBsdf& measured);

} // namespace nacre
