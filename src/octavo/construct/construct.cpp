// SPDX-License-Identifier: MIT
#include "octavo/construct/construct.h"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <bit>
#include <memory>
#include <vector>

#include "octavo/construct/journal.h"
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

void voxelize_and_reduce(const VoxelSource& source, const ReduceFunction& reduce, TilePart& part) {
    source.voxelize(part.index, part.leaves);
    part.voxels = 0;
    for (const LeafBlock& leaf : part.leaves)
        part.voxels += static_cast<unsigned>(std::popcount(leaf.voxels));
    part.store.clear();
    part.empty = part.leaves.empty();
    if (part.empty) return;
    if (reduce)
        reduce(part.store, part.leaves);
    else
        reduce_leaves(part.store, part.leaves, part.cells);
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

/// The build in progress.
class Construction {
public:
    Construction(const VoxelSource& source, int depth, const ConstructOptions& options)
        : source_(source), depth_(depth), options_(options), store_(depth - 2) {
        if (options.journal.empty()) return;
        journal_ = std::make_unique<Journal>(options.journal, options.journal_key);
        journal_->interval = options.journal_interval;
        journal_->restore(store_, state_);
    }

    void merge_all_tiles() {
        try {
            run_pipeline();
        } catch (...) {
            // Whatever stopped us, what is done is not lost; unless it was the journal that failed.
            if (journal_) checkpoint_quietly();
            throw;
        }
    }

    [[nodiscard]] Dag finish() {
        std::vector<CellNode>& cells = state_.tile_roots;
        for (int height = source_.tile_depth() - 1; height <= depth_ - 2; ++height)
            reduce_level(store_, height, cells);
        Dag dag = std::move(store_).freeze(depth_);
        if (journal_) journal_->remove();
        return dag;
    }

private:
    void run_pipeline() {
        // More tiles in flight than workers, so that a slow tile does not leave the others waiting
        // to merge. As they leave in order, a tile's place is free again when the one that many
        // tiles later comes. The places are owned here, because a pipeline that is stopped forgets
        // what is in it.
        const std::size_t in_flight =
            4 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
        std::vector<std::unique_ptr<TilePart>> places;
        for (std::size_t i = 0; i < in_flight; ++i)
            places.push_back(std::make_unique<TilePart>(source_.tile_depth() - 2));
        std::size_t next_tile = state_.tiles_done;

        const auto feed = [&](tbb::flow_control& control) -> TilePart* {
            if (next_tile >= source_.tiles().size()) {
                control.stop();
                return nullptr;
            }
            TilePart* part = places[next_tile % in_flight].get();
            part->index = next_tile++;
            return part;
        };
        const auto work = [&](TilePart* part) {
            voxelize_and_reduce(source_, options_.reduce, *part);
            return part;
        };
        const auto merge = [&](TilePart* part) { merge_tile(*part); };
        tbb::parallel_pipeline(
            in_flight,
            tbb::make_filter<void, TilePart*>(tbb::filter_mode::serial_in_order, feed) &
                tbb::make_filter<TilePart*, TilePart*>(tbb::filter_mode::parallel, work) &
                tbb::make_filter<TilePart*, void>(tbb::filter_mode::serial_in_order, merge));
    }

    void merge_tile(const TilePart& part) {
        if (!part.empty) {
            const auto code = static_cast<std::uint32_t>(source_.tiles()[part.index]);
            state_.tile_roots.push_back({code, store_.merge_root(part.store)});
        }
        state_.tiles_done = part.index + 1;
        state_.voxels += part.voxels;
        if (journal_) journal_->checkpoint_if_due(store_, state_);
        report(options_.progress,
               {"voxelize", state_.tiles_done, source_.tiles().size(), state_.voxels});
        check_memory(options_.max_memory_bytes);
    }

    void checkpoint_quietly() noexcept {
        try {
            journal_->checkpoint(store_, state_);
        } catch (const std::exception&) {  // the first error is the one to report
        }
    }

    const VoxelSource& source_;
    int depth_;
    const ConstructOptions& options_;
    NodeStore store_;
    ConstructState state_;
    std::unique_ptr<Journal> journal_;
};

}  // namespace

Dag construct(const VoxelSource& source, int depth, const ConstructOptions& options) {
    Construction construction(source, depth, options);
    construction.merge_all_tiles();
    return construction.finish();
}

}  // namespace octavo
