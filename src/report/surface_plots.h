#pragma once
// Curves of what models are made of: normal distributions, masking, Fresnel reflectance; and of what becomes
// of it: azimuth slices, polar lobes, albedo over roughness.

#include "report/material_plots.h"

namespace nacre {

/// D over theta_m in the plane of the tangent, and G1 over theta, one curve a microsurface.
/// @throws Error naming a material of which no lobe is made of facets
Plot facet_normal_plot(std::span<const PlottedMaterial> materials, bool logarithmic);
Plot masking_plot(std::span<const PlottedMaterial> materials);

/// Fresnel reflectance of named metals and glasses over the angle of incidence at `wavelength_nm`; of one
/// substance alone with both polarisations too.
/// @throws Error naming an unknown substance
Plot fresnel_plot(std::span<const std::string> substances, double wavelength_nm);
/// At normal incidence, over the wavelength.
Plot fresnel_wavelength_plot(std::span<const std::string> substances);

/// Luminance of f over the azimuth between viewer and light, at theta_o = theta_i = each of the angles.
Plot azimuth_plot(std::span<const PlottedMaterial> materials, std::span<const double> theta_deg,
                  bool logarithmic);
/// Luminance of f over theta_i in the plane of incidence for fixed viewers.
Plot theta_i_plot(std::span<const PlottedMaterial> materials, std::span<const double> theta_o_deg,
                  bool logarithmic);
/// Directional albedo (luminance) over a parameter, one curve an angle and material.
Plot albedo_over_parameter_plot(std::span<const PlottedMaterial> materials, std::string_view parameter,
                                double lo, double hi, std::span<const double> theta_deg);

/// The lobes of the plane of incidence as an SVG file: the length of a ray is f cos theta_o to the power
/// `compression`, the longest being the radius. A full circle where a material transmits.
std::string polar_svg(std::span<const PlottedMaterial> materials, std::span<const double> theta_i_deg,
                      double compression = 0.5);
/// The same as an element inside an HTML page.
std::string polar_element(std::span<const PlottedMaterial> materials, std::span<const double> theta_i_deg,
                          double compression = 0.5);

} // namespace nacre
