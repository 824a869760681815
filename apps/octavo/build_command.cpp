// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "build_estimate.h"
#include "commands.h"
#include "help.h"
#include "interrupt.h"
#include "machines.h"
#include "octavo/attributes/build_attributes.h"
#include "octavo/backend/device.h"
#include "octavo/construct/build.h"
#include "octavo/construct/estimate.h"
#include "octavo/construct/scratch.h"
#include "octavo/core/memory.h"
#include "octavo/core/parallel.h"
#include "octavo/io/octv.h"
#include "output.h"
#include "progress_meter.h"
#include "scene_input.h"
#include "summary.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo build scene.glb -o scene.octv --resolution 4K\n"
    "  octavo build scene.glb --resolution 128K --estimate\n"
    "  octavo build sample:courtyard -o courtyard.octv --resolution 1024 --compress\n"
    "  octavo build sample:city -o city.octv --resolution 32K --max-memory 2G\n"
    "  mpirun -n 4 octavo build scene.glb -o scene.octv --resolution 16K\n"
    "  octavo build scene.glb -o scene.octv --resolution 8K --attributes color,emission\n"
    "  octavo build tile.ply -o tile.octv --resolution 8K --origin 5.7e6,0,0 --voxel-size 0.01\n";

struct BuildArguments {
    std::string input;
    std::filesystem::path output;
    std::filesystem::path scratch;
    double journal_seconds = 5.0;
    BuildOptions options;
    std::string device = "cpu";
    std::optional<dvec3> origin;
    std::optional<double> voxel_size;
    std::string attribute_names;
    AttributeOptions attributes;
    int attribute_quality = 100;
    bool compress = false;
    bool estimate = false;
    bool force = false;
    bool quiet = false;
    bool json = false;
};

/// Seconds since the last call, or since it was made.
class Stopwatch {
public:
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - last_).count();
        last_ = now;
        return seconds;
    }

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

struct BuildTimes {
    double import_seconds = 0.0;
    double construct_seconds = 0.0;
    double attribute_seconds = 0.0;
    double write_seconds = 0.0;

    [[nodiscard]] double total() const {
        return import_seconds + construct_seconds + attribute_seconds + write_seconds;
    }
};

/// "color,emission,normal", in any order and number.
void choose_attributes(BuildArguments& arguments) {
    AttributeOptions& options = arguments.attributes;
    if (arguments.attribute_names.empty()) {
        if (options.level != 0 || arguments.attribute_quality != 100)
            throw Error(Errc::bad_argument,
                        "--attribute-resolution and --attribute-quality need --attributes");
        return;
    }
    options.color = options.emission = options.normal = false;
    std::string_view names = arguments.attribute_names;
    for (bool more = true; more;) {
        const std::size_t comma = names.find(',');
        const std::string_view name = names.substr(0, comma);
        if (name == "color")
            options.color = true;
        else if (name == "emission")
            options.emission = true;
        else if (name == "normal")
            options.normal = true;
        else
            throw Error(Errc::bad_argument, "--attributes: '" + std::string(name) +
                                                "' is not color, emission or normal");
        more = comma != std::string_view::npos;
        if (more) names.remove_prefix(comma + 1);
    }
    options.tolerance = (100 - arguments.attribute_quality + 1) / 2;
    options.threads = arguments.options.threads;
    options.max_memory_bytes = arguments.options.max_memory_bytes;
    options.scratch = arguments.options.scratch.parent_path();
    options.progress = arguments.options.progress;
    if (options.level > arguments.options.depth)
        throw Error(Errc::bad_argument,
                    "--attribute-resolution: it cannot be above the --resolution");
}

Scene import_scene(const std::string& input) {
    const EndAtOnce importing;
    return read_scene(input);
}

ProgressMeter::Style progress_style(const BuildArguments& arguments) {
    using Style = ProgressMeter::Style;
    return arguments.quiet ? Style::quiet : arguments.json ? Style::json : Style::people;
}

void print_warnings(const std::vector<std::string>& warnings, const BuildArguments& arguments) {
    if (arguments.quiet) return;
    for (const std::string& warning : warnings) fmt::print(stderr, "octavo: {}\n", warning);
}

