#include "core/text_scanner.h"

#include "core/error.h"

#include <charconv>
#include <cmath>
#include <cstdlib>

namespace nacre {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

std::string_view without_plus(std::string_view token) {
  if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
  return token;
}

} // namespace

bool parse_number(std::string_view token, double& value) {
  token = without_plus(token);
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  if (token.empty() || stop != end) return false;
  // from_chars leaves the value alone out of range; strtod tells 0 from infinity.
  if (error == std::errc::result_out_of_range) value = std::strtod(std::string(token).c_str(), nullptr);
  return error == std::errc() || error == std::errc::result_out_of_range;
}

bool parse_number(std::string_view token, std::int64_t& value) {
  token = without_plus(token);
  const char* end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  return !token.empty() && stop == end && error == std::errc();
}

std::string in_quotes(std::string_view token) {
  constexpr std::size_t longest = 40;
  std::string shown = "'";
  for (const char c : token.substr(0, longest))
    shown += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return shown + (token.size() > longest ? "...'" : "'");
}

std::string_view TextScanner::token_on_line(bool comments) {
  while (offset_ < text_.size()) {
    const char c = text_[offset_];
    if (c == '\\') {
      const std::size_t next = offset_ + (text_.substr(offset_ + 1, 1) == "\r" ? 2 : 1);
      if (next >= text_.size() || text_[next] != '\n') break;
      offset_ = next + 1;
    } else if (comments && c == '#') {
      while (offset_ < text_.size() && text_[offset_] != '\n')
        ++offset_;
      return {};
    } else if (is_blank(c)) {
      ++offset_;
    } else {
      break;
    }
  }
  const std::size_t first = offset_;
  while (offset_ < text_.size() && !is_blank(text_[offset_]) && text_[offset_] != '\n')
    ++offset_;
  return text_.substr(first, offset_ - first);
}

std::string_view TextScanner::token() {
  while (offset_ < text_.size() && (is_blank(text_[offset_]) || text_[offset_] == '\n'))
    ++offset_;
  const std::size_t first = offset_;
  while (offset_ < text_.size() && !is_blank(text_[offset_]) && text_[offset_] != '\n')
    ++offset_;
  return text_.substr(first, offset_ - first);
}

bool TextScanner::next_line() {
  const std::size_t end = text_.find('\n', offset_);
  offset_ = end == std::string_view::npos ? text_.size() : end + 1;
  return offset_ < text_.size();
}

float TextScanner::number_on_line(std::string_view what) {
  const std::string_view t = token_on_line(false);
  if (t.empty()) fail("expected " + std::string(what) + ", found the end of the line");
  return finite_float(t, what);
}

float TextScanner::finite_float(std::string_view token, std::string_view what) const {
  double value = 0;
  if (!parse_number(token, value))
    fail_at(token, "expected " + std::string(what) + ", found " + in_quotes(token));
  const float single = static_cast<float>(value);
  if (!std::isfinite(single))
    fail_at(token, std::string(what) + " is not a finite number: " + in_quotes(token));
  return single;
}

std::int64_t TextScanner::integer(std::string_view token, std::string_view what) const {
  std::int64_t value = 0;
  if (!parse_number(token, value))
    fail_at(token, "expected " + std::string(what) + ", found " + in_quotes(token));
  return value;
}

void TextScanner::fail_at(std::string_view token, std::string_view message) const {
  fail_at(static_cast<std::size_t>(token.data() - text_.data()), message);
}
void TextScanner::fail(std::string_view message) const { fail_at(offset_, message); }

void TextScanner::fail_at(std::size_t offset, std::string_view message) const {
  int line = 1;
  std::size_t line_start = 0;
  for (std::size_t i = text_.find('\n'); i < offset; i = text_.find('\n', i + 1)) {
    ++line;
    line_start = i + 1;
  }
  throw Error::in_text(file_, line, static_cast<int>(offset - line_start) + 1, message);
}

} // namespace nacre
