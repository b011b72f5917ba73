#include "core/printable.h"

#include <fmt/format.h>

namespace nacre {
namespace {

/// Bytes of the character of UTF-8 that the text begins with; 0: none begins there.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const std::size_t n = byte(0) < 0x80   ? 1
                        : byte(0) < 0xc2 ? 0
                        : byte(0) < 0xe0 ? 2
                        : byte(0) < 0xf0 ? 3
                        : byte(0) < 0xf5 ? 4
                                         : 0;
  if (n > text.size()) return 0;
  for (std::size_t i = 1; i < n; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  // Control characters of Latin 1, too, are commands to some terminals.
  if (n == 2 && byte(0) == 0xc2 && byte(1) < 0xa0) return 0;
  return n;
}

} // namespace

std::string printable(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const auto first = static_cast<unsigned char>(text[0]);
    const std::size_t n = first < 32 && first != '\n' ? 0 : first == 127 ? 0 : character_length(text);
    if (n == 0)
      result += fmt::format("\\x{:02X}", first);
    else
      result += text.substr(0, n);
    text.remove_prefix(std::max<std::size_t>(n, 1));
  }
  return result;
}

} // namespace nacre
