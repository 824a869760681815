// SPDX-License-Identifier: MIT
#include "octavo/construct/tile_pipeline.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <memory>
#include <vector>

namespace octavo {
namespace {

/// Makes one tile after the other, with tables that stay in a thread's cache.
class TileWorker {
public:
    explicit TileWorker(int top) : store_(top) {}

    void make(const VoxelSource& source, const ReduceFunction& reduce, TilePart& part) {
        source.voxelize(part.index, octree_);
        part.counts = {};
        part.empty = octree_.empty();
        if (part.empty) return;
        count_cells(octree_, store_.top(), part.counts);
        if (reduce) {
            reduce(store_, octree_);
        } else {
            reduce_tile(store_, octree_, scratch_);
        }
        part.store.take(store_);
    }

private:
    TileOctree octree_;
    ReduceScratch scratch_;
    NodeStore store_;
};

/// How many tiles are being made or wait to be merged at a time. More than there are workers, so
/// that while a merge takes long, as when a table grows, the others go on; what waits is small.
std::size_t tiles_in_flight(std::size_t workers, bool frugal) {
    return frugal ? workers + 1 + workers / 4 : 4 * workers + 24;
}

}  // namespace

void run_tiles(const VoxelSource& source, std::span<const std::size_t> tiles, bool frugal,
               const ReduceFunction& reduce, const std::function<void(const TilePart&)>& merge) {
    const int top = source.tile_depth() - 2;
    tbb::enumerable_thread_specific<TileWorker> workers([top] { return TileWorker(top); });

    // As tiles leave in order, a tile's place is free again when the one that many tiles later
    // comes. The places are owned here, because a pipeline that is stopped forgets what is in it.
    const std::size_t in_flight =
        tiles_in_flight(static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()), frugal);
    std::vector<std::unique_ptr<TilePart>> places;
    for (std::size_t i = 0; i < in_flight; ++i) places.push_back(std::make_unique<TilePart>(top));
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
        workers.local().make(source, reduce, *part);
        return part;
    };
    tbb::parallel_pipeline(
        in_flight, tbb::make_filter<void, TilePart*>(tbb::filter_mode::serial_in_order, feed) &
                       tbb::make_filter<TilePart*, TilePart*>(tbb::filter_mode::parallel, work) &
                       tbb::make_filter<TilePart*, void>(tbb::filter_mode::serial_in_order,
                                                         [&](TilePart* part) { merge(*part); }));
}

}  // namespace octavo
