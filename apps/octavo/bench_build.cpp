// SPDX-License-Identifier: MIT
#include "bench_build.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "help.h"
#include "interrupt.h"
#include "machine.h"
#include "octavo/construct/build.h"
#include "octavo/core/memory.h"
#include "octavo/core/parallel.h"
#include "octavo/dag/statistics.h"
#include "octavo/mesh/samples.h"
#include "output.h"
#include "progress_meter.h"
#include "scene_input.h"
#include "summary.h"

namespace octavo::cli {
namespace {

constexpr const char* kExamples =
    "  octavo bench build\n"
    "  octavo bench build sponza.glb sample:courtyard --resolutions 2K,4K,8K --repeat 5\n"
    "  octavo bench build --json > build.json; scripts/report build build.json\n";

struct BuildBenchArguments {
    std::vector<std::string> scenes;
    std::vector<std::string> resolutions = {"1K", "2K", "4K"};
    VoxelRule rule = VoxelRule::conservative;
    int repeat = 3;
    int threads = 0;
    bool json = false;
};

/// One scene at one resolution.
struct BuildRow {
    std::vector<double> seconds;  // of each run, sorted
    std::uint64_t peak_bytes = 0;
    Statistics statistics;
    int depth = 0;

    [[nodiscard]] double median() const {
        return (seconds[(seconds.size() - 1) / 2] + seconds[seconds.size() / 2]) / 2.0;
    }
    [[nodiscard]] double nanoseconds_per_svo_node() const {
        return 1e9 * median() /
               static_cast<double>(std::max<std::uint64_t>(statistics.svo_nodes, 1));
    }
};

struct SceneFigures {
    std::string name;
    std::uint64_t hash = 0;
    std::uint64_t triangles = 0;
    double import_seconds = 0.0;
    std::vector<BuildRow> rows;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

BuildRow measure(const Scene& scene, const BuildOptions& options, int repeat) {
    BuildRow row;
    row.depth = options.depth;
    trim_memory();  // what earlier builds gave back is not this one's
    restart_peak_resident();
    for (int run = 0; run < repeat; ++run) {
        const auto start = std::chrono::steady_clock::now();
        BuildResult result = build(scene, options);
        row.seconds.push_back(seconds_since(start));
        row.statistics = std::move(result.statistics);
    }
    row.peak_bytes = peak_resident_bytes();
    std::sort(row.seconds.begin(), row.seconds.end());
    return row;
}

SceneFigures measure_scene(const std::string& input, const BuildBenchArguments& arguments,
                           ProgressMeter& meter) {
    SceneFigures figures;
    figures.name = source_name(input);
    const auto start = std::chrono::steady_clock::now();
    const Scene scene = read_scene(input);
    figures.import_seconds = seconds_since(start);
    throw_if_interrupted();
    figures.hash = scene.geometry_hash();
    figures.triangles = scene.triangles.size();
    for (const std::string& resolution : arguments.resolutions) {
        BuildOptions options;
        options.depth = parse_resolution(resolution);
        options.rule = arguments.rule;
        options.threads = arguments.threads;
        options.progress = meter.function();
        figures.rows.push_back(measure(scene, options, arguments.repeat));
    }
    return figures;
}

Json row_json(const BuildRow& row) {
    const Statistics& s = row.statistics;
    return {{"resolution", 1u << row.depth},
            {"construct_seconds",
             {{"median", row.median()},
              {"least", row.seconds.front()},
              {"most", row.seconds.back()},
              {"runs", row.seconds}}},
            {"nanoseconds_per_svo_node", row.nanoseconds_per_svo_node()},
            {"peak_rss_bytes", row.peak_bytes},
            {"voxels", s.voxels},
            {"svo_nodes", s.svo_nodes},
            {"dag_nodes", s.dag_nodes},
            {"dag_bytes", s.dag_bytes},
            {"bits_per_voxel", s.bits_per_voxel()},
            {"pointerless_svo_bytes", s.pointerless_svo_bytes()},
            {"levels", levels_json(s)}};
}

Json figures_json(const std::vector<SceneFigures>& scenes, const BuildBenchArguments& arguments,
                  int threads) {
    Json out = {{"bench", "build"}};
    out.update(circumstances_json(threads));
    out["rule"] = name(arguments.rule);
    out["repeat"] = arguments.repeat;
    out["scenes"] = Json::array();
    for (const SceneFigures& scene : scenes) {
        Json rows = Json::array();
        for (const BuildRow& row : scene.rows) rows.push_back(row_json(row));
        out["scenes"].push_back({{"name", scene.name},
                                 {"hash", fmt::format("{:016x}", scene.hash)},
                                 {"triangles", scene.triangles},
                                 {"import_seconds", scene.import_seconds},
                                 {"rows", std::move(rows)}});
    }
    return out;
}

std::string table(const SceneFigures& scene) {
    std::string text = fmt::format(
        "{}, {} triangles, hash {:016x}, import {:.2f} s\n{:>6}{:>9}{:>16}{:>9}{:>10}"
        "{:>10}{:>10}{:>9}{:>10}{:>10}{:>10}\n",
        scene.name, short_count(static_cast<double>(scene.triangles)), scene.hash,
        scene.import_seconds, "N", "median", "least to most", "ns/node", "voxels", "SVO", "DAG",
        "bits/vox", "DAG MB", "SVO MB", "peak MB");
    for (const BuildRow& row : scene.rows) {
        const Statistics& s = row.statistics;
        const auto mb = [](std::uint64_t bytes) { return 1e-6 * static_cast<double>(bytes); };
        text += fmt::format(
            "{:>6}{:>7.2f} s{:>16}{:>9.1f}{:>10}{:>10}{:>10}{:>9.3f}{:>10.2f}"
            "{:>10.1f}{:>10.0f}\n",
            1u << row.depth, row.median(),
            fmt::format("{:.2f} to {:.2f}", row.seconds.front(), row.seconds.back()),
            row.nanoseconds_per_svo_node(), short_count(static_cast<double>(s.voxels)),
            short_count(static_cast<double>(s.svo_nodes)),
            short_count(static_cast<double>(s.dag_nodes)), s.bits_per_voxel(), mb(s.dag_bytes),
            mb(s.pointerless_svo_bytes()), mb(row.peak_bytes));
    }
    return text;
}

void run(const BuildBenchArguments& arguments) {
    return_freed_memory();  // as octavo build does
    std::vector<std::string> inputs = arguments.scenes;
    if (inputs.empty())
        for (const SampleInfo& sample : samples())
            inputs.push_back("sample:" + std::string(sample.name));
    for (const std::string& resolution : arguments.resolutions) (void)parse_resolution(resolution);
    const int threads = arguments.threads > 0 ? arguments.threads : available_threads();

    ProgressMeter meter(arguments.json || isatty(STDERR_FILENO) == 0);
    std::vector<SceneFigures> scenes;
    for (const std::string& input : inputs) {
        scenes.push_back(measure_scene(input, arguments, meter));
        meter.finish();
        if (!arguments.json) print(table(scenes.back()) + "\n");
    }
    if (arguments.json) print(figures_json(scenes, arguments, threads).dump(1) + "\n");
}

}  // namespace

void add_bench_build(CLI::App& bench) {
    CLI::App& command = *bench.add_subcommand(
        "build", "Seconds, nodes and bytes of building scenes at several resolutions");
    const auto arguments = std::make_shared<BuildBenchArguments>();
    set_help(command, kExamples);
    command
        .add_option("SCENE", arguments->scenes,
                    "Scene files, or sample:NAME; none: all built-in scenes")
        ->type_name("");
    command
        .add_option("--resolutions", arguments->resolutions,
                    "Voxels along each side, separated by commas; 1K,2K,4K")
        ->delimiter(',')
        ->type_name("N,...");
    add_rule(command, arguments->rule);
    command.add_option("--repeat", arguments->repeat, "Builds of each; their median is given; 3")
        ->type_name("N")
        ->check(within(1, 1000));
    add_threads(command, arguments->threads);
    command.add_flag("--json", arguments->json, "As JSON, with every run and every level");
    command.callback([arguments] { run(*arguments); });
}

}  // namespace octavo::cli
