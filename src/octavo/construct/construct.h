// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "octavo/construct/reduce.h"
#include "octavo/construct/scratch.h"
#include "octavo/core/progress.h"
#include "octavo/dag/dag.h"
#include "octavo/dag/statistics.h"
#include "octavo/voxelize/voxel_source.h"

namespace octavo {

struct ConstructOptions {
    std::uint64_t max_memory_bytes = 0;         // resident, of the whole process; 0: no cap
    std::uint64_t max_store_bytes = 0;          // of nodes held at once; 0: what the cap leaves
    std::vector<std::uint64_t> expected_nodes;  // see BuildOptions
    ReduceFunction reduce;                      // of tiles; none: reduce_tile()
    ProgressFunction progress;  // phases "voxelize" in tiles, "merge", "freeze" in words

    std::chrono::milliseconds journal_interval{5000};  // between two writes of what is done
    WordLimits words = {};
};

struct Constructed {
    Dag dag;
    Statistics statistics;  // what compute_statistics(dag) would say
};

/// Builds the minimal DAG of a voxel source. Tiles are voxelized and reduced in parallel, by as
/// many threads as the calling oneTBB arena has, and merged one after the other in Morton order; so
/// nodes come to stand in the order in which the tree first meets them, whatever the tiles and the
/// threads. Where the nodes would pass the cap they are written out as a part, the next tiles start
/// another, and merge_parts joins them at the end.
///
/// Goes on from the parts that an earlier call left in the scratch folder.
///
/// @param source   forgets its tiles as they are merged
/// @param depth    of the grid that the source's tiles are cut from
/// @param scratch  where to keep what is done from time to time, so that a build which is killed
///                 can go on, and what the cap leaves no room for. Where it is not available, a
///                 cap that would be passed is an error
/// @throws Error io where the scratch cannot be read or written; limit where the memory cap or 2^32
///               words would be passed; cancelled
/// Source        [K13] section 3
[[nodiscard]] Constructed construct(VoxelSource& source, int depth, const ConstructOptions& options,
                                    Scratch& scratch);

}  // namespace octavo
