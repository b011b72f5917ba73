#pragma once
// Which Nacre this is; stamped into the files it writes.

#include <string>

namespace nacre {

/// "0.1.0+COMMIT", with ".dirty" after sources that differed from that commit when the build was configured,
/// or "0.1.0" outside a git checkout.
std::string version();

} // namespace nacre
