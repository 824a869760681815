// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands.h"
#include "help.h"
#include "octavo/io/validate.h"
#include "output.h"
#include "summary.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo validate scene.octv\n"
    "  octavo validate scene.octv --strict --json\n";

struct ValidateArguments {
    std::filesystem::path file;
    ValidateOptions options;
    bool json = false;
};

/// Of all the time that reading the file takes, the part in which its nodes and counts are checked.
double share_of_reading(const OctvReadTimes& times) {
    const double all = times.read + times.checksum + times.decompress + times.validate;
    return all > 0.0 ? times.validate / all : 0.0;
}

std::string findings_json(const ValidateArguments& arguments, const Validation& validation) {
    Json findings = Json::array();
    for (const Finding& finding : validation.findings)
        findings.push_back({{"code", finding.code},
                            {"offset", finding.offset ? Json(*finding.offset) : Json()},
                            {"message", finding.message}});
    const OctvReadTimes& times = validation.times;
    const Json json = {{"file", arguments.file.string()},
                       {"valid", validation.valid()},
                       {"strict", arguments.options.strict},
                       {"file_bytes", validation.file_bytes},
                       {"findings", std::move(findings)},
                       {"seconds",
                        {{"read", times.read},
                         {"checksum", times.checksum},
                         {"decompress", times.decompress},
                         {"validate", times.validate},
                         {"extra", validation.extra_seconds}}},
                       {"validate_share_of_reading", share_of_reading(times)}};
    // File names may be any bytes.
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string findings_text(const ValidateArguments& arguments, const Validation& validation) {
    std::string text;
    for (const Finding& finding : validation.findings)
        text += fmt::format("{}  {}  {}\n",
                            finding.offset ? fmt::format("{:#010x}", *finding.offset) : "-",
                            finding.code, finding.message);
    if (validation.valid()) {
        const OctvReadTimes& times = validation.times;
        text += fmt::format(
            "valid{}: {} voxels, {} nodes; {:.3f} s read, {:.3f} checksum, {:.3f} decompress, "
            "{:.3f} nodes and counts ({:.0f} % of reading)\n",
            arguments.options.strict ? ", strictly" : "", grouped(validation.statistics.voxels),
            grouped(validation.statistics.dag_nodes), times.read, times.checksum, times.decompress,
            times.validate, 100.0 * share_of_reading(times));
    }
    return text;
}

void run_validate(const ValidateArguments& arguments) {
    const Validation validation = validate_octv(arguments.file, arguments.options);
    print(arguments.json ? findings_json(arguments, validation)
                         : findings_text(arguments, validation));
    if (validation.valid()) return;
    const std::size_t count = validation.findings.size();
    const bool more = count == arguments.options.max_findings;
    throw Error(
        Errc::bad_input, arguments.file,
        fmt::format("{}{} finding{}", more ? "at least " : "", count, count == 1 ? "" : "s"));
}

}  // namespace

void add_validate_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("validate", "Say what is wrong with an .octv file, if anything");
    const auto arguments = std::make_shared<ValidateArguments>();
    set_help(command, kExamples);
    command.add_option("FILE", arguments->file, "An .octv file")->required()->type_name("");
    command.add_flag("--strict", arguments->options.strict,
                     "Also what harms nothing: equal or unused nodes, another order, padding");
    command.add_flag("--json", arguments->json, "Findings and seconds as JSON");
    command.callback([arguments] { run_validate(*arguments); });
}

}  // namespace octavo::cli
