#include "cli/command_line.h"

#include "core/shell.h"

namespace nacre {

std::string command_line(const CLI::App& command) {
  std::string text = "nacre " + command.get_name();
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0 || option->get_name() == "--help") continue;
    for (const std::string& value : option->results()) {
      if (!option->get_positional()) text += " " + option->get_name();
      if (option->get_positional() || option->get_expected_max() > 0) text += " " + shell_quoted(value);
    }
  }
  return text;
}

} // namespace nacre
