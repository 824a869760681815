// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/voxelize/voxel_source.h"

namespace octavo {

/// The voxels of one tile as a dense array of leaf masks, to be filled in any order and read out in
/// Morton order. On top lie bit sets of the blocks that are not empty, 64-fold coarser at each step, so
/// that reading out and clearing cost what the tile holds and not what it could hold.
/// Memory: one bit for each voxel of the tile, and 1/63 more.
class TileBitmap {
public:
    /// @param tile_depth  log2 of the tile's side in voxels, at least 2
    explicit TileBitmap(int tile_depth) {
        std::size_t count = std::size_t{1} << 3 * (tile_depth - 2);
        blocks_.resize(count);
        do {
            count = (count + 63) / 64;
            occupied_.emplace_back(count);
        } while (count > 1);
    }

    /// Sets voxels of the block with this Morton code. `voxels` is not zero.
    void set(std::uint32_t code, std::uint64_t voxels) {
        std::uint64_t& block = blocks_[code];
        if (block == 0) mark(code);
        block |= voxels;
    }

    /// Replaces `leaves` by the blocks that are not empty, in Morton order, and clears the tile.
    void take(std::vector<LeafBlock>& leaves);

private:
    void mark(std::uint32_t code) {
        for (std::vector<std::uint64_t>& level : occupied_) {
            std::uint64_t& word = level[code >> 6];
            const bool was_empty = word == 0;
            word |= std::uint64_t{1} << (code & 63);
            if (!was_empty) return;
            code >>= 6;
        }
    }
    void take_below(std::size_t level, std::uint32_t word_index, std::vector<LeafBlock>& leaves);

    std::vector<std::uint64_t> blocks_;
    std::vector<std::vector<std::uint64_t>> occupied_;  // occupied_[0]: a bit for each block
};

}  // namespace octavo
