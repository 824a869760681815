// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "octavo/construct/node_store.h"
#include "octavo/construct/reduce.h"

namespace octavo {

/// How far a construction has come: what must be known, beside the store, to go on.
struct ConstructState {
    std::uint64_t tiles_done = 0;
    std::uint64_t voxels = 0;
    std::vector<CellNode> tile_roots;
};

/// A file beside a long build from which the next one with the same arguments goes on, if this one
/// is killed. Tiles are merged in one order and every level of the store only grows at its end, so
/// what came since the last time is all that ever has to be written: a segment of new nodes, with a
/// checksum. A torn last segment is cut off when the file is read again.
///
/// Segments are in the byte order and for the version of the program that wrote them; another
/// program's journal is not continued but started anew. The file is locked while it is open.
class Journal {
public:
    /// Nothing is written, and no file made, before the first checkpoint.
    ///
    /// @param file  where; its folder exists
    /// @param key   of everything that decides the result and the order of tiles
    Journal(std::filesystem::path file, std::uint64_t key);
    ~Journal();
    Journal(const Journal&) = delete;
    Journal& operator=(const Journal&) = delete;

    /// Fills an empty store with what an earlier build left, if it had the same key.
    /// @throws Error io where the file is there and cannot be read, or is locked by another build
    void restore(NodeStore& store, ConstructState& state);

    /// Writes what is new, if the last time is `interval` ago. @throws Error io, as when the disk
    /// is full
    void checkpoint_if_due(const NodeStore& store, const ConstructState& state);
    void checkpoint(const NodeStore& store, const ConstructState& state);

    /// Deletes the file: its content has arrived.
    void remove();

    std::chrono::milliseconds interval{5000};

private:
    class File;

    void note_written(const NodeStore& store, const ConstructState& state);

    std::filesystem::path path_;
    std::uint64_t key_;
    std::unique_ptr<File> file_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
    std::vector<std::uint64_t> words_written_;  // of each level
    std::size_t roots_written_ = 0;
};

}  // namespace octavo
