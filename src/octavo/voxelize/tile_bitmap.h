// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/core/huge_pages.h"
#include "octavo/core/prefetch.h"
#include "octavo/voxelize/tile_octree.h"

namespace octavo {

/// The voxels of one tile as a dense array of leaf masks, to be filled in any order and read out in
/// Morton order. On top lie bit sets of the blocks that are not empty, 64-fold coarser at each
/// step, so that reading out and clearing cost what the tile holds and not what it could hold.
/// Memory: one bit for each voxel of the tile, and 1/63 more.
class TileBitmap {
public:
    /// @param tile_depth  log2 of the tile's side in voxels, 2 to 10
    explicit TileBitmap(int tile_depth);

    [[nodiscard]] int tile_depth() const { return top_ + 2; }

    /// Sets voxels, or none, of the block with this Morton code.
    void set(std::uint32_t code, std::uint64_t voxels) {
        blocks_[code] |= voxels;
        mark(code >> 6, std::uint64_t{voxels != 0} << (code & 63));
    }

    /// A window of 4x4x4 blocks whose codes follow each other, to set voxels of many of its blocks.
    class Window {
    public:
        /// @param first  code of the first block, a multiple of 64
        Window(TileBitmap& bitmap, std::uint32_t first)
            : bitmap_(bitmap), first_(first), blocks_(bitmap.blocks_.data() + first) {}
        ~Window() { bitmap_.mark(first_ >> 6, set_); }
        Window(const Window&) = delete;
        Window& operator=(const Window&) = delete;

        /// Starts to fetch these blocks.
        void prefetch(std::uint64_t blocks) const {
            for (unsigned line = 0; line < 64; line += 8)
                if (blocks >> line & 255u) prefetch_line(blocks_ + line);
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

    /// Replaces `octree` by what has been set, and clears the tile.
    void take(TileOctree& octree);

private:
    /// Notes that these blocks of a window, or none, are not empty. Without a branch: whether they
    /// were is hard to foretell. So the two finest bit sets are kept at all times, and the others,
    /// which are small, are made from them when the tile is taken.
    void mark(std::uint32_t window, std::uint64_t blocks) {
        blocks_set_[window] |= blocks;
        windows_set_[window >> 6] |= std::uint64_t{blocks != 0} << (window & 63);
    }

    struct Taking;

    int top_;
    HugeVector<std::uint64_t> blocks_;
    std::vector<std::uint64_t> blocks_set_;                // a bit for each block
    std::vector<std::uint64_t> windows_set_;               // for each 64 of them
    std::vector<std::vector<std::uint64_t>> coarser_set_;  // for each 64^2, ..., one word at last
};

}  // namespace octavo
