// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>

/// Each adds one subcommand to the program. Its callback does the work, writes data to standard
/// output and throws octavo::Error where it cannot.
namespace octavo::cli {

void add_bench_command(CLI::App& program);
void add_build_command(CLI::App& program);
void add_export_command(CLI::App& program);
void add_info_command(CLI::App& program);
void add_render_command(CLI::App& program);
void add_light_command(CLI::App& program);
void add_query_command(CLI::App& program);
void add_sample_command(CLI::App& program);
void add_validate_command(CLI::App& program);
void add_view_command(CLI::App& program);

}  // namespace octavo::cli
