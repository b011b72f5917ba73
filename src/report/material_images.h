#pragma once
// What materials look like as pictures that need no renderer: lit spheres, the white furnace, Burley's slice.
// Everything is evaluated in packs of directions. Images are linear RGB.

#include "core/image.h"
#include "measured/material_spec.h"

#include <span>

namespace nacre {

struct SphereLight {
  double theta_deg = 40, phi_deg = 120; ///< towards the light, from the viewer's axis and the right
  bool cosine = true;                   ///< false: pi f alone, without cos theta_i
  /// The picture shows normals that lean half as far as those of a sphere: its rim sees the mirror direction
  /// at grazing angles, and the highlight is larger.
  bool double_theta = false;
  bool holes = false; ///< true: NaN where a measurement holds nothing, else 0
};
/// A sphere of `size` pixels under one directional light of irradiance pi at normal incidence, seen from
/// afar: pi f cos theta_i, so that a white Lambertian facing the light is 1. Its poles are above and below,
/// tangents run east. The background is 0.
Image lit_sphere(const MaterialSpec& material, int size, const SphereLight& light = {});

/// A sphere under uniform radiance 1 in front of it: pixels hold the directional albedo.
Image furnace_sphere(const MaterialSpec& material, int size);
/// Spheres side by side under uniform radiance 1 in front of it, each with another value of `parameter`: what
/// keeps all light is invisible, what loses some is darker, what gains is brighter. Pixels hold the
/// directional albedo.
Image white_furnace(const MaterialSpec& material, std::string_view parameter, std::span<const double> values,
                    int size);
/// The roughness of the material's first lobe that has one: alpha, or alpha_x with alpha_y, m, roughness,
/// sigma, beta. @throws Error if there is none
std::string roughness_parameter(const MaterialSpec& material);
/// The values of `parameter` that all lobes that have it allow: {lo, hi}. @throws Error if no lobe has it
std::array<double, 2> parameter_domain(const MaterialSpec& material, std::string_view parameter);
/// `material` with every lobe's `parameter` set, and _x with _y. @throws Error if no lobe has it, or the
/// value lies outside its domain
MaterialSpec with_parameter(const MaterialSpec& material, std::string_view parameter, double value);

struct SliceAxes {
  bool square_root = true;   ///< theta_h is spaced as its square root
  bool double_theta = false; ///< theta_h goes to 45 degrees only: the axis is that of 2 theta_h
  double phi_d_deg = 90;
  bool holes = false; ///< true: NaN where a measurement holds nothing, else 0
};
/// f over theta_h (left to right, 0 to 90 degrees) and theta_d (bottom to top). 0 where a direction lies
/// below the surface. Source: Burley 2012, Physically-Based Shading at Disney, section 3.
Image image_slice(const MaterialSpec& material, int size, const SliceAxes& axes = {});

} // namespace nacre
