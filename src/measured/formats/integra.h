#pragma once
// Integra's diffuse distributions: reflection (.ddr) and transmission (.ddt), text. The two differ by their
// ending alone.
//
// Words, without regard to case and lines; a comment runs from ';' to the end of its line.
//   Source Measured|Generated|Edited|Morphed
//   TypeSym AxiSymmetrical | PlaneSymmetrical | DirSymmetrical | ASymmetrical | ASymmetrical 4D
//   TypeColorModel BW | RGB | spectral N
//   TypeData Luminance|Intensity Absolute|Relative
//   psi N a...     azimuths of incidence, of 4D data      sigma N a...   polar angles of incidence
//   sigmaT a...    polar angles of the refracted ray, one per sigma, where it is not straight on (.ddt)
//   phi N a...     azimuths about the specular direction, 0 towards the normal; 0 to 180 where
//                  plane-symmetrical
//   theta N a...   angles from the specular direction
// then a channel after another, "bw", "red", "gre", "blu" or "wl NM":
//   kbdf k...      optional: a factor per psi and sigma, sigma fastest
//   def v... enddef   psi slowest, then sigma, phi, theta
// f = kbdf v / pi for luminance (1 is a white diffuser), f = kbdf v / cos theta_o for intensity. With
// Relative the values say shape alone: they are scaled so that each incidence scatters the share kbdf of its
// light (AngleGrid::albedo); without a kbdf they are taken as absolute, which the facts say. Interpolation:
// AngleGrid, about the specular direction. Source: libbsdf (Kimura), DdrReader and DdrWriter.

#include "measured/measured_bsdf.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace nacre {

/// @throws Error with line and column
std::shared_ptr<const MeasuredBsdf> parse_integra(std::span<const std::uint8_t> bytes, std::string_view name,
                                                  bool transmits);

} // namespace nacre
