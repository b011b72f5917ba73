#pragma once
// Daylight: the clear sky and the sun as an environment map.

#include "core/image.h"
#include "core/vec.h"

namespace nacre {

struct SkyOptions {
  double turbidity = 3;            ///< haze: (haze + air) / air in optical thickness, in [2, 10]
  Vec3d sun_direction{0, 1, 0};    ///< to the sun, +y up, any length but 0; at or above the horizon
  Vec3d ground_albedo{.2, .2, .2}; ///< linear sRGB in [0, 1] of the ground below the horizon
  double sky_scale = 1;            ///< multiplies the sky's radiance; 0 leaves the sun alone
  double sun_scale = 1;            ///< multiplies the sun's radiance; 0 leaves the sky alone
  int width = 1024, height = 512;  ///< texels
};

/// Latitude-longitude map of radiance in linear sRGB, in the orientation of EnvironmentLight: row 0 is +y.
/// Units: (1, 1, 1) is D65 light whose luminance is that of 1 W/(m^2 sr nm) at every wavelength, 72,983
/// cd/m^2. The sun is a disk of its true size, widened to at least a texel, whose irradiance is kept. The
/// ground is a diffuse plane under that light. Sky: Preetham, Shirley, Smits 1999, A Practical Analytic Model
/// for Daylight, appendix A.2. Sun: a blackbody of 5772 K seen through their appendix A.1's air and aerosol;
/// ozone, mixed gases and water are left out.
/// @throws Error naming the option outside its domain
Image make_sky(const SkyOptions& options);

} // namespace nacre
