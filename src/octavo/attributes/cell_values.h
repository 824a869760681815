// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "octavo/core/mapped_words.h"
#include "octavo/dag/dag.h"

namespace octavo {

/// One value of up to 32 bits for each occupied cell, packed in blocks of 256 cells: the same words
/// in memory, in the file and on a GPU, with each value to be had at once.
///
///   word 0           bits of a value, 1 to 32
///   word 1           number of blocks, n
///   words 2 to n + 1 for each block the word where its data begins; 0: all its values are 0
///   data of a block  word 0: bits of an index, 0 to 8, and from bit 8 the number of colours in the
///                    palette, 1 to 256; or 255: no palette
///                    then, bit after bit from the lowest of each word: the palette and the
///                    indices; or the values themselves
///
/// Up to 2^32 words: 16 GiB.
class CellValues {
public:
    static constexpr int kBlockCells = 256;
    static constexpr std::uint32_t kHeaderWords = 2;
    static constexpr std::uint32_t kRaw = 255;
    static constexpr std::uint32_t kMaxPalette = 256;
    static constexpr std::uint64_t kMaxWords = std::uint64_t{1} << 32;

    /// Of no cells.
    CellValues() = default;

    /// @param words  as above, for `count` cells; trusted, see find_fault()
    /// @param owner  keeps the words alive
    CellValues(std::span<const std::uint32_t> words, std::uint64_t count,
               std::shared_ptr<const void> owner, Dag::Backing backing = Dag::Backing::memory)
        : words_(words), count_(count), owner_(std::move(owner)), backing_(backing) {}

    [[nodiscard]] std::uint64_t count() const { return count_; }
    [[nodiscard]] std::span<const std::uint32_t> words() const { return words_; }

    /// As Dag::release().
    void release(std::uint64_t first_word, std::uint64_t count) const {
        if (backing_ == Dag::Backing::mapped_file) release_pages(words_.subspan(first_word, count));
    }

    /// The value of a cell below count(). Cost: four loads.
    [[nodiscard]] std::uint32_t get(std::uint64_t cell) const {
        const std::uint32_t block = words_[kHeaderWords + cell / kBlockCells];
        if (block == 0) return 0;
        const auto in_block = static_cast<std::uint32_t>(cell % kBlockCells);
        const std::uint32_t value_bits = words_[0];
        const std::uint32_t form = words_[block];
        const std::uint32_t index_bits = form & 0xffu;
        if (index_bits == kRaw) return bits(block + 1, in_block * value_bits, value_bits);
        const std::uint32_t palette_bits = (form >> 8) * value_bits;
        const std::uint32_t index =
            bits(block + 1, palette_bits + in_block * index_bits, index_bits);
        return bits(block + 1, index * value_bits, value_bits);
    }

    /// What is wrong with words that are not trusted, and at which word; nothing where get() is
    /// safe for each of `count` cells. Cost: every block once.
    struct Fault {
        std::uint64_t word = 0;
        std::string reason;
    };
    [[nodiscard]] static std::optional<Fault> find_fault(std::span<const std::uint32_t> words,
                                                         std::uint64_t count, int value_bits);

private:
    /// `count` bits, 0 to 32, from a bit offset behind a word.
    [[nodiscard]] std::uint32_t bits(std::uint32_t word, std::uint32_t offset,
                                     std::uint32_t count) const {
        if (count == 0) return 0;
        const std::uint64_t at = std::uint64_t{word} + offset / 32;
        const std::uint32_t shift = offset % 32;
        std::uint64_t pair = words_[at];
        if (shift + count > 32) pair |= std::uint64_t{words_[at + 1]} << 32;
        return static_cast<std::uint32_t>(pair >> shift & ((std::uint64_t{1} << count) - 1));
    }

    std::span<const std::uint32_t> words_;
    std::uint64_t count_ = 0;
    std::shared_ptr<const void> owner_;
    Dag::Backing backing_ = Dag::Backing::memory;
};

}  // namespace octavo
