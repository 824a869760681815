// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "octavo/construct/node_store.h"
#include "octavo/construct/octree_counts.h"
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

/// Room for reduce_leaves() to work in: the cells of one level, in Morton order.
struct ReduceScratch {
    std::vector<std::uint32_t> codes, nodes;  // as CellNode
    std::vector<std::uint8_t> child_masks;    // of the level above
};

/// Adds the leaves of a region to an empty store and reduces them up to the store's top, level by
/// level ([K13] section 3).
///
/// @param leaves  in Morton order, not empty; in a region as wide as a node of the store's top
///                height
/// @param counts  is added to
void reduce_leaves(NodeStore& store, const std::vector<LeafBlock>& leaves, ReduceScratch& scratch,
                   OctreeCounts& counts);

/// Counts what reduce_leaves() counts of the same leaves, for a ReduceFunction: the cells of each
/// height up to `top` that have voxels.
void count_cells(const std::vector<LeafBlock>& leaves, int top, OctreeCounts& counts);

/// Gives an empty store the nodes that reduce_leaves() gives it, elsewhere: on a GPU. Called from
/// many threads.
using ReduceFunction = std::function<void(NodeStore& store, const std::vector<LeafBlock>& leaves)>;

}  // namespace octavo
