// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "octavo/attributes/cell_values.h"
#include "octavo/core/spill_file.h"

namespace octavo {

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
