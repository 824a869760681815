// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "arguments.h"
#include "commands.h"
#include "help.h"
#include "light_choice.h"
#include "octavo/io/octv.h"
#include "octavo/light/light_cells.h"
#include "octavo/render/render.h"
#include "output.h"
#include "progress_meter.h"
#include "sky_arguments.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo light scene.octv --sun 325,62\n"
    "  octavo light scene.octv --sky evening.hdr:power=2 --bounces 4\n"
    "  octavo light scene.octv -o lit.octv --light none --sky none    # by what shines alone\n";

struct LightArguments {
    std::filesystem::path file;
    std::filesystem::path output;
    LightChoice choice;
    LightOptions options;
    bool compress = false;
    bool json = false;
    bool force = false;
    bool quiet = false;
};

void run_light(LightArguments& arguments) {
    const bool in_place = arguments.output.empty();
    const std::filesystem::path& output = in_place ? arguments.file : arguments.output;
    check_output(output, in_place || arguments.force);
    Model model = read_octv(arguments.file);
    if (model.attributes.empty())
        throw Error(Errc::bad_argument, arguments.file,
                    "it has no attributes to light; build it with --attributes");

    LitScene scene;
    scene.objects.push_back(
        {.dag = model.dag, .grid = model.grid(), .attributes = model.attributes});
    scene.lights =
        without_shining_cells(described_lights(arguments.choice, model), model.attributes);
    scene.sky = chosen_sky(arguments.choice);

    ProgressMeter meter(arguments.quiet);
    arguments.options.progress = meter.function();
    const auto start = std::chrono::steady_clock::now();
    const LightReport report = light_cells(scene, arguments.options);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    model.light = scene.objects[0].light;
    model.metadata.light = LightSummary{arguments.options.bounces, scene.lights,
                                        stored_sky(arguments.choice.sky.value_or("clear"), output)};
    write_octv(output, model, {.compress = arguments.compress, .progress = meter.function()});
    meter.finish();

    const auto bytes = model.light.words().size_bytes();
    if (arguments.json) {
        fmt::print("{}\n", nlohmann::json({{"cells", report.cells},
                                           {"sides", report.sides},
                                           {"rays", report.rays},
                                           {"light_seconds", seconds},
                                           {"light_bytes", bytes},
                                           {"bounces", arguments.options.bounces}})
                               .dump(2));
    } else if (!arguments.quiet) {
        fmt::print("cells    {:>14}   lit, with {} sides that can be seen\n", report.cells,
                   report.sides);
        fmt::print("rays     {:>14}   in {:.2f} s: {:.2f} million a second\n", report.rays, seconds,
                   static_cast<double>(report.rays) / seconds / 1e6);
        fmt::print("light    {:>14}   bytes, 24 for each cell\n", bytes);
    }
}

}  // namespace

void add_light_command(CLI::App& program) {
    CLI::App& command =
        *program.add_subcommand("light", "Find the light of the cells of an .octv file");
    const auto arguments = std::make_shared<LightArguments>();
    set_help(command, kExamples);
    command.add_option("FILE", arguments->file, "An .octv file with attributes")
        ->required()
        ->type_name("");
    command
        .add_option("-o,--output", arguments->output,
                    "The file to write; otherwise FILE gets the light")
        ->type_name("FILE");
    command.add_flag("--compress", arguments->compress, "Compress the file with zstd");
    command.add_flag("--json", arguments->json, "Report as JSON");
    add_force(command, arguments->force, "Replace the output where it exists");
    add_quiet(command, arguments->quiet);

    begin_group(command, "Light");
    add_light_choice(command, arguments->choice);
    command.add_option("--bounces", arguments->options.bounces, "How often light is sent on; 2")
        ->type_name("N")
        ->check(within(0, LightOptions::kMostBounces));

    begin_group(command, "Quality and speed");
    command
        .add_option(
            "--rays", arguments->options.around_rays,
            "Rays over the hemisphere of each side of a cell, for the sky and all bounces; 64")
        ->type_name("N")
        ->check(within(1, 65536));
    command
        .add_option("--shadow-samples", arguments->options.lamp_rays,
                    "Rays of each side of a cell towards each light; 16")
        ->type_name("N")
        ->check(within(1, 65536));
    add_threads(command, arguments->options.threads);
    command.callback([arguments] { run_light(*arguments); });
}

}  // namespace octavo::cli
