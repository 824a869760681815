// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "commands.h"
#include "help.h"
#include "octavo/core/error.h"
#include "octavo/mesh/samples.h"
#include "octavo/mesh/save.h"
#include "output.h"
#include "summary.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo sample\n"
    "  octavo sample courtyard -o courtyard.glb\n"
    "  octavo sample hairball -o hairball.ply --size 0.1\n";

struct SampleArguments {
    std::string name;
    std::filesystem::path output;
    double size = 1.0;
    bool force = false;
};

void run_sample(const SampleArguments& arguments) {
    if (arguments.name.empty()) {
        std::string text;
        for (const SampleInfo& sample : samples())
            text +=
                fmt::format("  {:<11}{:>8} triangles  {}\n", sample.name,
                            short_count(static_cast<double>(sample.triangles)), sample.description);
        print(text);
        return;
    }
    if (arguments.output.empty())
        throw Error(Errc::bad_argument, "-o FILE is missing; see octavo sample --help");
    check_output(arguments.output, arguments.force);
    save_scene(make_sample(arguments.name, arguments.size), arguments.output);
}

}  // namespace

void add_sample_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "sample", "Write a built-in scene to a file; without a name, list them");
    const auto arguments = std::make_shared<SampleArguments>();
    set_help(command, kExamples);
    command.add_option("NAME", arguments->name, "The scene")->type_name("");
    command.add_option("-o,--output", arguments->output, "The file to write: .glb, .obj or .ply")
        ->type_name("FILE");
    command
        .add_option("--size", arguments->size, "How much of it: triangles grow with this factor")
        ->type_name("F")
        ->check(CLI::Validator(CLI::PositiveNumber).description(""));
    command.add_flag("-f,--force", arguments->force, "Replace the file where it exists");
    command.callback([arguments] { run_sample(*arguments); });
}

}  // namespace octavo::cli
