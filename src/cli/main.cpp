#include "cli/commands.h"
#include "cli/exit_status.h"
#include "cli/number_range.h"
#include "cli/usage.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/version.h"

#include <csignal>
#include <fmt/format.h>
#include <iostream>
#include <new>

int main(int argc, char** argv) {
  using namespace nacre;
  std::signal(SIGXFSZ, SIG_IGN); // a limit on file sizes is an error of the write, not the end of the process
  CLI::App app{"Nacre takes a material from measurement to picture: read, fit, validate, render, display.",
               "nacre"};
  app.set_version_flag("--version", version());
  app.require_subcommand(1);
  app.fallthrough(); // --threads may stand before or after the command's name
  int threads = 0;
  app.add_option("--threads", threads, "threads to use; 0 for all cores")->check(whole_number_in(0, 4096));
  app.parse_complete_callback([&] { set_thread_count(threads); });
  app.footer("Each command explains itself: nacre COMMAND --help");

  add_demo_command(app);
  add_materials_command(app);
  add_info_command(app);
  add_eval_command(app);
  add_plot_command(app);
  add_fit_command(app);
  add_convert_command(app);
  add_export_command(app);
  add_validate_command(app);
  add_bounces_command(app);
  add_tonemap_command(app);
  add_compare_command(app);
  add_render_command(app);
  add_explore_command(app);

  try {
    app.parse(argc, argv);
    // What was asked for went to standard output: a full disk there is a failure too.
    if (!std::cout.flush()) throw Error("standard output cannot be written");
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == int(CLI::ExitCodes::Success)) return app.exit(e); // --help, --version
    std::cerr << "nacre: " << explain(app, e) << "\n";
    return exit_usage;
  } catch (const ExitStatus& e) {
    return e.status;
  } catch (const UsageError& e) {
    std::cerr << "nacre: " << e.what() << "\n";
    return exit_usage;
  } catch (const std::bad_alloc&) {
    std::cerr << "nacre: out of memory\n";
    return exit_failure;
  } catch (const std::exception& e) {
    std::cerr << "nacre: " << e.what() << "\n";
    return exit_failure;
  }
  return 0;
}
