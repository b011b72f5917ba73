#pragma once
// Words and numbers of a text in which line breaks mean nothing and comments run to the end of a line.

#include "core/text_scanner.h"

#include <string>
#include <string_view>
#include <vector>

namespace nacre {

class Words {
public:
  /// @param comment  the character that begins one; both views must outlive this
  Words(std::string_view text, std::string_view file, char comment)
      : text_(text), places_(text, file), comment_(comment) {}

  /// The next word, or empty at the end of the text. `peek` leaves it to be read again.
  std::string_view next();
  std::string_view peek();
  /// The next word. @throws Error at the end of the text
  std::string_view word(std::string_view what);
  /// @throws Error unless the next word is a finite number that fits a float
  double number(std::string_view what);
  /// A whole number from 1 to `most`. @throws Error
  std::size_t count(std::string_view what, std::size_t most);
  /// A count, then as many angles in degrees that increase. In radians. @throws Error
  std::vector<double> angles(std::string_view what, double from_deg, double to_deg);
  /// One of `known`, without regard to case: its index. @throws Error that suggests the nearest
  std::size_t one_of(std::string_view what, const std::vector<std::string>& known);

  [[noreturn]] void fail_at(std::string_view word, std::string_view message) const {
    places_.fail_at(word, message);
  }
  [[noreturn]] void fail(std::string_view message) const;
  std::size_t bytes_left() const { return text_.size() - offset_; }

private:
  std::string_view text_;
  TextScanner places_;
  char comment_;
  std::size_t offset_ = 0;
};

} // namespace nacre
