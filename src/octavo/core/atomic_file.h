// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace octavo {

/// Where a file of this name would be written: its symbolic links are followed, also those that
/// lead to nothing yet. @throws Error io where they lead in a circle
[[nodiscard]] std::filesystem::path write_destination(const std::filesystem::path& file);

/// A file that appears whole or not at all. Bytes go to a temporary file in the destination's
/// folder; `commit` syncs it, renames it over the destination and syncs the folder. Without
/// `commit` the destructor removes the temporary, and whatever was at the destination is untouched.
///
/// A destination that is a symbolic link keeps being one: its target is replaced, or made.
class AtomicFile {
public:
    /// @throws Error io  where the folder cannot be written, or the destination is no regular file
    explicit AtomicFile(const std::filesystem::path& destination);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Writes at a byte offset; parts never written are zero.
    /// @throws Error io  as when the disk is full
    void write(std::uint64_t offset, std::span<const std::byte> bytes);

    /// Takes the room for a file of this many bytes beforehand, where the file system can.
    /// @throws Error io  where there is not so much room; says how much is needed
    void reserve(std::uint64_t size_bytes);

    /// Makes the file this long: cuts it off, or adds zeros. @throws Error io
    void resize(std::uint64_t size_bytes);

    /// Makes the file what is at the destination. Nothing may be written afterwards.
    /// @throws Error io  the destination is then as it was
    void commit();

private:
    std::filesystem::path shown_;  // as the caller named it, for messages
    std::filesystem::path destination_;
    std::filesystem::path temporary_;
    int descriptor_ = -1;
    std::uint64_t unsynced_bytes_ = 0;
};

}  // namespace octavo
