// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "octavo/core/grid.h"
#include "octavo/dag/node.h"

namespace octavo {

/// A sparse voxel DAG: one frozen array of 32-bit words that is the same in memory, in the file and
/// on a GPU. See dag/node.h for what the words mean.
///
/// Levels are contiguous and in order: the root (level 0) is at word 0, then all nodes of level 1,
/// and so on; the leaves, level depth - 2, come last. A grid of depth 2 is a single leaf. Within a
/// level nodes stand in the order in which a depth-first walk of the tree first meets them, so
/// equal voxel sets have equal words (docs/adr/0003-node-order.md). A DAG without a voxel has no
/// words.
///
/// Up to 2^32 words: 16 GiB. Copies are cheap and share the words, which never change.
class Dag {
public:
    /// An empty grid of the least depth.
    Dag() = default;

    /// @param depth   kMinDepth to kMaxDepth
    /// @param levels  depth entries: levels[l] is the word index where level l begins (l = 0 to
    ///                depth - 2), and levels[depth - 1] is the number of words
    /// @param words   laid out as above; trusted, see io/ for reading what is not
    Dag(int depth, std::vector<std::uint64_t> levels, std::vector<std::uint32_t> words);

    /// Where words that live elsewhere are.
    enum class Backing { memory, mapped_file };

    /// The same over words that live elsewhere; `owner` keeps them alive.
    Dag(int depth, std::vector<std::uint64_t> levels, std::span<const std::uint32_t> words,
        std::shared_ptr<const void> owner, Backing backing = Backing::memory);

    [[nodiscard]] int depth() const { return depth_; }
    [[nodiscard]] std::uint32_t resolution() const { return 1u << depth_; }
    [[nodiscard]] int leaf_level() const { return depth_ - 2; }
    [[nodiscard]] bool empty() const { return words_.empty(); }

    [[nodiscard]] std::span<const std::uint32_t> words() const { return words_; }
    [[nodiscard]] std::uint64_t size_bytes() const { return words_.size_bytes(); }

    /// Word index where a level begins; level_begin(l + 1) is where level l ends. l = 0 to depth
    /// - 1.
    [[nodiscard]] std::uint64_t level_begin(int level) const { return levels_[level]; }
    [[nodiscard]] std::span<const std::uint64_t> level_begins() const { return levels_; }

    /// The 64 voxels of the leaf at this word index.
    [[nodiscard]] std::uint64_t leaf(std::uint64_t word) const {
        return words_[word] | std::uint64_t{words_[word + 1]} << 32;
    }

    /// Says that these words are not needed for a while: where they are a mapped file's, they take
    /// no memory until they are next looked at. Has no other effect.
    void release(std::uint64_t first_word, std::uint64_t count) const;

    /// Is this voxel set? Grid space; false outside the grid. Cost: one step per level.
    [[nodiscard]] bool voxel(const uvec3& voxel) const;

private:
    int depth_ = kMinDepth;
    std::vector<std::uint64_t> levels_ = {0, 0};
    std::span<const std::uint32_t> words_;
    std::shared_ptr<const void> owner_;
    Backing backing_ = Backing::memory;
};

}  // namespace octavo
