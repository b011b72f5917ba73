#pragma once
// Failures: what went wrong, where, what was expected, and how to mend it.

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace nacre {

/// Something Nacre was given does not work: a file, a value, a request. `what()` is one or two lines for a
/// person: "FILE:LINE:COLUMN: message" for a text file, "FILE: byte OFFSET: message" for a binary one.
/// Commands print it and exit with status 1.
class Error : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
  static Error in_text(std::string_view file, int line, int column, std::string_view message);
  static Error in_binary(std::string_view file, std::uint64_t byte_offset, std::string_view message);
  static Error in_file(std::string_view file, std::string_view message);
};

/// The command line itself is wrong; commands exit with status 2.
class UsageError : public Error {
public:
  using Error::Error;
};

/// The name among `known` nearest to `wrong` in edit distance, or empty if none is near enough to suggest.
std::string nearest_name(std::string_view wrong, std::span<const std::string> known);
/// " (did you mean 'x'?)" or, if nothing is near, " (known: a, b, c)".
std::string suggestion(std::string_view wrong, std::span<const std::string> known);

} // namespace nacre
