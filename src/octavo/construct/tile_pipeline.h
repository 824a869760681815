// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "octavo/construct/node_store.h"
#include "octavo/construct/octree_counts.h"
#include "octavo/construct/reduce.h"
#include "octavo/voxelize/voxel_source.h"

namespace octavo {

/// One tile that waits to be merged: its own small DAG, without the tables that found its nodes.
struct TilePart {
    explicit TilePart(int top) : store(top) {}

    NodeStore store;
    std::size_t index = 0;  // into the source's tiles
    bool empty = false;
    OctreeCounts counts;
};

/// Voxelizes and reduces tiles, as many at once as the calling oneTBB arena has threads, and hands
/// them over one after the other, in the order given.
///
/// @param frugal  fewer tiles in flight, where memory is scarce
/// @param reduce  of tiles; none: reduce_tile()
/// @param merge   called from one thread at a time; what it throws stops the pipeline
void run_tiles(const VoxelSource& source, std::span<const std::size_t> tiles, bool frugal,
               const ReduceFunction& reduce, const std::function<void(const TilePart&)>& merge);

}  // namespace octavo
