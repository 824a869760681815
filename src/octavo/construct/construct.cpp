// SPDX-License-Identifier: MIT
#include "octavo/construct/construct.h"

#include <tbb/concurrent_queue.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <bit>
#include <memory>
#include <vector>

#include "octavo/construct/node_store.h"
#include "octavo/construct/reduce.h"
#include "octavo/core/memory.h"

namespace octavo {
namespace {

/// One tile on its way through the pipeline: its own small DAG, and room to make it in.
struct TilePart {
    explicit TilePart(int top) : store(top) {}

    NodeStore store;
    std::size_t index = 0;
    bool empty = false;
    std::uint64_t voxels = 0;
    std::vector<LeafBlock> leaves;
    std::vector<CellNode> cells;
};

void voxelize_and_reduce(const VoxelSource& source, TilePart& part) {
    source.voxelize(part.index, part.leaves);
    part.voxels = 0;
    for (const LeafBlock& leaf : part.leaves)
        part.voxels += static_cast<unsigned>(std::popcount(leaf.voxels));
    part.store.clear();
    part.empty = part.leaves.empty();
    if (!part.empty) reduce_leaves(part.store, part.leaves, part.cells);
}

void check_memory(std::uint64_t cap) {
    if (cap == 0) return;
    const std::uint64_t resident = resident_bytes();
    if (resident > cap)
        throw Error(Errc::limit, "the build needs more than the memory cap of " +
                                     std::to_string(cap >> 20) + " MiB: it holds " +
                                     std::to_string(resident >> 20) +
                                     " MiB; raise the cap or lower the resolution");
}

}  // namespace

Dag construct(const VoxelSource& source, int depth, const ConstructOptions& options) {
    const int tile_height = source.tile_depth() - 2;
    const std::vector<std::uint64_t>& tiles = source.tiles();
    NodeStore store(depth - 2);
    std::vector<CellNode> tile_roots;

    const auto workers = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    // Shared pointers, because a pipeline that is cancelled destroys what is in flight.
    using Part = std::shared_ptr<TilePart>;
    tbb::concurrent_queue<Part> idle;
    std::size_t next_tile = 0;
    std::uint64_t voxels = 0;

    const auto feed = [&](tbb::flow_control& control) -> Part {
        if (next_tile == tiles.size()) {
            control.stop();
            return nullptr;
        }
        Part part;
        if (!idle.try_pop(part)) part = std::make_shared<TilePart>(tile_height);
        part->index = next_tile++;
        return part;
    };
    const auto work = [&](const Part& part) {
        voxelize_and_reduce(source, *part);
        return part;
    };
    const auto merge = [&](const Part& part) {
        if (!part->empty) {
            const auto code = static_cast<std::uint32_t>(tiles[part->index]);
            tile_roots.push_back({code, store.merge_root(part->store)});
        }
        voxels += part->voxels;
        report(options.progress, {"voxelize", part->index + 1, tiles.size(), voxels});
        check_memory(options.max_memory_bytes);
        idle.push(part);
    };
    // More tiles in flight than workers, so that a slow tile does not leave the others waiting to merge.
    tbb::parallel_pipeline(
        4 * workers,
        tbb::make_filter<void, Part>(tbb::filter_mode::serial_in_order, feed) &
            tbb::make_filter<Part, Part>(tbb::filter_mode::parallel, work) &
            tbb::make_filter<Part, void>(tbb::filter_mode::serial_in_order, merge));

    for (int height = tile_height + 1; height <= depth - 2; ++height)
        reduce_level(store, height, tile_roots);
    return std::move(store).freeze(depth);
}

}  // namespace octavo
