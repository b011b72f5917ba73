#pragma once
// Zemax / OpticStudio tabular BSDF, text (.bsdf): the interchange format of Radiant's imaging sphere.
//
//   # comments
//   Source Measured
//   Symmetry PlaneSymmetrical | Asymmetrical | Asymmetrical4D
//   SpectralContent Monochrome | XYZ
//   ScatterType BRDF | BTDF
//   SampleRotation N, AngleOfIncidence N, ScatterAzimuth N, ScatterRadial N: each with N increasing degrees
//   Monochrome (or TristimulusX, TristimulusY, TristimulusZ, each with its own block)
//   DataBegin
//   TIS t, then a line of radial values an azimuth: for each rotation, in it for each angle of incidence
//   DataEnd
//
// Radial 0 is the specular direction (straight on for BTDF), azimuth 0 points from there towards the normal
// and increases counter-clockwise; PlaneSymmetrical data has azimuths 0 to 180. A rotation of the sample is
// read as the azimuth of the incidence. Values are f in 1/sr; a tristimulus is CIE XYZ, read as linear sRGB.
// TIS, the share scattered, is kept as a fact. Interpolation: AngleGrid, about the specular direction.
// Sources: R. Rykowski, BSDF Data Interchange File Format Specification (Zemax 2008); libbsdf (Kimura),
// ZemaxBsdfReader.

#include "measured/measured_bsdf.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace nacre {

/// True where the first word that is no comment is a keyword of the header: RGL's files share the ending.
bool is_zemax(std::span<const std::uint8_t> bytes);
/// @throws Error with line and column
std::shared_ptr<const MeasuredBsdf> parse_zemax(std::span<const std::uint8_t> bytes, std::string_view name);
/// Monochrome, or XYZ where there is colour. A grid about the specular direction is written as it is, others
/// are resampled: incidence every 5 degrees to 85, 24 azimuths, radii from 0.1 degrees widening to 175; 24
/// rotations where anisotropic. Holes are written as 0: the format knows none.
/// @throws Error where there is nothing on the front to reflect or to transmit to the back
std::vector<std::uint8_t> encode_zemax(const MeasuredBsdf& measured);

} // namespace nacre
