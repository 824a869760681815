// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace octavo {

/// How many voxels these words hold, where they are sound as find_faults says and have as many
/// nodes as stated; nothing where they are not. It says no more: find_faults says what is wrong.
///
/// @param level_begins  depth entries that cover the words in order, at least one word
/// @param level_nodes   of each of the depth - 1 levels; empty: any number
///
/// Cost: one pass over the words, parallel, and one look-up for each pointer in a table of at most
/// half the size of the level that it leads to. Record 26 says what bounds it.
[[nodiscard]] std::optional<std::uint64_t> voxels_if_sound(
    std::span<const std::uint64_t> level_begins, std::span<const std::uint32_t> words,
    std::span<const std::uint64_t> level_nodes);

}  // namespace octavo