std::string report_text(const BuildArguments& arguments, const OctvSummary& summary,
                        const BuildTimes& times, const Machines& machines) {
    if (arguments.json) {
        const int threads =
            arguments.options.threads > 0 ? arguments.options.threads : available_threads();
        Json json = summary_json(summary);
        json["build"] = {{"import_seconds", times.import_seconds},
                         {"construct_seconds", times.construct_seconds},
                         {"attribute_seconds", times.attribute_seconds},
                         {"write_seconds", times.write_seconds},
                         {"total_seconds", times.total()},
                         {"threads", threads},
                         {"peak_rss_bytes", peak_resident_bytes()},
                         {"ranks", machines.count()},
                         {"sent_bytes", machines.sent_bytes()}};
        return json.dump(2) + "\n";
    }
    return fmt::format(
        "{}\n  {:.2f} s: import {:.2f}, construct {:.2f}, {}write {:.2f}; at most {} MB\n",
        summary_table(summary), times.total(), times.import_seconds, times.construct_seconds,
        arguments.attribute_names.empty()
            ? ""
            : fmt::format("attributes {:.2f}, ", times.attribute_seconds),
        times.write_seconds, grouped(peak_resident_bytes() / 1'000'000));
}

std::string estimated_json(const Estimate& estimate) {
    Json json = {{"phase", "estimated"}, {"seconds_left", estimate.seconds}};
    json.update(estimate_json(estimate));
    return json.dump();
}

/// Null where none are.
const AttributeOptions* wanted_attributes(const BuildArguments& arguments) {
    return arguments.attribute_names.empty() ? nullptr : &arguments.attributes;
}

/// Says what a long build will take, and refuses one that the cap cannot hold.
void announce_estimate(const Scene& scene, BuildArguments& arguments, ProgressMeter& meter) {
    constexpr int kLongDepth = 13;  // a build that takes seconds needs no forecast
    const BuildOptions& options = arguments.options;
    const std::uint64_t cap = options.max_memory_bytes;
    if (cap == 0 && options.depth < kLongDepth) return;
    // A long forecast is not needed where the cap has been passed already.
    const std::uint64_t taken = peak_resident_bytes();
    if (cap != 0 && taken > cap && options.depth >= kLongDepth)
        throw Error(Errc::limit, fmt::format("reading the scene has taken {} MiB of memory, and {} "
                                             "are allowed: a larger --max-memory is needed",
                                             taken >> 20, cap >> 20));
    meter.begin_phase("estimate");
    const Estimate estimate = estimate_build(scene, options, wanted_attributes(arguments));
    meter.finish();
    const Room room = room_for(arguments.output, cap);
    if (!arguments.quiet)
        fmt::print(stderr, "{}\n",
                   arguments.json ? estimated_json(estimate) : estimate_line(estimate, room));
    require_words(estimate);
    require_memory(estimate, cap);
    if (const std::string what = shortage(estimate, room); !what.empty())
        print_warnings({what}, arguments);
    arguments.options.expected_nodes = estimate.level_nodes;
}

std::filesystem::path scratch_of(const BuildArguments& arguments) {
    const std::filesystem::path beside = std::filesystem::absolute(arguments.output).parent_path();
    std::filesystem::path scratch = arguments.scratch.empty() ? beside : arguments.scratch;
    scratch /= arguments.output.filename();
    scratch += ".scratch";
    return scratch;
}

/// What follows from the arguments before the scene is read.
void settle_options(BuildArguments& arguments) {
    BuildOptions& options = arguments.options;
    if (arguments.origin) {
        options.grid = Grid{.origin = *arguments.origin,
                            .voxel_size = *arguments.voxel_size,
                            .depth = options.depth};
        check_grid(*options.grid);
    }
    if (!arguments.estimate) options.scratch = scratch_of(arguments);
    options.keep_scratch = true;  // until the file is written
    options.journal_interval =
        std::chrono::milliseconds(std::llround(1000.0 * arguments.journal_seconds));
    options.reduce = reducer_on(arguments.device);
    choose_attributes(arguments);
}

