// SPDX-License-Identifier: MIT
#include "octavo/construct/tile_pipeline.h"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <memory>

namespace octavo {
namespace {

void voxelize_and_reduce(const VoxelSource& source, const ReduceFunction& reduce, TilePart& part) {
    source.voxelize(part.index, part.octree);
    part.counts = {};
    part.store.clear();
    part.empty = part.octree.empty();
    if (part.empty) return;
    count_cells(part.octree, part.store.top(), part.counts);
    if (reduce) return reduce(part.store, part.octree);
    reduce_tile(part.store, part.octree, part.scratch);
}

}  // namespace

void run_tiles(const VoxelSource& source, std::span<const std::size_t> tiles, bool frugal,
               const ReduceFunction& reduce, const std::function<void(const TilePart&)>& merge) {
    // More tiles in flight than workers, so that a slow tile does not leave the others waiting
    // to merge. As they leave in order, a tile's place is free again when the one that many
    // tiles later comes. The places are owned here, because a pipeline that is stopped forgets
    // what is in it.
    const auto workers = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    const std::size_t in_flight = frugal ? workers + 1 + workers / 4 : 4 * workers;
    std::vector<std::unique_ptr<TilePart>> places;
    for (std::size_t i = 0; i < in_flight; ++i)
        places.push_back(std::make_unique<TilePart>(source.tile_depth() - 2));
    std::size_t next = 0;

    const auto feed = [&](tbb::flow_control& control) -> TilePart* {
        if (next >= tiles.size()) {
            control.stop();
            return nullptr;
        }
        TilePart* part = places[next % in_flight].get();
        part->index = tiles[next++];
        return part;
    };
    const auto work = [&](TilePart* part) {
        voxelize_and_reduce(source, reduce, *part);
        return part;
    };
    tbb::parallel_pipeline(
        in_flight, tbb::make_filter<void, TilePart*>(tbb::filter_mode::serial_in_order, feed) &
                       tbb::make_filter<TilePart*, TilePart*>(tbb::filter_mode::parallel, work) &
                       tbb::make_filter<TilePart*, void>(tbb::filter_mode::serial_in_order,
                                                         [&](TilePart* part) { merge(*part); }));
}

}  // namespace octavo
