#pragma once
// Parses the inside of a Mitsuba scene.

#include "core/scratch_folder.h"
#include "scene/mitsuba.h"

namespace nacre {

inline const std::string sensor = "<sensor type='perspective'/>";

inline Scene parse(const std::string& inside, const MitsubaOptions& options = {}) {
  return parse_mitsuba_scene("<scene version='3.0.0'>" + sensor + inside + "</scene>", "s.xml", options);
}
/// The message of the Error it gives; the test fails if it gives none.
inline std::string error(const std::string& inside, const MitsubaOptions& options = {}) {
  return message_of([&] { parse(inside, options); });
}
} // namespace nacre
