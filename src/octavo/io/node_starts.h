// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "octavo/io/check.h"

namespace octavo {

/// Words of one level, [begin, end).
struct LevelRange {
    std::uint64_t begin = 0;
    std::uint64_t end = 0;

    [[nodiscard]] std::uint64_t size() const { return end - begin; }
    [[nodiscard]] bool holds(std::uint64_t word) const { return word - begin < size(); }
};

/// Where the nodes of an interior level begin: one bit for each word, and how many begin before.
class NodeStarts {
public:
    static constexpr std::uint64_t kWords = 64;  // of the level, in a block
    struct Block {
        std::uint64_t bits = 0;
        std::uint64_t before = 0;
    };

    /// Walks through the level from node to node. Where one's size is not known, the rest is not.
    void scan(std::span<const std::uint32_t> words, const LevelRange& level,
              std::size_t max_faults);

    /// Whether a node begins at this word of the level.
    [[nodiscard]] bool contains(std::uint64_t word) const {
        const std::uint64_t at = word - begin_;
        return blocks_[at / kWords].bits >> at % kWords & 1u;
    }
    /// How many nodes of the level begin before this word.
    [[nodiscard]] std::uint64_t rank(std::uint64_t word) const {
        const std::uint64_t at = word - begin_;
        const Block& block = blocks_[at / kWords];
        const std::uint64_t below = (std::uint64_t{1} << at % kWords) - 1;
        return block.before + static_cast<unsigned>(std::popcount(block.bits & below));
    }
    /// Whether the walk came past this word.
    [[nodiscard]] bool known(std::uint64_t word) const { return word - begin_ < known_; }

    [[nodiscard]] std::uint64_t begin() const { return begin_; }
    [[nodiscard]] std::uint64_t count() const { return count_; }
    [[nodiscard]] std::span<const Block> blocks() const { return blocks_; }
    /// What is wrong with the masks that the walk has met.
    [[nodiscard]] std::vector<DagFault>& faults() { return faults_; }

    /// Calls visit(word, number) for each node that begins in these blocks.
    template <typename Visit>
    void for_each(std::uint64_t first_block, std::uint64_t last_block, const Visit& visit) const {
        for (std::uint64_t b = first_block; b < last_block; ++b) {
            std::uint64_t number = blocks_[b].before;
            for (std::uint64_t bits = blocks_[b].bits; bits != 0; bits &= bits - 1)
                visit(begin_ + b * kWords + static_cast<unsigned>(std::countr_zero(bits)),
                      number++);
        }
    }

private:
    /// @return whether the walk can go on behind this node
    bool accept_oddity(std::uint64_t at, std::uint32_t mask, std::uint64_t node, std::uint64_t size,
                       std::size_t max_faults);

    std::uint64_t begin_ = 0;
    std::uint64_t known_ = 0;
    std::uint64_t count_ = 0;
    std::vector<Block> blocks_;
    std::vector<DagFault> faults_;
};

}  // namespace octavo