void warn_of_no_area(const Metadata& of, const BuildArguments& arguments) {
    if (of.degenerate_triangles + of.non_finite_triangles == of.triangles)
        print_warnings({"no triangle has an area at this resolution: does a stray vertex make the "
                        "scene's box too large?"},
                       arguments);
}

/// In place of a build: what it would give and take, at this resolution and at lower ones.
void print_estimates(BuildArguments& arguments) {
    return_freed_memory();
    settle_options(arguments);
    BuildOptions options = arguments.options;
    ProgressMeter meter(progress_style(arguments));
    meter.begin_phase("import");
    Scene scene;
    with_threads(options.threads, [&] { scene = import_scene(arguments.input); });
    throw_if_interrupted();
    meter.finish();
    print_warnings(scene.warnings, arguments);

    if (!options.grid) options.grid = smallest_cube(scene.bounds(), options.depth);
    const EstimateRows rows = estimate_rows(scene, options, wanted_attributes(arguments), meter);
    const Room room =
        room_for(arguments.output.empty() ? "." : arguments.output, options.max_memory_bytes);
    if (!arguments.json) {
        print(rows_text(rows, room));
        return;
    }
    Json json = {{"source", source_name(arguments.input)},
                 {"triangles", scene.triangles.size()},
                 {"threads", options.threads > 0 ? options.threads : available_threads()}};
    json.update(rows_json(rows, room));
    print(json.dump(2) + "\n");
}

void build_file(BuildArguments& arguments, Machines& machines) {
    if (machines.is_first())
        check_output(arguments.output, arguments.force, {arguments.input});
    else
        arguments.quiet = true;
    return_freed_memory();
    settle_options(arguments);
    BuildOptions& options = arguments.options;
    ProgressMeter meter(progress_style(arguments));
    options.progress = meter.function();
    const bool with_attributes = !arguments.attribute_names.empty();
    BuildTimes times;
    Stopwatch watch;

    meter.begin_phase("import");
    Scene scene;
    with_threads(options.threads, [&] { scene = import_scene(arguments.input); });
    times.import_seconds = watch.lap();
    throw_if_interrupted();
    meter.finish();
    print_warnings(scene.warnings, arguments);
    if (!options.grid) options.grid = smallest_cube(scene.bounds(), options.depth);
    // Under a cap the surfaces go to disk first, so that the scene can be given back.
    std::optional<AttributeSource> surfaces;
    const auto read_surfaces = [&] {
        surfaces.emplace(scene, *options.grid, arguments.attributes);
        for (const std::string& warning : surfaces->warnings())
            if (!std::ranges::count(scene.warnings, warning)) print_warnings({warning}, arguments);
        times.attribute_seconds += watch.lap();
    };
    const bool capped = options.max_memory_bytes != 0;
    if (with_attributes && capped && machines.is_first()) read_surfaces();
    if (machines.is_first()) announce_estimate(scene, arguments, meter);
    watch.lap();
    BuildResult built = with_attributes && !capped ? machines.build(scene, options)
                                                   : machines.build_and_release(scene, options);
    if (!machines.is_first()) return;
    Model model = make_model(source_name(arguments.input), scene, options.rule, std::move(built));
    times.construct_seconds = watch.lap();
    warn_of_no_area(model.metadata, arguments);
    if (with_attributes) {
        if (!surfaces) read_surfaces();
        model.attributes = surfaces->average(model.dag);
        surfaces.reset();
        times.attribute_seconds += watch.lap();
    }
    scene = {};
    write_octv(arguments.output, model,
               {.compress = arguments.compress, .progress = meter.function()});
    delete_scratch(options.scratch);
    times.write_seconds = watch.lap();

    const OctvSummary summary = read_octv_summary(arguments.output);
    meter.finish();
    if (arguments.json || !arguments.quiet) print(report_text(arguments, summary, times, machines));
}

void run_build(BuildArguments& arguments) {
    Machines machines;
    machines.run([&] {
        if (!arguments.estimate)
            build_file(arguments, machines);
        else if (machines.is_first())
            print_estimates(arguments);
    });
}

