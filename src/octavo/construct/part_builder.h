// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include "octavo/construct/node_store.h"
#include "octavo/construct/part_file.h"
#include "octavo/construct/scratch.h"
#include "octavo/construct/tile_pipeline.h"

namespace octavo {

/// What a build may hold in memory, and name.
struct MemoryLimits {
    std::uint64_t max_resident_bytes = 0;  // of the whole process; 0: no cap
    std::uint64_t max_store_bytes = 0;     // of nodes held at once; 0: what the cap leaves
    WordLimits words = {};

    /// What a merge may take for the nodes of a level, now; 0: as much as it likes.
    [[nodiscard]] std::uint64_t room_to_merge() const;
};

/// Merges tiles into a store, and writes it out as a part when the memory is used up or the tiles
/// are not neighbours; and from time to time, so that what is done is not lost.
class PartBuilder {
public:
    /// @param scratch  for the parts; where it is not available, nothing is written
    PartBuilder(const VoxelSource& source, int depth, Scratch& scratch, const MemoryLimits& limits,
                std::chrono::milliseconds interval);

    /// Goes on with a part that was not closed.
    void resume(std::unique_ptr<PartFile> part);

    /// Tiles come in increasing order. @throws Error io; limit where the cap is passed and spilling
    /// would not help, or a level has 2^32 words
    void merge(const TilePart& tile);

    /// Writes out what came since the last time.
    void checkpoint();

    /// The same where something has failed already.
    void checkpoint_quietly() noexcept;

    /// Writes the store out, if it has a tile, and begins a new one.
    void close();

    /// The parts that have been closed since the last time, in order.
    [[nodiscard]] std::vector<std::unique_ptr<PartFile>> take_closed() {
        return std::move(closed_);
    }
    [[nodiscard]] bool has_closed() const { return !closed_.empty(); }

    // What is not closed.
    [[nodiscard]] NodeStore& store() { return store_; }
    [[nodiscard]] const PartState& state() const { return state_; }
    [[nodiscard]] std::vector<CellNode>& roots() { return roots_; }

    /// Of all tiles merged or resumed.
    [[nodiscard]] std::uint64_t voxels() const { return closed_voxels_ + state_.counts.voxels; }

private:
    [[nodiscard]] bool must_spill() const;
    void write(bool closed);

    const VoxelSource& source_;
    Scratch& scratch_;
    MemoryLimits limits_;
    std::chrono::milliseconds interval_;
    NodeStore store_;
    PartState state_;
    std::vector<CellNode> roots_;  // of the tiles in the store
    std::unique_ptr<PartFile> file_;
    std::chrono::steady_clock::time_point last_write_ = std::chrono::steady_clock::now();
    std::vector<std::unique_ptr<PartFile>> closed_;
    std::uint64_t closed_voxels_ = 0;
};

}  // namespace octavo
