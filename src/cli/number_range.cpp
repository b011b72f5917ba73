#include "cli/number_range.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

template <class T>
bool reads_as(const std::string& text, T& value) {
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stopped == end;
}

} // namespace

CLI::Validator number_in(double lo, double hi) {
  const auto check = [=](std::string& text) {
    double value = 0;
    if (reads_as(text, value) && std::isfinite(value) && value >= lo && value <= hi) return std::string();
    return fmt::format("expected a number from {:g} to {:g}, found '{}'", lo, hi, text);
  };
  return CLI::Validator(check, fmt::format("in [{:g}, {:g}]", lo, hi));
}

CLI::Validator whole_number_in(std::uint64_t lo, std::uint64_t hi) {
  const auto check = [=](std::string& text) {
    std::uint64_t value = 0;
    const bool octal = text.size() > 1 && text.front() == '0';
    if (!octal && reads_as(text, value) && value >= lo && value <= hi) return std::string();
    return fmt::format("expected a whole number from {} to {}, found '{}'", lo, hi, text);
  };
  return CLI::Validator(check, fmt::format("in [{}, {}]", lo, hi));
}

} // namespace nacre
