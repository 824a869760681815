// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "octavo/core/mapped_words.h"
#include "octavo/core/spill_file.h"
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

/// Blocks on their way into a CellValues: packed already, to be put behind others.
struct PackedBlocks {
    std::vector<std::uint32_t> begins;  // into words, plus 1; 0: all values are 0
    std::vector<std::uint32_t> words;
};

/// Packs blocks, in the order of the cells.
///
/// Lossless where `tolerance` is 0. Else the three lowest bytes of a value may each differ by up to
/// that much, and what is above them does not differ: a value close enough to one of the palette
/// takes that one's place.
class BlockPacker {
public:
    BlockPacker(int value_bits, int tolerance) : value_bits_(value_bits), tolerance_(tolerance) {}

    [[nodiscard]] int value_bits() const { return value_bits_; }

    /// Appends one block of 1 to 256 values.
    void pack(std::span<const std::uint32_t> values, PackedBlocks& out);

private:
    /// Finds palette_ and indices_. @return false as soon as the values themselves take no more
    bool find_palette(std::span<const std::uint32_t> values);

    int value_bits_;
    int tolerance_;
    std::vector<std::uint32_t> palette_;
    std::vector<std::uint8_t> indices_;
};

/// Puts values together whose cells come in order: loose ones, and blocks that were packed by
/// others.
class CellValuesWriter {
public:
    CellValuesWriter(int value_bits, int tolerance) : packer_(value_bits, tolerance) {}

    /// Leaves room for the table, so that finish() need not put all words together once more.
    /// @param count  of cells, in all
    CellValuesWriter(int value_bits, int tolerance, std::uint64_t count)
        : packer_(value_bits, tolerance), data_begin_(data_begin_of(count)) {
        blocks_.words.resize(data_begin_);
    }

    /// Puts them into a temporary file, which is then mapped: memory holds the last
    /// 64 kB and 4 bytes for each 256 cells.
    /// @param count  of cells, in all
    CellValuesWriter(int value_bits, int tolerance, std::uint64_t count,
                     const std::filesystem::path& file)
        : packer_(value_bits, tolerance),
          file_(std::make_unique<SpillFile>(file, SpillFile::Kind::temporary)),
          data_begin_(data_begin_of(count)) {}

    /// Cells that wait for their block to be full: 0 to 255.
    [[nodiscard]] std::size_t pending() const { return pending_.size(); }

    void append(std::span<const std::uint32_t> values);
    /// Whole blocks; pending() is 0. @throws Error limit past 2^32 words; io
    void append(const PackedBlocks& blocks);

    /// All of it. The writer is consumed. @throws Error limit past 2^32 words; io
    [[nodiscard]] CellValues finish() &&;

    /// What it holds in memory.
    [[nodiscard]] std::uint64_t size_bytes() const {
        return (blocks_.begins.size() + blocks_.words.size()) * sizeof(std::uint32_t);
    }

private:
    static std::uint64_t data_begin_of(std::uint64_t count) {
        return CellValues::kHeaderWords +
               (count + CellValues::kBlockCells - 1) / CellValues::kBlockCells;
    }
    /// At the front of blocks_.words, room for what is before the data; in a file it is left there.
    [[nodiscard]] std::uint64_t head_words() const { return file_ ? 0 : data_begin_; }
    void check_room() const;
    void pack_pending();
    void put(const PackedBlocks& blocks);
    void spill();

    BlockPacker packer_;
    std::unique_ptr<SpillFile> file_;  // or none
    std::uint64_t data_begin_ = 0;     // where it is known: the word behind the table of blocks
    std::uint64_t spilled_ = 0;        // words of blocks in the file
    PackedBlocks blocks_;              // all begins, and the words that are not in the file
    PackedBlocks packed_;              // one block
    std::vector<std::uint32_t> pending_;
    std::uint64_t count_ = 0;
};

}  // namespace octavo
