#pragma once
// What materials look like in numbers: the curves of their reflectance, as plots.

#include "measured/material_spec.h"
#include "report/svg_plot.h"

#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace nacre {

/// Directions of one curve; both unit vectors, local frame.
struct Directions {
  std::vector<float> wo_x, wo_y, wo_z, wi_x, wi_y, wi_z;
  void add(const Vec3d& wo, const Vec3d& wi);
  std::size_t size() const { return wo_x.size(); }
};

/// f in 1/sr, linear RGB, at each pair, evaluated in packs. Delta lobes do not show.
std::vector<std::array<double, 3>> evaluate(const MaterialSpec& material, const Directions& directions);

/// Share of the light arriving from theta that leaves again, per channel, transmission included: the mean of
/// f cos / pdf over `samples` directions chosen by the material itself, Sobol' points. Delta lobes count.
/// @param theta_rad  in [0, pi/2)
/// @param phi_rad    azimuth from the tangent
std::array<double, 3> sampled_albedo(const MaterialSpec& material, double theta_rad, int samples = 4096,
                                     double phi_rad = 0);

/// Luminance (BT.709) of RGB.
double luminance(const std::array<double, 3>& rgb);

/// A material as one of several of a plot.
struct PlottedMaterial {
  const MaterialSpec* material;
  std::string label;
  bool dots = false; ///< markers instead of lines
};

/// n + 1 numbers from lo to hi, evenly.
std::vector<double> steps(double lo, double hi, int n);

/// Where a curve is evaluated: abscissae, and the directions at each.
struct CurvePoints {
  std::vector<double> x;
  Directions at;
};
/// Curves of the luminance of f, one a material and angle; of one material in dots and one in lines those of
/// an angle share a colour.
/// @param points  of the curve at an angle in degrees, for dots or a line
void add_luminance_curves(Plot& plot, std::span<const PlottedMaterial> materials,
                          std::span<const double> angles_deg, std::string_view angle_name,
                          const std::function<CurvePoints(double angle_deg, bool dots)>& points);

/// Luminance of f in the plane of incidence over theta_o, positive on the mirror's side, one colour an angle
/// of incidence (one material, or one of dots and one of lines), else one colour a material and angle.
Plot incidence_plane_plot(std::span<const PlottedMaterial> materials, std::span<const double> theta_i_deg,
                          bool logarithmic);
/// f over theta_h at a fixed theta_d, phi_d = 90 degrees, one colour an RGB channel; with several materials
/// of the same look their luminances.
Plot theta_h_plot(std::span<const PlottedMaterial> materials, double theta_d_deg, bool logarithmic);
/// Luminance of f over theta_h for fixed light directions: the half vector is turned from the normal towards
/// the light, the viewer from the mirror direction over the light to the horizon behind it. One colour an
/// angle, as in incidence_plane_plot.
Plot half_vector_plot(std::span<const PlottedMaterial> materials, std::span<const double> theta_i_deg,
                      bool logarithmic);
/// f over theta_d at theta_h = 0, where Fresnel reflectance shows, as above.
Plot theta_d_plot(std::span<const PlottedMaterial> materials, bool logarithmic);
/// Directional albedo over theta, as above.
Plot albedo_plot(std::span<const PlottedMaterial> materials);

} // namespace nacre
