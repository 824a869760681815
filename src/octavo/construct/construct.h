// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

#include "octavo/construct/reduce.h"
#include "octavo/core/progress.h"
#include "octavo/dag/dag.h"
#include "octavo/voxelize/voxel_source.h"

namespace octavo {

struct ConstructOptions {
    std::uint64_t max_memory_bytes = 0;  // resident, of the whole process; 0: no cap
    ReduceFunction reduce;               // of tiles; none: reduce_leaves()
    ProgressFunction progress;           // phase "voxelize", in tiles

    /// Where to keep what is done from time to time, so that a build which is killed can go on; see
    /// Journal. Empty: nowhere. Deleted when construct() returns; kept when it throws.
    std::filesystem::path journal;
    std::uint64_t journal_key = 0;  // of the source, its grid and its tiles
    std::chrono::milliseconds journal_interval{5000};
};

/// Builds the minimal DAG of a voxel source. Tiles are voxelized and reduced in parallel, by as
/// many threads as the calling oneTBB arena has, and merged one after the other in Morton order; so
/// nodes come to stand in the order in which the tree first meets them, whatever the tiles and the
/// threads.
///
/// @param depth  of the grid that the source's tiles are cut from
/// Goes on from a journal that an earlier call with the same key left.
///
/// @throws Error io where the journal cannot be read or written; limit where the memory cap or 2^32
/// words would be passed; cancelled Source        [K13] section 3
[[nodiscard]] Dag construct(const VoxelSource& source, int depth, const ConstructOptions& options);

}  // namespace octavo
