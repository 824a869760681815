// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "octavo/construct/estimate.h"
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

/// A row for each of the estimates.
[[nodiscard]] std::string estimate_table(std::span<const Estimate> estimates, const Room& room);

/// The keys are part of the interface.
[[nodiscard]] Json estimate_json(const Estimate& estimate);

}  // namespace octavo::cli
