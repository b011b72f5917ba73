#pragma once
// Commands for a person to copy.

#include <string>

namespace nacre {

/// The word as a POSIX shell needs it to be given back as it is: in quotes where it holds more than letters,
/// digits and the signs that mean nothing to a shell.
std::string shell_quoted(const std::string& word);

} // namespace nacre
