#pragma once
// What the validator found about a material, as one HTML page that needs nothing else.

#include "measured/material_spec.h"
#include "validate/validate.h"

#include <string>

namespace nacre {

/// The verdicts with places and commands; directional albedo over the angle; maps of f and of its departure
/// from reciprocity over (theta_i, theta_o) for three azimuths, evaluated once a cell.
std::string validation_page(const MaterialSpec& material, const ValidationReport& report);

} // namespace nacre
