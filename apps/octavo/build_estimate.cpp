// SPDX-License-Identifier: MIT
#include "build_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <system_error>

#include "octavo/core/memory.h"

namespace octavo::cli {
namespace {

std::string megabytes(std::uint64_t bytes) {
    return grouped((bytes + 500'000) / 1'000'000);
}

/// With three digits, or all of them.
std::string short_megabytes(std::uint64_t bytes) {
    const double mb = 1e-6 * static_cast<double>(bytes);
    return mb >= 100.0 ? megabytes(bytes) : fmt::format("{:.{}f}", mb, mb >= 10.0 ? 1 : 2);
}

bool spills(const Estimate& estimate, const Room& room) {
    return room.memory_cap != 0 && estimate.peak_bytes > room.memory_cap;
}

std::uint64_t disk_bytes(const Estimate& estimate, const Room& room) {
    return estimate.file_bytes().most + (spills(estimate, room) ? estimate.scratch_bytes : 0);
}

/// The last column of a row.
std::string remark(const Estimate& estimate, const Room& room) {
    if (room.memory_cap != 0 && estimate.least_bytes > room.memory_cap)
        return "more than --max-memory";
    if (room.memory_cap == 0 && estimate.peak_bytes > room.memory_bytes)
        return estimate.least_bytes > room.memory_bytes ? "more than the free memory"
                                                        : "needs --max-memory";
    if (disk_bytes(estimate, room) > room.disk_bytes) return "more than the free disk";
    return spills(estimate, room) ? "spills to disk" : "";
}

/// The grid with cells twice as wide, of which the scene takes the same part.
BuildOptions one_level_coarser(BuildOptions options) {
    --options.depth;
    --options.grid->depth;
    options.grid->voxel_size *= 2.0;
    return options;
}

bool next_is_beyond_pointers(const Estimate& estimate) {
    return beyond_pointers(static_cast<double>(estimate.dag_bytes.least) * estimate.growth);
}

std::string estimate_table(const std::vector<Estimate>& estimates, const Room& room) {
    std::string text = fmt::format("{:>8}{:>10}{:>11}{:>10}{:>20}{:>9}{:>9}{:>10}{:>10}\n", "N",
                                   "voxels", "DAG nodes", "file MB", "least to most", "seconds",
                                   "peak MB", "least MB", "spill MB");
    for (const Estimate& e : estimates) {
        const Between file = e.file_bytes();
        const std::string why = remark(e, room);
        text += fmt::format(
            "{:>8}{:>10}{:>11}{:>10}{:>20}{:>9.{}f}{:>9}{:>10}{:>10}{}{}\n",
            std::uint64_t{1} << e.depth, short_count(static_cast<double>(e.voxels.likely)),
            short_count(static_cast<double>(e.dag_nodes.likely)), short_megabytes(file.likely),
            short_megabytes(file.least) + " to " + short_megabytes(file.most), e.seconds,
            e.seconds < 10.0 ? 1 : 0, megabytes(e.peak_bytes), megabytes(e.least_bytes),
            megabytes(e.scratch_bytes), why.empty() ? "" : "  ", why);
    }
    return text;
}

}  // namespace

Room room_for(const std::filesystem::path& output, std::uint64_t memory_cap) {
    std::error_code error;
    const std::filesystem::path absolute = std::filesystem::absolute(output, error);
    const std::filesystem::path folder =
        std::filesystem::is_directory(absolute, error) ? absolute : absolute.parent_path();
    const std::filesystem::space_info space = std::filesystem::space(folder, error);
    return {.memory_cap = memory_cap,
            .memory_bytes = resident_bytes() + available_memory_bytes(),
            .disk_bytes = error ? ~std::uint64_t{0} : space.available};
}

std::string estimate_line(const Estimate& estimate, const Room& room) {
    std::string text =
        fmt::format("about {:.0f} s, at most {} MB of memory, a file of {} MB", estimate.seconds,
                    megabytes(estimate.peak_bytes), short_megabytes(estimate.file_bytes().likely));
    if (spills(estimate, room) && estimate.least_bytes <= room.memory_cap)
        text += fmt::format("; {} MB are allowed, and up to {} MB spill to disk",
                            megabytes(room.memory_cap), megabytes(estimate.scratch_bytes));
    return text;
}

std::string shortage(const Estimate& estimate, const Room& room) {
    if (room.memory_cap == 0 && estimate.peak_bytes > room.memory_bytes)
        return fmt::format("this build takes up to {} MB of memory, and {} MB are free: {}",
                           megabytes(estimate.peak_bytes), megabytes(room.memory_bytes),
                           estimate.least_bytes <= room.memory_bytes
                               ? fmt::format("--max-memory {}M would let the rest spill to disk",
                                             room.memory_bytes >> 20)
                               : "a lower resolution is needed, see --estimate");
    if (disk_bytes(estimate, room) > room.disk_bytes)
        return fmt::format("this build takes up to {} MB of disk, and {} MB are free",
                           megabytes(disk_bytes(estimate, room)), megabytes(room.disk_bytes));
    return {};
}

Json estimate_json(const Estimate& estimate) {
    const auto range = [](const Between& between) { return Json{between.least, between.most}; };
    return {{"resolution", std::uint64_t{1} << estimate.depth},
            {"seconds", estimate.seconds},
            {"voxels", estimate.voxels.likely},
            {"voxels_range", range(estimate.voxels)},
            {"dag_nodes", estimate.dag_nodes.likely},
            {"dag_nodes_range", range(estimate.dag_nodes)},
            {"dag_bytes", estimate.dag_bytes.likely},
            {"dag_bytes_range", range(estimate.dag_bytes)},
            {"attribute_bytes", estimate.attribute_bytes},
            {"file_bytes", estimate.file_bytes().likely},
            {"file_bytes_range", range(estimate.file_bytes())},
            {"peak_bytes", estimate.peak_bytes},
            {"least_bytes", estimate.least_bytes},
            {"scratch_bytes", estimate.scratch_bytes},
            {"sampled", estimate.sampled}};
}

EstimateRows estimate_rows(const Scene& scene, const BuildOptions& options,
                           const AttributeOptions* attributes, ProgressMeter& meter) {
    constexpr int kLeastDepth = 10;  // below this builds take little of anything
    const int least = std::max(kLeastDepth, attributes == nullptr ? 0 : attributes->level);
    // The coarsest first: what has been the most memory so far counts for all that come later.
    std::vector<BuildOptions> grids = {options};
    while (grids.back().depth > least) grids.push_back(one_level_coarser(grids.back()));
    EstimateRows rows;
    for (; !grids.empty(); grids.pop_back()) {
        BuildOptions& row = grids.back();
        // What cannot be built is not worth the minutes that a sample of it takes.
        if (!rows.estimates.empty() && next_is_beyond_pointers(rows.estimates.front())) {
            rows.beyond_pointers.push_back(1u << row.depth);
            continue;
        }
        const std::string phase = fmt::format("estimate {}", 1u << row.depth);
        meter.begin_phase(phase);
        row.progress = [&phase, show = meter.function()](const Progress& progress) {
            Progress of_row = progress;
            of_row.phase = phase;
            return show(of_row);
        };
        const auto start = std::chrono::steady_clock::now();
        rows.estimates.insert(rows.estimates.begin(), estimate_build(scene, row, attributes));
        rows.first_seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        rows.seconds += rows.first_seconds;
    }
    meter.finish();
    return rows;
}

std::string rows_text(const EstimateRows& rows, const Room& room) {
    std::string text = estimate_table(rows.estimates, room);
    if (!rows.beyond_pointers.empty())
        text += fmt::format("{}: more nodes than the pointers of a file can name\n",
                            fmt::join(rows.beyond_pointers, ", "));
    return text + fmt::format(
                      "\nFrom {:.2g} % of the tiles of the first row, in {:.2f} s, all rows in "
                      "{:.2f} s.\npeak: at most, without --max-memory; least: the least "
                      "--max-memory; spill: at most, on disk.\n",
                      100.0 * rows.estimates.front().sampled, rows.first_seconds, rows.seconds);
}

Json rows_json(const EstimateRows& rows, const Room& room) {
    Json json = {{"estimate_seconds", rows.seconds},
                 {"free_memory_bytes", room.memory_bytes},
                 {"free_disk_bytes", room.disk_bytes},
                 {"estimates", Json::array()},
                 {"beyond_pointers", rows.beyond_pointers}};
    for (const Estimate& estimate : rows.estimates)
        json["estimates"].push_back(estimate_json(estimate));
    return json;
}

}  // namespace octavo::cli
