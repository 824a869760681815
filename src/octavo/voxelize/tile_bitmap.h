// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/core/huge_pages.h"
#include "octavo/voxelize/voxel_source.h"

namespace octavo {

/// The voxels of one tile as a dense array of leaf masks, to be filled in any order and read out in
/// Morton order. On top lie bit sets of the blocks that are not empty, 64-fold coarser at each
/// step, so that reading out and clearing cost what the tile holds and not what it could hold.
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

    /// A window of 4x4x4 blocks whose codes follow each other, to set voxels of many of its blocks.
    class Window {
    public:
        /// @param first  code of the first block, a multiple of 64
        Window(TileBitmap& bitmap, std::uint32_t first)
            : bitmap_(bitmap), first_(first), blocks_(bitmap.blocks_.data() + first) {}
        ~Window() {
            if (set_ != 0) bitmap_.mark(first_ >> 6, set_);
        }
        Window(const Window&) = delete;
        Window& operator=(const Window&) = delete;

        /// Starts to fetch these blocks.
        void prefetch(std::uint64_t blocks) const {
            for (unsigned line = 0; line < 64; line += 8)
                if (blocks >> line & 255u) __builtin_prefetch(blocks_ + line, 1);
        }

        /// Sets voxels, or none, of a block.
        void add(unsigned block, std::uint64_t voxels) {
            blocks_[block] |= voxels;
            set_ |= std::uint64_t{voxels != 0} << block;
        }

    private:
        TileBitmap& bitmap_;
        std::uint32_t first_;
        std::uint64_t* blocks_;
        std::uint64_t set_ = 0;
    };

    /// Replaces `leaves` by the blocks that are not empty, in Morton order, and clears the tile.
    void take(std::vector<LeafBlock>& leaves);

private:
    void mark(std::uint32_t code) { mark(code >> 6, std::uint64_t{1} << (code & 63)); }

    /// Notes that these blocks of a window are not empty.
    void mark(std::uint32_t window, std::uint64_t blocks) {
        for (std::vector<std::uint64_t>& level : occupied_) {
            std::uint64_t& word = level[window];
            const bool was_empty = word == 0;
            word |= blocks;
            if (!was_empty) return;
            blocks = std::uint64_t{1} << (window & 63);
            window >>= 6;
        }
    }
    void take_below(std::size_t level, std::uint32_t word_index, std::vector<LeafBlock>& leaves);

    std::vector<std::uint64_t, HugePageAllocator<std::uint64_t>> blocks_;
    std::vector<std::vector<std::uint64_t>> occupied_;  // occupied_[0]: a bit for each block
};

}  // namespace octavo
