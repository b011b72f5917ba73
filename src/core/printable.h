#pragma once
// Text that others wrote, in a message to a person.

#include <string>
#include <string_view>

namespace nacre {

/// Bytes that are no UTF-8, and control characters but the end of a line, as \x1B: a terminal does not obey
/// them.
std::string printable(std::string_view text);

} // namespace nacre
