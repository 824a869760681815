// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <exception>
#include <new>
#include <string>
#include <vector>

#include "commands.h"
#include "exit_code.h"
#include "help.h"
#include "octavo/core/error.h"
#include "octavo/core/version.h"
#include "output.h"

namespace octavo::cli {
namespace {

int fail(int code, const std::string& message) {
    fmt::print(stderr, "octavo: {}\n", one_line(message));
    return code;
}

constexpr const char* kExamples =
    "  octavo build scene.glb -o scene.octv --resolution 4K\n"
    "  octavo info scene.octv --levels\n"
    "  octavo view scene.octv\n"
    "  octavo render scene.octv -o scene.png\n"
    "  octavo sample courtyard -o courtyard.glb\n";

/// The first word that is neither a command nor an option where it stands, with what it is not;
/// empty where all are known.
std::string unknown_word(const CLI::App& command) {
    const std::vector<std::string> rest = command.remaining();
    if (rest.empty()) return "";
    const std::string& word = rest.front();
    if (word.size() > 1 && word.front() == '-') return fmt::format("there is no option '{}'", word);
    return command.get_subcommands([](const CLI::App*) { return true; }).empty()
               ? fmt::format("'{}' is one argument too many", word)
               : fmt::format("there is no command '{}'", word);
}

/// What to say to an error of the command line: the library misses what it wants before it looks
/// at what it does not know, so a misspelt option would read as one that is not there.
std::string usage_message(const CLI::App& program, const CLI::ParseError& error) {
    const bool may_be_misspelt = dynamic_cast<const CLI::RequiredError*>(&error) ||
                                 dynamic_cast<const CLI::RequiresError*>(&error) ||
                                 dynamic_cast<const CLI::ExtrasError*>(&error);
    std::string unknown;
    std::string path = "octavo";
    for (const CLI::App* command = &program; command != nullptr;) {
        if (may_be_misspelt && unknown.empty()) unknown = unknown_word(*command);
        const auto chosen = command->get_subcommands();
        command = chosen.empty() ? nullptr : chosen.front();
        if (command != nullptr) path += " " + command->get_name();
    }
    return fmt::format("{}; see {} --help", unknown.empty() ? error.what() : unknown, path);
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
    add_view_command(program);
    add_render_command(program);
    add_export_command(program);
    add_query_command(program);
    add_validate_command(program);
    add_sample_command(program);
    add_bench_command(program);
    add_devices_command(program);

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
        return fail(kUsage, usage_message(program, error));
    }
}

}  // namespace
}  // namespace octavo::cli

int main(int argc, char** argv) {
    using namespace octavo::cli;
    try {
        secure_standard_streams();
        report_full_disks();
        return run(argc, argv);
    } catch (const std::bad_alloc& error) {
        return fail(exit_code(error), "out of memory");
    } catch (const std::exception& error) {
        return fail(exit_code(error), error.what());
    }
}
