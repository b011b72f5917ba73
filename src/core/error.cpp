#include "core/error.h"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <vector>

namespace nacre {

Error Error::in_text(std::string_view file, int line, int column, std::string_view message) {
  if (line <= 0) return in_file(file, message);
  if (column <= 0) return Error(fmt::format("{}:{}: {}", file, line, message));
  return Error(fmt::format("{}:{}:{}: {}", file, line, column, message));
}

Error Error::in_binary(std::string_view file, std::uint64_t byte_offset, std::string_view message) {
  return Error(fmt::format("{}: byte {}: {}", file, byte_offset, message));
}

Error Error::in_file(std::string_view file, std::string_view message) {
  return Error(fmt::format("{}: {}", file.empty() ? "''" : file, message));
}

namespace {

/// Edit distance where an insertion, a deletion, a substitution and a swap of neighbours each cost 1 (optimal
/// string alignment), without regard to letter case.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  const auto same = [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
  };
  std::vector<std::size_t> before(b.size() + 1), previous(b.size() + 1), current(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j)
    previous[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = previous[j - 1] + (same(a[i - 1], b[j - 1]) ? 0 : 1);
      current[j] = std::min({previous[j] + 1, current[j - 1] + 1, substitution});
      if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]))
        current[j] = std::min(current[j], before[j - 2] + 1);
    }
    std::swap(before, previous);
    std::swap(previous, current);
  }
  return previous[b.size()];
}

} // namespace

std::string nearest_name(std::string_view wrong, std::span<const std::string> known) {
  // A third of the letters may be wrong: more would suggest names that merely have the same length.
  std::size_t best = std::max<std::size_t>(1, wrong.size() / 3) + 1;
  std::string nearest;
  for (const std::string& name : known) {
    // The lengths alone bound the distance from below, so that a hostile name of a megabyte costs nothing.
    const std::size_t gap = std::max(wrong.size(), name.size()) - std::min(wrong.size(), name.size());
    if (gap >= best) continue;
    const std::size_t distance = edit_distance(wrong, name);
    // A name all of whose letters are replaced is no relative.
    if (distance >= best || distance >= std::max(wrong.size(), name.size())) continue;
    best = distance;
    nearest = name;
  }
  return nearest;
}

std::string suggestion(std::string_view wrong, std::span<const std::string> known) {
  if (const std::string nearest = nearest_name(wrong, known); !nearest.empty())
    return fmt::format(" (did you mean '{}'?)", nearest);
  if (known.empty()) return {};
  constexpr std::size_t most_listed = 40;
  std::string list;
  for (std::size_t i = 0; i < std::min(known.size(), most_listed); ++i)
    list += (i > 0 ? ", " : "") + known[i];
  if (known.size() > most_listed) list += fmt::format(" and {} more", known.size() - most_listed);
  return " (known: " + list + ")";
}

} // namespace nacre
