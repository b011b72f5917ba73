#pragma once
// A command as it was given, for what it leaves behind to say how it was made.

#include <CLI/CLI.hpp>

#include <string>

namespace nacre {

/// "nacre fit gold.binary --starts 8": put together again from what was parsed, quoted as a shell needs it.
std::string command_line(const CLI::App& command);

} // namespace nacre
