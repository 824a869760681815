// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <exception>
#include <new>
#include <string>

#include "commands.h"
#include "help.h"
#include "interrupt.h"
#include "octavo/core/error.h"
#include "octavo/core/version.h"
#include "output.h"

namespace octavo::cli {
namespace {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr int kBadInput = 3;
constexpr int kLimit = 4;

int exit_code(Errc code) {
    switch (code) {
        case Errc::bad_argument:
            return kUsage;
        case Errc::bad_input:
        case Errc::unsupported:
            return kBadInput;
        case Errc::limit:
            return kLimit;
        case Errc::cancelled:
            return interrupted_exit_code();
        case Errc::io:
            break;
    }
    return kFailed;
}

int fail(int code, const std::string& message) {
    fmt::print(stderr, "octavo: {}\n", message);
    return code;
}

constexpr const char* kExamples =
    "  octavo build scene.glb -o scene.octv --resolution 4K\n"
    "  octavo info scene.octv --levels\n"
    "  octavo render scene.octv -o scene.png\n"
    "  octavo sample courtyard -o courtyard.glb\n";

/// The subcommand that was being parsed, for "see octavo build --help".
std::string help_command(const CLI::App& program) {
    const auto chosen = program.get_subcommands();
    return chosen.empty() ? "octavo --help" : "octavo " + chosen.front()->get_name() + " --help";
}

int run(int argc, char** argv) {
    CLI::App program(
        "Sparse voxel DAGs: build them from triangle scenes, look into them, ray-trace them.",
        "octavo");
    set_help(program, kExamples);
    program.set_version_flag("--version", fmt::format("octavo {} ({})", kVersion, kCommit),
                             "Print the version and its commit");
    program.require_subcommand(1);
    add_build_command(program);
    add_info_command(program);
    add_light_command(program);
    add_render_command(program);
    add_query_command(program);
    add_sample_command(program);
    add_bench_command(program);

    try {
        program.parse(argc, argv);
        return kDone;
    } catch (const CLI::CallForHelp&) {
        const auto chosen = program.get_subcommands();
        print((chosen.empty() ? program : *chosen.front()).help());
        return kDone;
    } catch (const CLI::CallForVersion& version) {
        print(std::string(version.what()) + "\n");
        return kDone;
    } catch (const CLI::ParseError& error) {
        return fail(kUsage, fmt::format("{}; see {}", error.what(), help_command(program)));
    }
}

}  // namespace
}  // namespace octavo::cli

int main(int argc, char** argv) {
    using namespace octavo::cli;
    try {
        secure_standard_streams();
        return run(argc, argv);
    } catch (const octavo::Error& error) {
        return fail(exit_code(error.code()), error.what());
    } catch (const std::bad_alloc&) {
        return fail(kLimit, "out of memory");
    } catch (const std::exception& error) {
        return fail(kFailed, error.what());
    }
}
