// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "octavo/construct/node_store.h"
#include "octavo/construct/octree_counts.h"
#include "octavo/construct/reduce.h"
#include "octavo/core/spill_file.h"

namespace octavo {

/// What is known of a part of the scene beside its nodes: a run of tiles, one after the other.
struct PartState {
    std::uint64_t first_tile = 0;  // indices into the source's tiles
    std::uint64_t end_tile = 0;
    OctreeCounts counts;
};

/// The DAG of a run of tiles, on disk: what a capped build spills, from which a killed build goes
/// on, and what processes send each other.
///
/// Every level of a NodeStore only grows at its end, so what came since the last time is all that
/// ever has to be written: a segment of new nodes, with checksums. A torn last segment is cut off
/// when the file is opened again. A part that is closed will not grow any more.
///
/// In the byte order and for the version of the program that wrote it; files of another program or
/// another key are not opened.
class PartFile {
public:
    /// Makes an empty file.
    /// @param key  of everything that decides the result and the order of tiles
    /// @param top  the height of a tile's node
    static std::unique_ptr<PartFile> create(const std::filesystem::path& path, std::uint64_t key,
                                            int top,
                                            SpillFile::Kind kind = SpillFile::Kind::lasting);

    /// A file as it was left, as far as it is whole; null where it has another key or no segment.
    /// Reads all of it. @throws Error io
    static std::unique_ptr<PartFile> open(const std::filesystem::path& path, std::uint64_t key,
                                          int top);

    /// The same of a file that is open.
    static std::unique_ptr<PartFile> adopt(std::shared_ptr<SpillFile> file, std::uint64_t key,
                                           int top);

    /// Writes what store and state have beyond what the file has. @throws Error io, as when the
    /// disk is full; the file then holds what it held
    ///
    /// @param roots  of all tiles so far that are not empty; code: the tile's Morton code
    void append(const NodeStore& store, const PartState& state, std::span<const CellNode> roots,
                bool closed);

    /// The same level by level, for who has no store: for each height from 0 to top() begin_level,
    /// writes to the writer, end_level; then end_segment.
    WordWriter begin_level();
    void end_level(WordWriter& writer, std::uint64_t nodes);
    void end_segment(const PartState& state, std::span<const CellNode> roots, bool closed);

    /// Fills an empty store with the nodes. @throws Error bad_input where the file contradicts
    /// itself
    void restore(NodeStore& store) const;

    [[nodiscard]] int top() const { return top_; }
    [[nodiscard]] bool closed() const { return closed_; }
    [[nodiscard]] const PartState& state() const { return state_; }
    [[nodiscard]] std::uint64_t words(int height) const { return at(height).words; }
    [[nodiscard]] std::uint64_t nodes(int height) const { return at(height).nodes; }
    [[nodiscard]] std::uint64_t file_bytes() const { return end_; }
    [[nodiscard]] const SpillFile& file() const { return *file_; }

    [[nodiscard]] std::vector<CellNode> roots() const;

    /// The nodes of one level, as they stand in the store's words.
    [[nodiscard]] WordReader level(int height) const { return {*file_, at(height).pieces}; }

    /// Deletes the file.
    void remove();

private:
    struct Level {
        std::uint64_t words = 0, nodes = 0;
        std::vector<Extent> pieces;
    };
    struct Header;

    PartFile(std::shared_ptr<SpillFile> file, std::uint64_t key, int top);
    [[nodiscard]] const Level& at(int height) const {
        return levels_[static_cast<std::size_t>(height)];
    }
    bool read_segment(std::uint64_t file_size);

    std::shared_ptr<SpillFile> file_;
    std::uint64_t key_;
    int top_;
    bool closed_ = false;
    PartState state_;
    std::vector<Level> levels_;
    std::uint64_t root_count_ = 0;
    std::vector<Extent> root_pieces_;
    std::uint64_t end_ = 0;          // of the last whole segment
    std::vector<Level> new_levels_;  // of the segment being written
    std::uint64_t new_end_ = 0;
};

}  // namespace octavo
