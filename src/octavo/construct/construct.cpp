// SPDX-License-Identifier: MIT
#include "octavo/construct/construct.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "octavo/construct/frozen_part.h"
#include "octavo/construct/merge_parts.h"
#include "octavo/construct/node_store.h"
#include "octavo/construct/reduce.h"
#include "octavo/construct/tile_pipeline.h"
#include "octavo/core/memory.h"

namespace octavo {
namespace {

/// Kept free under the cap for what comes at once: tiles that are larger than those before, buffers.
std::uint64_t reserve_below(std::uint64_t cap) {
    return std::clamp<std::uint64_t>(cap / 8, std::uint64_t{6} << 20, std::uint64_t{192} << 20);
}

/// The build in progress. `store_` holds the tiles since the last part was closed.
class Construction {
public:
    Construction(const VoxelSource& source, int depth, const ConstructOptions& options,
                 Scratch& scratch)
        : source_(source),
          depth_(depth),
          options_(options),
          scratch_(scratch),
          store_(depth - 2) {
        for (auto& part : scratch_.take_parts()) {
            done_voxels_ += part->state().counts.voxels;
            done_.push_back(std::move(part));
        }
        // What a killed build had in memory comes back there, to grow on.
        if (done_.empty() || done_.back()->closed()) return;
        file_ = std::move(done_.back());
        done_.pop_back();
        file_->restore(store_);
        state_ = file_->state();
        roots_ = file_->roots();
        done_voxels_ -= state_.counts.voxels;
    }

    void merge_all_tiles() {
        try {
            std::vector<std::size_t> tiles_left = this->tiles_left();
            merged_tiles_ = source_.tiles().size() - tiles_left.size();
            run_tiles(source_, tiles_left, options_.max_memory_bytes != 0,
                      [&](const TilePart& part) { merge_tile(part); });
        } catch (...) {
            // Whatever stopped us, what is done is not lost; unless it was the disk that failed.
            checkpoint_quietly();
            throw;
        }
    }

    [[nodiscard]] Constructed finish() {
        Constructed result = done_.empty() ? freeze_store() : merge_and_freeze();
        scratch_.remove();
        return result;
    }

private:
    [[nodiscard]] std::vector<std::size_t> tiles_left() const {
        std::vector<std::size_t> left;
        std::size_t next = 0;
        const auto fill_to = [&](std::size_t end) {
            for (; next < end; ++next)
                if (next < state_.first_tile || next >= state_.end_tile) left.push_back(next);
        };
        for (const auto& part : done_) {
            fill_to(part->state().first_tile);
            next = part->state().end_tile;
        }
        fill_to(source_.tiles().size());
        return left;
    }

    void merge_tile(const TilePart& part) {
        if (part.index != state_.end_tile) {
            // Tiles between are in a part already.
            if (state_.end_tile > state_.first_tile) close_part();
            state_.first_tile = part.index;
        }
        if (!part.empty) {
            const auto code = static_cast<std::uint32_t>(source_.tiles()[part.index]);
            roots_.push_back({code, store_.merge_root(part.store)});
            state_.counts.add(part.counts);
        }
        state_.end_tile = part.index + 1;
        ++merged_tiles_;

        const auto now = std::chrono::steady_clock::now();
        if (must_spill()) {
            close_part();
        } else if (scratch_.available() && now - last_checkpoint_ >= options_.journal_interval) {
            checkpoint(false);
        }
        report(options_.progress, {"voxelize", merged_tiles_, source_.tiles().size(),
                                   done_voxels_ + state_.counts.voxels});
    }

    /// @throws Error limit  where the cap is passed and spilling would not help
    [[nodiscard]] bool must_spill() const {
        const std::uint64_t held = store_.memory_bytes();
        if (options_.max_store_bytes != 0 && held >= options_.max_store_bytes)
            return scratch_.available();
        const std::uint64_t cap = options_.max_memory_bytes;
        if (cap == 0) return false;
        const std::uint64_t resident = resident_bytes();
        const std::uint64_t next = resident + store_.growth_bytes() + reserve_below(cap);
        if (next > cap && scratch_.available() && held >= cap / 32) return true;
        if (resident > cap)
            throw Error(Errc::limit, "the build needs more than the memory cap of " +
                                         std::to_string(cap >> 20) + " MiB: it holds " +
                                         std::to_string(resident >> 20) +
                                         " MiB; raise the cap or lower the resolution");
        return false;
    }

    void checkpoint(bool closed) {
        if (!file_) file_ = scratch_.make_part(state_.first_tile);
        if (!closed && file_->state().end_tile == state_.end_tile) return;  // nothing new
        file_->append(store_, state_, roots_, closed);
        last_checkpoint_ = std::chrono::steady_clock::now();
    }

    void checkpoint_quietly() noexcept {
        if (!scratch_.available() || state_.end_tile == state_.first_tile) return;
        try {
            checkpoint(false);
        } catch (const std::exception&) {  // the first error is the one to report
        }
    }

    /// Writes the store out and begins a new one.
    void close_part() {
        checkpoint(true);
        done_voxels_ += state_.counts.voxels;
        done_.push_back(std::move(file_));
        store_.reset();
        roots_ = {};
        state_ = {state_.end_tile, state_.end_tile, {}};
        trim_memory();
    }

    Constructed freeze_store() {
        reduce_upwards(store_, source_.tile_depth() - 1, roots_, state_.counts);
        std::vector<std::uint64_t> level_nodes;
        for (int h = depth_ - 2; h >= 0; --h) level_nodes.push_back(store_.level(h).count());
        Constructed result;
        result.dag = std::move(store_).freeze(depth_);
        result.statistics =
            statistics_of(depth_, state_.counts, result.dag.level_begins(), level_nodes);
        return result;
    }

    Constructed merge_and_freeze() {
        if (state_.end_tile > state_.first_tile) close_part();
        store_.reset();
        trim_memory();
        std::ranges::sort(done_, {}, [](const auto& part) { return part->state().first_tile; });
        std::unique_ptr<PartFile> merged;
        if (done_.size() > 1) {
            merged = scratch_.make_merged_part(0, source_.tiles().size());
            merge_parts(done_, *merged,
                        {.max_bytes = room_to_merge(),
                         .scratch = scratch_.folder(),
                         .progress = options_.progress});
            trim_memory();
        }
        return freeze_part(merged ? *merged : *done_.front(), depth_, scratch_.folder(),
                           options_.progress);
    }

    [[nodiscard]] std::uint64_t room_to_merge() const {
        const std::uint64_t cap = options_.max_memory_bytes;
        if (cap == 0) return options_.max_store_bytes;
        const std::uint64_t taken = resident_bytes() + reserve_below(cap);
        return std::max<std::uint64_t>(1, cap > taken ? cap - taken : 0);
    }

    const VoxelSource& source_;
    int depth_;
    const ConstructOptions& options_;
    Scratch& scratch_;
    NodeStore store_;
    PartState state_;
    std::vector<CellNode> roots_;  // of the tiles in the store
    std::unique_ptr<PartFile> file_;
    std::chrono::steady_clock::time_point last_checkpoint_ = std::chrono::steady_clock::now();
    std::vector<std::unique_ptr<PartFile>> done_;
    std::uint64_t done_voxels_ = 0;
    std::uint64_t merged_tiles_ = 0;
};

}  // namespace

Constructed construct(const VoxelSource& source, int depth, const ConstructOptions& options,
                      Scratch& scratch) {
    Construction construction(source, depth, options, scratch);
    construction.merge_all_tiles();
    return construction.finish();
}

}  // namespace octavo
