// SPDX-License-Identifier: MIT
#include "octavo/voxelize/tile_bitmap.h"

#include <bit>
#include <utility>

#include "octavo/voxelize/leaf_vectors.h"

namespace octavo {
namespace {

/// Calls visit(index) for each bit that is set, in order.
template <class Visit>
void for_each_bit(std::uint64_t bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1) visit(static_cast<unsigned>(std::countr_zero(bits)));
}

/// Bit i: whether byte i is not zero.
std::uint8_t bytes_set(std::uint64_t word) {
    constexpr std::uint64_t kLow = 0x7f7f7f7f7f7f7f7fu;
    const std::uint64_t high = (((word & kLow) + kLow) | word) & ~kLow;
    // Gathers the highest bit of each byte in the highest byte: no two of them meet on the way.
    return static_cast<std::uint8_t>((high >> 7) * 0x0102040810204080u >> 56);
}

}  // namespace

TileBitmap::TileBitmap(int tile_depth) : top_(tile_depth - 2) {
    const auto in_words = [](std::size_t bits) { return (bits + 63) / 64; };
    blocks_.resize(std::size_t{1} << 3 * top_);
    blocks_set_.resize(in_words(blocks_.size()));
    windows_set_.resize(in_words(blocks_set_.size()));
    std::size_t words = windows_set_.size();
    while (words > 1) coarser_set_.emplace_back(words = in_words(words));
}

/// Reads a tile out, from its root down.
struct TileBitmap::Taking {
    TileBitmap& bitmap;
    TileOctree& octree;
    std::vector<std::uint32_t> windows;  // not empty, in order

    /// The nodes of two heights that a word of bits stands for: its bytes, and itself.
    void add_nodes(std::uint64_t word, int height) {
        if (height + 1 <= bitmap.top_) octree.child_masks(height + 1).push_back(bytes_set(word));
        if (height <= bitmap.top_)
            for (std::uint64_t rest = word; rest != 0; rest >>= 8) {
                const int empty = std::countr_zero(rest) & ~7;
                rest >>= empty;
                octree.child_masks(height).push_back(static_cast<std::uint8_t>(rest));
            }
    }

    void take_window(std::uint32_t window) {
        add_nodes(bitmap.blocks_set_[window], 1);
        windows.push_back(window);
    }

    void take_windows(std::uint32_t index) {
        const std::uint64_t word = std::exchange(bitmap.windows_set_[index], 0);
        add_nodes(word, 3);
        for_each_bit(word, [&](unsigned bit) { take_window(index * 64 + bit); });
    }

    // The recursion is as deep as there are levels: two for a tile of 1024^3.
    void take_coarser(std::size_t level, std::uint32_t index) {
        const std::uint64_t word = std::exchange(bitmap.coarser_set_[level][index], 0);
        add_nodes(word, 2 * static_cast<int>(level) + 5);
        for_each_bit(word, [&](unsigned bit) {
            if (level == 0) {
                take_windows(index * 64 + bit);
            } else {
                take_coarser(level - 1, index * 64 + bit);
            }
        });
    }
};

void TileBitmap::take(TileOctree& octree) {
    for (std::vector<std::uint8_t>& masks : octree.masks) masks.clear();

    const std::vector<std::uint64_t>* finer = &windows_set_;
    for (std::vector<std::uint64_t>& level : coarser_set_) {
        for (std::size_t i = 0; i < finer->size(); ++i)
            level[i / 64] |= std::uint64_t{(*finer)[i] != 0} << (i % 64);
        finer = &level;
    }
    if (finer->front() == 0) return octree.leaves.clear();

    Taking taking{*this, octree, {}};
    if (coarser_set_.empty()) {
        taking.take_windows(0);
    } else {
        taking.take_coarser(coarser_set_.size() - 1, 0);
    }

    std::size_t count = 0;
    for (const std::uint32_t window : taking.windows)
        count += static_cast<unsigned>(std::popcount(blocks_set_[window]));
    octree.leaves.resize(count + kTakeSlack);
    take_leaves(taking.windows, blocks_.data(), blocks_set_.data(), octree.leaves.data());
    octree.leaves.resize(count);
}

}  // namespace octavo
