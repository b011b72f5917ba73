#include "cli/usage.h"

#include "core/error.h"

#include <cctype>
#include <fmt/format.h>

namespace nacre {
namespace {

bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && !std::isdigit(static_cast<unsigned char>(word[1])) &&
         word[1] != '.';
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

void add_option_names(const CLI::App& app, std::vector<std::string>& names) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames())
      names.push_back("--" + name);
    for (const std::string& name : option->get_snames())
      names.push_back("-" + name);
  }
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(word, known);
  return nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest);
}

std::string reason(const CLI::App& app, const CLI::App* command, const CLI::ParseError& error) {
  const std::vector<std::string> rest = app.remaining(true);
  if (!command && !rest.empty() && !is_option(rest.front()))
    return fmt::format("unknown command '{}'{}", rest.front(), suggestion(rest.front(), command_names(app)));
  std::vector<std::string> options;
  add_option_names(app, options);
  if (command) add_option_names(*command, options);
  for (const std::string& word : rest)
    if (is_option(word)) {
      const std::string name = word.substr(0, word.find('='));
      return fmt::format("unknown option '{}'{}", name, did_you_mean(name, options));
    }
  if (!command) return fmt::format("expected a command: {}", fmt::join(command_names(app), ", "));
  if (dynamic_cast<const CLI::ExtrasError*>(&error) && !rest.empty())
    return fmt::format("unexpected argument '{}'", rest.front());
  return error.what();
}

} // namespace

std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> used = app.get_subcommands();
  const CLI::App* command = used.empty() ? nullptr : used.front();
  const std::string why = reason(app, command, error);
  if (!command) return fmt::format("{}; see nacre --help", why);
  return fmt::format("{}: {}; see nacre {} --help", command->get_name(), why, command->get_name());
}

} // namespace nacre
