#pragma once
// Reads tokens and numbers from a text file and knows the line and column of each.

#include <cstdint>
#include <string>
#include <string_view>

namespace nacre {

/// The number a whole token spells, or false. Accepts a leading '+'; gives infinities where it overflows.
bool parse_number(std::string_view token, double& value);
bool parse_number(std::string_view token, std::int64_t& value);

class TextScanner {
public:
  /// Both views must outlive the scanner.
  TextScanner(std::string_view text, std::string_view file, std::size_t offset = 0)
      : text_(text), file_(file), offset_(offset) {}

  std::size_t offset() const { return offset_; }
  /// The next token on this line, or empty at its end. A '#' begins a comment where `comments` is set; a
  /// backslash before the line's end continues it.
  std::string_view token_on_line(bool comments);
  /// The next token, on whichever line, or empty at the end of the text.
  std::string_view token();
  /// Moves past the end of this line; false at the end of the text.
  bool next_line();

  /// A finite number on this line that fits a float. `what` names it in the message.
  float number_on_line(std::string_view what);
  /// The value of `token`, which must be part of the text. @throws Error if it is no finite number that fits
  /// a float
  float finite_float(std::string_view token, std::string_view what) const;
  std::int64_t integer(std::string_view token, std::string_view what) const;

  /// @throws Error at the line and column of `token`, or at the present position
  [[noreturn]] void fail_at(std::string_view token, std::string_view message) const;
  [[noreturn]] void fail(std::string_view message) const;

private:
  [[noreturn]] void fail_at(std::size_t offset, std::string_view message) const;
  std::string_view text_, file_;
  std::size_t offset_;
};

/// A token as it may be shown in a message: shortened, without control characters.
std::string in_quotes(std::string_view token);

} // namespace nacre
