#include "core/version.h"

namespace nacre {

// Defined by the build for this file alone, so that a new commit recompiles nothing else.
std::string version() { return NACRE_VERSION; }

} // namespace nacre
