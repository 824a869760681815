// SPDX-License-Identifier: MIT
#include "bench_build.h"
#include "bench_picture.h"
#include "bench_trace.h"
#include "commands.h"
#include "help.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo bench build sample:courtyard --resolutions 1K,2K,4K\n"
    "  octavo bench trace scene.octv --mesh scene.glb --path fly.json --plot rays.svg\n"
    "  octavo bench picture scene.octv --device cuda --path fly.json\n";

}  // namespace

void add_bench_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("bench", "Measure how fast this machine is");
    set_help(command, kExamples);
    command.require_subcommand(1);
    add_bench_build(command);
    add_bench_trace(command);
    add_bench_picture(command);
}

}  // namespace octavo::cli
