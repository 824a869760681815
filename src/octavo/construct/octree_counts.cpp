// SPDX-License-Identifier: MIT
#include "octavo/construct/octree_counts.h"

namespace octavo {

Statistics statistics_of(int depth, const OctreeCounts& counts,
                         std::span<const std::uint64_t> begins,
                         std::span<const std::uint64_t> level_nodes) {
    Statistics total;
    total.voxels = counts.voxels;
    for (std::size_t l = 0; l < static_cast<std::size_t>(depth); ++l) {
        LevelStatistics level;
        level.level = static_cast<int>(l);
        level.svo_nodes = counts.cells[static_cast<std::size_t>(depth) - 1 - l];
        if (l < level_nodes.size()) {
            level.dag_nodes = level_nodes[l];
            level.bytes = (begins[l + 1] - begins[l]) * sizeof(std::uint32_t);
        }
        total.svo_nodes += level.svo_nodes;
        total.dag_nodes += level.dag_nodes;
        total.dag_bytes += level.bytes;
        total.levels.push_back(level);
    }
    return total;
}

}  // namespace octavo
