// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "octavo/core/grid.h"
#include "octavo/dag/statistics.h"

namespace octavo {

/// Cells of the octree that have been seen, although the octree never exists: counted as they are
/// reduced, which costs nothing, where counting the finished DAG takes another pass over it.
struct OctreeCounts {
    std::uint64_t voxels = 0;
    std::array<std::uint64_t, kMaxDepth> cells{};  // [i]: that are 2^(i + 1) voxels wide

    void add(const OctreeCounts& other) {
        voxels += other.voxels;
        for (std::size_t i = 0; i < cells.size(); ++i) cells[i] += other.cells[i];
    }

    /// Cells as wide as a node of this height.
    [[nodiscard]] std::uint64_t& at_height(int height) {
        return cells[static_cast<std::size_t>(height) + 1];
    }
};

/// What compute_statistics finds in the finished DAG, from what was counted on the way.
///
/// @param begins       of the levels, as Dag has them
/// @param level_nodes  stored in each of the depth - 1 levels, the root's first
[[nodiscard]] Statistics statistics_of(int depth, const OctreeCounts& counts,
                                       std::span<const std::uint64_t> begins,
                                       std::span<const std::uint64_t> level_nodes);

}  // namespace octavo
