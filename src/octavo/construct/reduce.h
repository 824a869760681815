// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "octavo/construct/node_store.h"
#include "octavo/construct/octree_counts.h"
#include "octavo/construct/recent_parents.h"
#include "octavo/voxelize/voxel_source.h"

namespace octavo {

/// A cell of one level of a region, and the node that describes it.
struct CellNode {
    std::uint32_t code;  // Morton code of the cell among the region's cells of that level
    std::uint32_t node;  // id in the store, at that level's height
};

/// Replaces cells by their parents: groups each run of siblings into one node of the given height.
///
/// @param cells   of height - 1, in Morton order; becomes the cells of `height`, in Morton order
void reduce_level(NodeStore& store, int height, std::vector<CellNode>& cells);

/// The same from one height up to the store's top, counting the cells.
void reduce_upwards(NodeStore& store, int from_height, std::vector<CellNode>& cells,
                    OctreeCounts& counts);

/// Room for reduce_tile() to work in.
struct ReduceScratch {
    std::vector<std::uint32_t> nodes;  // of the cells of one level, in Morton order

    // Ids of leaves that came before, by the low bits of their hash: most come again soon.
    static constexpr std::size_t kRecent = 1024;
    std::array<std::uint64_t, kRecent> recent_leaves;
    std::array<std::uint32_t, kRecent> recent_ids;
    RecentParents recent_parents;
};

/// Adds a tile that is not empty to an empty store, and reduces it up to the store's top, level by
/// level ([K13] section 3).
void reduce_tile(NodeStore& store, const TileOctree& octree, ReduceScratch& scratch);

/// Adds the cells of a tile to those counted: of each height up to `top` that have voxels.
void count_cells(const TileOctree& octree, int top, OctreeCounts& counts);

/// Gives an empty store the nodes that reduce_tile() gives it, elsewhere: on a GPU. Called from
/// many threads.
using ReduceFunction = std::function<void(NodeStore& store, const TileOctree& octree)>;

}  // namespace octavo
