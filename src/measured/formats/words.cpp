#include "measured/formats/words.h"

#include "core/error.h"
#include "core/number.h"
#include "measured/formats/sample_rows.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v'; }

} // namespace

std::string_view Words::next() {
  while (offset_ < text_.size()) {
    if (text_[offset_] == comment_)
      offset_ = std::min(text_.find('\n', offset_), text_.size());
    else if (is_space(text_[offset_]))
      ++offset_;
    else
      break;
  }
  const std::size_t first = offset_;
  while (offset_ < text_.size() && !is_space(text_[offset_]) && text_[offset_] != comment_)
    ++offset_;
  return text_.substr(first, offset_ - first);
}

std::string_view Words::peek() {
  const std::size_t before = offset_;
  const std::string_view word = next();
  offset_ = before;
  return word;
}

void Words::fail(std::string_view message) const { places_.fail_at(text_.substr(offset_), message); }

std::string_view Words::word(std::string_view what) {
  const std::string_view w = next();
  if (w.empty()) fail(fmt::format("expected {}, found the end of the file", what));
  return w;
}

double Words::number(std::string_view what) { return double(places_.finite_float(word(what), what)); }

std::size_t Words::count(std::string_view what, std::size_t most) {
  const std::string_view w = word(what);
  std::int64_t n = 0;
  if (!parse_number(w, n) || n < 1 || std::uint64_t(n) > most)
    fail_at(w, fmt::format("expected {}, 1 to {}, found {}", what, most, in_quotes(w)));
  return std::size_t(n);
}

std::vector<double> Words::angles(std::string_view what, double from_deg, double to_deg) {
  // A number takes two characters: there cannot be more than half the bytes left.
  const std::size_t n =
      count(fmt::format("the number of angles {}", what), std::max<std::size_t>(1, bytes_left() / 2));
  std::vector<double> radians;
  double last = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::string_view w = word(fmt::format("angle {} of {} {}", i + 1, n, what));
    double x = 0;
    if (!parse_number(w, x) || !(x >= from_deg - 1e-6 && x <= to_deg + 1e-6) || (i > 0 && !(x > last)))
      fail_at(w, fmt::format("expected angle {} of {} {}, {} to {} degrees and increasing, found {}", i + 1,
                             n, what, from_deg, to_deg, in_quotes(w)));
    last = x;
    radians.push_back(std::clamp(x, from_deg, to_deg) * pi / 180);
  }
  return radians;
}

std::size_t Words::one_of(std::string_view what, const std::vector<std::string>& known) {
  const std::string_view w = word(what);
  const std::string lower = lower_case(w);
  for (std::size_t i = 0; i < known.size(); ++i)
    if (lower == lower_case(known[i])) return i;
  fail_at(w, fmt::format("expected {}, found {}{}", what, in_quotes(w), suggestion(w, known)));
}

} // namespace nacre
