// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

/// What is done to every leaf, a 4x4x4 block with a bit for each voxel, by the widest SIMD
/// instructions that the machine has.
namespace octavo {

/// What some leaves hold together.
struct LeafCounts {
    std::uint64_t voxels = 0;
    std::uint64_t children = 0;  // 2x2x2 blocks, a leaf's bytes, that have a voxel
};

[[nodiscard]] LeafCounts count_leaves(std::span<const std::uint64_t> leaves);

/// Words after the last leaf that take_leaves() may write to.
inline constexpr std::size_t kTakeSlack = 8;

/// Moves leaves out of windows of 64, one after the other, and leaves zeros where they were.
///
/// @param windows  their numbers
/// @param leaves   64 for each window
/// @param set      which of a window's 64 there are; cleared too
/// @param out      with room for kTakeSlack more
void take_leaves(std::span<const std::uint32_t> windows, std::uint64_t* leaves, std::uint64_t* set,
                 std::uint64_t* out);

}  // namespace octavo
