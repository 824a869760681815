// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/dag/dag.h"

namespace octavo {

/// What a level of the DAG holds. Levels 0 to depth - 2 are stored; level depth - 1 lives inside
/// the leaves, so it has octree nodes but no DAG nodes or bytes of its own.
struct LevelStatistics {
    int level = 0;
    std::uint64_t svo_nodes = 0;  // nodes with a child mask that the octree would have here
    std::uint64_t dag_nodes = 0;  // nodes stored; at level depth - 2, leaves
    std::uint64_t bytes = 0;
};

/// The figures of [K13] table 2 for one DAG, and what other structures would take for the same
/// voxels.
struct Statistics {
    std::uint64_t voxels = 0;
    std::uint64_t svo_nodes = 0;  // all levels, 0 to depth - 1, as [K13] counts them
    std::uint64_t dag_nodes = 0;  // interior nodes and 4x4x4 leaves
    std::uint64_t dag_bytes = 0;
    std::vector<LevelStatistics> levels;  // depth entries

    [[nodiscard]] double bits_per_voxel() const {
        return voxels == 0 ? 0.0
                           : 8.0 * static_cast<double>(dag_bytes) / static_cast<double>(voxels);
    }
    /// An octree without pointers: one byte for each child mask (Schnabel and Klein, in [K13]).
    [[nodiscard]] std::uint64_t pointerless_svo_bytes() const { return svo_nodes; }
    /// An octree whose voxels are nodes as well, at 48 or 32 bytes for each node ([J]).
    [[nodiscard]] std::uint64_t josh_svo_bytes(int bytes_per_node) const {
        return (svo_nodes + voxels) * static_cast<std::uint64_t>(bytes_per_node);
    }
};

/// Counts what a DAG holds. Visits every node once, bottom-up; never a path, so the cost is that of
/// the DAG and not of the octree it stands for. Counts are exact: 131072^3 voxels are 2^51.
[[nodiscard]] Statistics compute_statistics(const Dag& dag);

}  // namespace octavo