void add_voxel_options(CLI::App& command, BuildArguments& arguments) {
    begin_group(command, "Voxels");
    add_rule(command, arguments.options.rule);
    CLI::Option* origin = add_parsed(command, "--origin", arguments.origin, parse_vec3,
                                     "World position of the grid's low corner", "X,Y,Z");
    CLI::Option* voxel_size =
        command.add_option("--voxel-size", arguments.voxel_size, "Side of a voxel in world units")
            ->type_name("S")
            ->check(above_zero());
    origin->needs(voxel_size);
    voxel_size->needs(origin);
}

void add_surface_options(CLI::App& command, BuildArguments& arguments) {
    begin_group(command, "Surfaces");
    command
        .add_option("--attributes", arguments.attribute_names,
                    "What to keep of the surfaces: color, emission, normal")
        ->type_name("NAMES");
    add_parsed(command, "--attribute-resolution", arguments.attributes.level, parse_resolution,
               "Cells along each side that have attributes; 1024, or N where that is less", "M");
    command
        .add_option("--attribute-quality", arguments.attribute_quality,
                    "100: lossless; else colours may be off by (100 - Q) / 2 of 255")
        ->type_name("Q")
        ->check(within(1, 100));
}

void add_work_options(CLI::App& command, BuildArguments& arguments) {
    begin_group(command, "Speed, memory and scratch");
    BuildOptions& options = arguments.options;
    add_threads(command, options.threads);
    command
        .add_option("--device", arguments.device,
                    "What reduces tiles to unique nodes: cpu (the default), cuda or cuda:N; the "
                    "file is the same")
        ->type_name("DEVICE");
    command.add_option("--tile", options.tile, "Voxels along a tile, a power of two; 0: chosen")
        ->type_name("N");
    add_parsed(command, "--max-memory", options.max_memory_bytes, parse_bytes,
               "Memory that the program may take, like 8G; what has no room spills to disk; 0: no "
               "limit",
               "SIZE");
    command
        .add_option("--scratch", arguments.scratch,
                    "Where to make the folder FILE.scratch, for what a stopped build goes on from "
                    "and what --max-memory leaves no room for; beside FILE")
        ->type_name("DIR")
        ->check(CLI::Validator(CLI::ExistingDirectory).description(""));
    command
        .add_option("--journal-seconds", arguments.journal_seconds,
                    "How long a build works between two writes of what it has done, 5")
        ->type_name("S")
        ->check(within(0.0, 1e6));
}

}  // namespace

void add_build_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand("build", "Turn a triangle scene into a voxel DAG");
    const auto arguments = std::make_shared<BuildArguments>();
    set_help(command, kExamples);
    command
        .add_option("IN", arguments->input,
                    "A scene: glTF, GLB, OBJ, PLY, STL and more; or sample:NAME, see octavo sample")
        ->required()
        ->type_name("");
    const CLI::Option* output =
        command.add_option("-o,--output", arguments->output, "The .octv file to write")
            ->type_name("FILE");
    add_parsed(command, "-r,--resolution", arguments->options.depth, parse_resolution,
               "Voxels along each side: a power of two from 4 to 128K", "N")
        ->required();
    command.add_flag("--estimate", arguments->estimate,
                     "Build nothing: print what this resolution and lower ones would give and "
                     "take, told from a sample of tiles");
    command.add_flag("--compress", arguments->compress,
                     "Compress the DAG: a smaller file that takes longer to open");
    command.add_flag("--json", arguments->json,
                     "Print the statistics as JSON, and progress as a line of JSON a second on "
                     "standard error: phase, seconds, done, total, voxels, seconds_left");
    add_force(command, arguments->force);
    add_quiet(command, arguments->quiet);
    add_voxel_options(command, *arguments);
    add_surface_options(command, *arguments);
    add_work_options(command, *arguments);
    command.callback([arguments, output] {
        if (!arguments->estimate && output->count() == 0) throw CLI::RequiredError("--output");
        run_build(*arguments);
    });
}

}  // namespace octavo::cli
