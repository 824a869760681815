// SPDX-License-Identifier: MIT
#include "octavo/construct/part_builder.h"

#include <algorithm>
#include <string>
#include <utility>

#include "octavo/core/error.h"
#include "octavo/core/memory.h"

namespace octavo {
namespace {

/// Kept free under the cap for what comes at once: tiles that are larger than those before,
/// buffers.
std::uint64_t reserve_below(std::uint64_t cap) {
    return std::clamp<std::uint64_t>(cap / 8, std::uint64_t{6} << 20, std::uint64_t{192} << 20);
}

}  // namespace

std::uint64_t MemoryLimits::room_to_merge() const {
    if (max_resident_bytes == 0) return max_store_bytes;
    const std::uint64_t taken = resident_bytes() + reserve_below(max_resident_bytes);
    return std::max<std::uint64_t>(1, max_resident_bytes > taken ? max_resident_bytes - taken : 0);
}

PartBuilder::PartBuilder(const VoxelSource& source, int depth, Scratch& scratch,
                         const MemoryLimits& limits, std::chrono::milliseconds interval)
    : source_(source),
      scratch_(scratch),
      limits_(limits),
      interval_(interval),
      store_(depth - 2, limits.words) {}

void PartBuilder::resume(std::unique_ptr<PartFile> part) {
    file_ = std::move(part);
    file_->restore(store_);
    state_ = file_->state();
    roots_ = file_->roots();
}

void PartBuilder::merge(const TilePart& tile) {
    if (tile.index != state_.end_tile) {
        close();
        state_.first_tile = tile.index;
    }
    if (!tile.empty) {
        const auto code = static_cast<std::uint32_t>(source_.tiles()[tile.index]);
        roots_.push_back({code, store_.merge_root(tile.store)});
        state_.counts.add(tile.counts);
    }
    state_.end_tile = tile.index + 1;

    if (must_spill()) {
        close();
    } else if (scratch_.available() &&
               std::chrono::steady_clock::now() - last_write_ >= interval_) {
        checkpoint();
    }
}

bool PartBuilder::must_spill() const {
    const std::uint64_t held = store_.memory_bytes();
    if (limits_.max_store_bytes != 0 && held >= limits_.max_store_bytes)
        return scratch_.available();
    const std::uint64_t cap = limits_.max_resident_bytes;
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

void PartBuilder::write(bool closed) {
    if (!file_) {
        scratch_.open();
        file_ = PartFile::create(part_path(scratch_.folder(), state_.first_tile), scratch_.key(),
                                 scratch_.top());
    }
    file_->append(store_, state_, roots_, closed);
    last_write_ = std::chrono::steady_clock::now();
}

void PartBuilder::checkpoint() {
    if (state_.end_tile == state_.first_tile) return;
    if (file_ && file_->state().end_tile == state_.end_tile) return;  // nothing new
    write(false);
}

void PartBuilder::checkpoint_quietly() noexcept {
    if (!scratch_.available()) return;
    try {
        checkpoint();
    } catch (const std::exception&) {  // the first error is the one to report
    }
}

void PartBuilder::close() {
    if (state_.end_tile == state_.first_tile) return;
    write(true);
    closed_voxels_ += state_.counts.voxels;
    closed_.push_back(std::move(file_));
    store_.reset();
    roots_ = {};
    state_ = {state_.end_tile, state_.end_tile, {}};
    trim_memory();
}

}  // namespace octavo
