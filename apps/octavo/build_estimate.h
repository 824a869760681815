// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "octavo/construct/estimate.h"
#include "progress_meter.h"
#include "summary.h"

/// What `build` says of a build before it starts, and `build --estimate` in place of one.
namespace octavo::cli {

/// What a build may take of this machine.
struct Room {
    std::uint64_t memory_cap = 0;    // --max-memory; 0: none
    std::uint64_t memory_bytes = 0;  // free, and what this program has
    std::uint64_t disk_bytes = 0;    // free where the file is to be
};

/// @param output  the file that is to be written, or a folder
[[nodiscard]] Room room_for(const std::filesystem::path& output, std::uint64_t memory_cap);

/// One line, without its end.
[[nodiscard]] std::string estimate_line(const Estimate& estimate, const Room& room);

/// What is short, and what would help; empty where nothing is.
[[nodiscard]] std::string shortage(const Estimate& estimate, const Room& room);

/// The keys are part of the interface.
[[nodiscard]] Json estimate_json(const Estimate& estimate);

/// What a build would give and take, by resolution.
struct EstimateRows {
    std::vector<Estimate> estimates;             // the finest first
    std::vector<std::uint32_t> beyond_pointers;  // resolutions that no file can have
    double first_seconds = 0.0;                  // that the finest took
    double seconds = 0.0;                        // that all took
};

/// Estimates this build and coarser ones, down to 1024 or the attributes' own level.
///
/// @param options     have a grid, that of the finest row
/// @param attributes  or null
/// @throws Error      as estimate_build()
[[nodiscard]] EstimateRows estimate_rows(const Scene& scene, const BuildOptions& options,
                                         const AttributeOptions* attributes, ProgressMeter& meter);

/// A table for people.
[[nodiscard]] std::string rows_text(const EstimateRows& rows, const Room& room);
/// The keys are part of the interface.
[[nodiscard]] Json rows_json(const EstimateRows& rows, const Room& room);

}  // namespace octavo::cli
