// SPDX-License-Identifier: MIT
#include "build_estimate.h"

#include <fmt/format.h>

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

std::string estimate_table(std::span<const Estimate> estimates, const Room& room) {
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

}  // namespace octavo::cli
