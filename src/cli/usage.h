#pragma once
// What is wrong with a command line, said so that it can be mended.

#include <CLI/CLI.hpp>

#include <string>

namespace nacre {

/// One line on why `app` could not read its arguments: the word that is unknown with the nearest that is
/// known, or the option and what it expects; then where to read on.
std::string explain(const CLI::App& app, const CLI::ParseError& error);

} // namespace nacre
