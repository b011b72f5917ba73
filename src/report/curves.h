#pragma once
// Curves of reflectance as numbers: what an explorer draws, live, of several materials at once.

#include "report/material_plots.h"

#include <optional>
#include <string_view>

namespace nacre {

/// What varies along a curve: docs/explorer-protocol.md, "Curves".
enum class CurveKind { theta_h, theta_d, theta_i, theta_o, phi, polar, albedo, D, G1 };

/// @throws Error that suggests the nearest name
CurveKind parse_curve_kind(std::string_view name);

/// Directions that stay, degrees. `phi_o` is the viewer's azimuth less the light's: 180 is the mirror's side.
struct CurveGeometry {
  double theta_i = 45, phi_i = 0, phi_o = 180, theta_d = 0;
};

struct Curves {
  std::vector<double> x;      ///< degrees
  std::vector<double> cosine; ///< of the angle that the kind is about, one a point
  /// [material][point]: f in 1/sr, or albedo, or D in 1/sr, or G1; linear RGB. NaN where nothing was
  /// measured, and of D and G1 for a material without facets.
  std::vector<std::vector<std::array<double, 3>>> y;
};

/// Abscissae lie closer where curves are steep: theta_h as squares, angles of reflection about the mirror.
/// @param points  in [2, 100000]. @throws Error outside, or for angles that are not finite
Curves make_curves(std::span<const MaterialSpec* const> materials, CurveKind kind,
                   const CurveGeometry& geometry, int points);

/// True where a lobe also sends light through.
bool transmits(const MaterialSpec& material);
/// True where no lobe has a value for these directions, because it was not measured.
bool is_hole(const MaterialSpec& material, const Vec3d& wo, const Vec3d& wi);
/// f as report/material_plots.h has it, NaN in holes.
std::vector<std::array<double, 3>> evaluate_with_holes(const MaterialSpec& material,
                                                       const Directions& directions);

} // namespace nacre
