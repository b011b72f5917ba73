#pragma once
// Directional albedo of a table, by quadrature over half vectors.

#include "measured/merl_table.h"

namespace nacre {

/// Share of the light arriving from a direction at angle theta_o to the normal that leaves again, per RGB
/// channel. Holes reflect nothing. Midpoint rule over 720 x 128 half vectors, three to a node of the
/// original's theta_h and more: good to some 0.1 %, less well within a degree of grazing.
/// @param theta_o  radians, in [0, pi/2)
/// Source: Nicodemus et al. 1977, directional-hemispherical reflectance.
std::array<double, 3> directional_albedo(const MerlTable& table, double theta_o);

} // namespace nacre
