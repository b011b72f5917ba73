#pragma once
// Metrics on pictures: a sphere of the material, seen from afar and lit from many directions, as measured and
// as the model has it.
//
//   image    root mean square difference of the pixels' linear RGB over that of the measured picture (Ngan et
//            al. 2006, Image-driven Navigation of Analytical BRDF Models, compare BRDFs by such pictures)
//   delta_e  mean CIE 1976 colour difference of the pixels, the brightest pixel of a white Lambertian sphere
//   in
//            that light being white (CIE 15:2004, eq. 8.21); Bagher et al. 2012 show such differences
//
// Pixels in which the measurement has a hole or which see or are lit beyond the cut take no part.

#include "measured/material_spec.h"

#include <array>
#include <string>
#include <vector>

namespace nacre {

/// Light from one direction, at infinity.
struct DistantLight {
  Vec3d direction; ///< towards the light, in the frame of the picture: x right, y up, z to the viewer
  std::array<double, 3> irradiance; ///< linear RGB, on a surface that faces it
};

/// A key light, two fill lights and 96 directions of even sky.
std::vector<DistantLight> studio_lights();
/// An environment map as some `count` lights, each the mean of a cell of directions of even solid angle.
/// @param path  latitude-longitude picture, linear; its middle column lies behind the viewer's back
/// @throws Error if it cannot be read
std::vector<DistantLight> environment_lights(const std::string& path, int count = 512);

struct ImageErrors {
  double image = 0, delta_e = 0;
  std::size_t pixels = 0; ///< 0: not compared
};

/// @param size  pixels across the sphere
ImageErrors image_errors(const MeasuredBsdf& measured, const MaterialSpec& material,
                         const std::vector<DistantLight>& lights, int size = 48, double max_theta_deg = 80);

} // namespace nacre
