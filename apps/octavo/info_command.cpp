// SPDX-License-Identifier: MIT
#include <filesystem>
#include <memory>

#include "commands.h"
#include "help.h"
#include "octavo/io/octv.h"
#include "output.h"
#include "summary.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo info scene.octv\n"
    "  octavo info scene.octv --levels\n"
    "  octavo info scene.octv --json\n";

struct InfoArguments {
    std::filesystem::path file;
    bool levels = false;
    bool json = false;
};

void run_info(const InfoArguments& arguments) {
    const OctvSummary summary = read_octv_summary(arguments.file);
    if (arguments.json) {
        print(summary_json(summary).dump(2) + "\n");
        return;
    }
    std::string text = summary_table(summary);
    if (arguments.levels) text += "\n" + level_table(summary.metadata.statistics);
    print(text);
}

}  // namespace

void add_info_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "info",
        "Say what an .octv file holds, by its header and metadata; validate checks the rest");
    const auto arguments = std::make_shared<InfoArguments>();
    set_help(command, kExamples);
    command.add_option("FILE", arguments->file, "An .octv file")->required()->type_name("");
    command.add_flag("--levels", arguments->levels, "Also a row for each level");
    command.add_flag("--json", arguments->json, "As JSON, levels included");
    command.callback([arguments] { run_info(*arguments); });
}

}  // namespace octavo::cli
