#pragma once
// What `nacre info` says of a measurement.

#include "measured/measured_bsdf.h"

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace nacre {

nlohmann::json describe(const MeasuredBsdf& measured);
/// The same for people; `json` is what `describe` gave.
std::string describe_as_text(const MeasuredBsdf& measured, const nlohmann::json& json);

/// All formats that are read or written, from measured/formats.h.
nlohmann::json describe_formats();
std::string describe_formats_as_text();

} // namespace nacre
