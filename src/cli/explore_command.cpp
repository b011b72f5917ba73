#include "cli/commands.h"
#include "cli/number_range.h"
#include "core/parallel.h"
#include "explorer/explorer.h"

#include <cstdlib>
#include <fcntl.h>
#include <fmt/format.h>
#include <iostream>
#include <spawn.h>
#include <sys/wait.h>

extern char** environ;

namespace nacre {
namespace {

/// The address goes to xdg-open as an argument of its own, through no shell. Whether it works is not our
/// affair: the address was printed.
void open_browser(const std::string& address) {
  const char *display = std::getenv("DISPLAY"), *wayland = std::getenv("WAYLAND_DISPLAY");
  if (!(display && *display) && !(wayland && *wayland)) return;
  std::string program = "xdg-open", argument = address;
  char* const arguments[] = {program.data(), argument.data(), nullptr};
  posix_spawn_file_actions_t quiet;
  ::posix_spawn_file_actions_init(&quiet);
  ::posix_spawn_file_actions_addopen(&quiet, 1, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_addopen(&quiet, 2, "/dev/null", O_WRONLY, 0);
  pid_t pid = 0;
  if (::posix_spawnp(&pid, program.c_str(), &quiet, nullptr, arguments, environ) == 0)
    std::thread([pid] { ::waitpid(pid, nullptr, 0); }).detach();
  ::posix_spawn_file_actions_destroy(&quiet);
}

} // namespace

void add_explore_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("explore", "look at materials in a browser, live");
  struct Options {
    ExplorerOptions options;
    bool no_browser = false;
  };
  auto a = std::make_shared<Options>();
  command->add_option("MATERIAL", a->options.start.materials,
                      "NAME:PARAM=VALUE,...[+NAME:...], a measurement, a .json or a .brdf file");
  command->add_option("--port", a->options.port, "of the loopback interface; 0 for any free one")
      ->check(whole_number_in(0, 65535));
  command->add_flag("--no-browser", a->no_browser, "only print the address");
  command->add_option("--scene", a->options.start.scene, "scene file to render at once");
  command->footer("Opens only files below the current folder. Ends on Ctrl-C.\n"
                  "\nExample: nacre explore ggx_conductor:metal=Au gold.binary mine.brdf");
  command->callback([a] {
    Explorer explorer(a->options);
    catch_ctrl_c();
    std::cout << explorer.address() << std::endl;
    if (!a->no_browser) open_browser(explorer.address());
    explorer.run();
  });
}

} // namespace nacre
