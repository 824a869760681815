// SPDX-License-Identifier: MIT
#include "octavo/construct/construct.h"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "octavo/construct/frozen_part.h"
#include "octavo/construct/merge_parts.h"
#include "octavo/construct/part_builder.h"
#include "octavo/construct/reduce.h"
#include "octavo/construct/tile_pipeline.h"

namespace octavo {
namespace {

/// The indices of the tiles that no part has; parts are in the order of their tiles.
std::vector<std::size_t> tiles_left(std::size_t tiles,
                                    std::span<const std::unique_ptr<PartFile>> parts) {
    std::vector<std::size_t> left;
    std::size_t next = 0;
    for (const auto& part : parts) {
        for (; next < part->state().first_tile; ++next) left.push_back(next);
        next = part->state().end_tile;
    }
    for (; next < tiles; ++next) left.push_back(next);
    return left;
}

/// The build in progress.
class Construction {
public:
    Construction(VoxelSource& source, int depth, const ConstructOptions& options, Scratch& scratch)
        : source_(source),
          depth_(depth),
          options_(options),
          limits_{options.max_memory_bytes, options.max_store_bytes, options.words},
          scratch_(scratch),
          builder_(source, depth, scratch, limits_, options.journal_interval) {
        // Under a cap a store may never come to hold them all.
        if (options.max_memory_bytes == 0 && options.max_store_bytes == 0)
            builder_.store().expect(options.expected_nodes);
    }

    void merge_all_tiles() {
        done_ = scratch_.take_parts();
        const std::vector<std::size_t> tiles = tiles_left(source_.tiles().size(), done_);
        std::uint64_t tiles_done = source_.tiles().size() - tiles.size();
        // What a killed build had in memory comes back there, to grow on.
        if (!done_.empty() && !done_.back()->closed()) {
            builder_.resume(std::move(done_.back()));
            done_.pop_back();
        }
        std::uint64_t voxels_done = 0;
        for (const auto& part : done_) voxels_done += part->state().counts.voxels;
        try {
            run_tiles(source_, tiles, options_.max_memory_bytes != 0, options_.reduce,
                      [&](const TilePart& tile) {
                          builder_.merge(tile);
                          source_.forget_before(tile.index + 1);
                          report(options_.progress,
                                 {"voxelize", ++tiles_done, source_.tiles().size(),
                                  voxels_done + builder_.voxels()});
                      });
        } catch (...) {
            // Whatever stopped us, what is done is not lost; unless it was the disk that failed.
            builder_.checkpoint_quietly();
            throw;
        }
    }

    [[nodiscard]] Constructed finish() {
        return done_.empty() && !builder_.has_closed() ? freeze_store() : merge_and_freeze();
    }

private:
    Constructed freeze_store() {
        NodeStore& store = builder_.store();
        OctreeCounts counts = builder_.state().counts;
        reduce_upwards(store, source_.tile_depth() - 1, builder_.roots(), counts);
        std::vector<std::uint64_t> level_nodes;
        for (int h = depth_ - 2; h >= 0; --h) level_nodes.push_back(store.level(h).count());
        Constructed result;
        result.dag = std::move(store).freeze(depth_);
        result.statistics = statistics_of(depth_, counts, result.dag.level_begins(), level_nodes);
        return result;
    }

    Constructed merge_and_freeze() {
        builder_.close();
        for (auto& part : builder_.take_closed()) done_.push_back(std::move(part));
        std::ranges::sort(done_, {}, [](const auto& part) { return part->state().first_tile; });
        const auto merged = merge_into_one(std::move(done_), scratch_, limits_, options_.progress);
        return freeze_part(*merged, depth_, scratch_.folder(), options_.progress, limits_.words);
    }

    VoxelSource& source_;
    int depth_;
    const ConstructOptions& options_;
    MemoryLimits limits_;
    Scratch& scratch_;
    PartBuilder builder_;
    std::vector<std::unique_ptr<PartFile>> done_;
};

}  // namespace

Constructed construct(VoxelSource& source, int depth, const ConstructOptions& options,
                      Scratch& scratch) {
    Construction construction(source, depth, options, scratch);
    construction.merge_all_tiles();
    return construction.finish();
}

}  // namespace octavo
