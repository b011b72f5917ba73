#include "cli/command_line.h"

#include <algorithm>
#include <cctype>
#include <cstring>

namespace nacre {
namespace {

/// A word of a command line as a shell would need it.
std::string quoted(const std::string& word) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("-_./:=,+@%", c);
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string out = "'";
  for (const char c : word)
    out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

} // namespace

std::string command_line(const CLI::App& command) {
  std::string text = "nacre " + command.get_name();
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0 || option->get_name() == "--help") continue;
    for (const std::string& value : option->results()) {
      if (!option->get_positional()) text += " " + option->get_name();
      if (option->get_positional() || option->get_expected_max() > 0) text += " " + quoted(value);
    }
  }
  return text;
}

} // namespace nacre
