#pragma once
// The commands of the command line. Each adds its options to the program and does its work in a callback;
// failures are exceptions that main prints.

#include <CLI/CLI.hpp>

namespace nacre {

void add_demo_command(CLI::App& app);
void add_materials_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_eval_command(CLI::App& app);
void add_plot_command(CLI::App& app);
void add_validate_command(CLI::App& app);
void add_bounces_command(CLI::App& app);
void add_tonemap_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_render_command(CLI::App& app);
void add_fit_command(CLI::App& app);
void add_convert_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_explore_command(CLI::App& app);

} // namespace nacre
