// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "arguments.h"
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
    std::optional<std::string> name;
    std::filesystem::path output;
    double size = 1.0;
    bool force = false;
};

void run_sample(const SampleArguments& arguments) {
    if (!arguments.name) {
        if (!arguments.output.empty())
            throw Error(Errc::bad_argument, "which sample? octavo sample lists them");
        std::string text;
        for (const SampleInfo& sample : samples())
            text +=
                fmt::format("  {:<11}{:>8} triangles  {}\n", sample.name,
                            short_count(static_cast<double>(sample.triangles)), sample.description);
        print(text);
        return;
    }
    const bool known = std::ranges::count(samples(), *arguments.name, &SampleInfo::name) > 0;
    if (!known) (void)make_sample(*arguments.name);  // says which there are
    if (arguments.output.empty())
        throw Error(Errc::bad_argument, "-o FILE is missing; see octavo sample --help");
    if (!can_save_scene(arguments.output))
        throw Error(Errc::bad_argument, arguments.output,
                    "a scene's name ends in .glb, .obj or .ply");
    check_output(arguments.output, arguments.force);
    save_scene(make_sample(*arguments.name, arguments.size), arguments.output);
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
        ->check(above_zero());
    add_force(command, arguments->force);
    command.callback([arguments] { run_sample(*arguments); });
}

}  // namespace octavo::cli
