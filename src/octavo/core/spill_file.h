// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace octavo {

/// A file that holds what has no room in memory. Reading and writing name their offset, so any
/// number of threads may read at once.
class SpillFile {
public:
    enum class Kind {
        temporary,  // has no name once it is open: it is gone when it is closed, even by a crash
        lasting,    // made empty
    };

    /// @throws Error io  where it cannot be made
    SpillFile(const std::filesystem::path& path, Kind kind);
    ~SpillFile();
    SpillFile(const SpillFile&) = delete;
    SpillFile& operator=(const SpillFile&) = delete;

    /// A lasting file as it was left, or null where there is none.
    [[nodiscard]] static std::shared_ptr<SpillFile> open(const std::filesystem::path& path);

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] int descriptor() const { return descriptor_; }
    [[nodiscard]] std::uint64_t size() const;

    /// @throws Error io  naming the file and what was to be written, as when the disk is full
    void write(std::uint64_t offset, const void* data, std::size_t size);

    /// False where the file ends before. @throws Error io
    [[nodiscard]] bool read(std::uint64_t offset, void* data, std::size_t size) const;

    /// Forgets everything from this byte on. @throws Error io
    void cut_at(std::uint64_t byte);

private:
    SpillFile(std::filesystem::path path, int descriptor);

    std::filesystem::path path_;
    int descriptor_ = -1;
};

/// Writes 32-bit words as a row of lz4 blocks, each with a checksum.
class WordWriter {
public:
    WordWriter(SpillFile& file, std::uint64_t offset) : file_(&file), offset_(offset) {}

    void put(const std::uint32_t* words, std::size_t count);
    void put(std::uint32_t word) { put(&word, 1); }

    /// Words put so far.
    [[nodiscard]] std::uint64_t count() const { return count_; }

    /// Ends the last block. @return the byte after it
    std::uint64_t finish();

private:
    void flush();

    SpillFile* file_;
    std::uint64_t offset_;
    std::uint64_t count_ = 0;
    std::vector<std::uint32_t> block_;
    std::vector<char> packed_;
};

/// Bytes of a file from one offset to another.
struct Extent {
    std::uint64_t begin = 0, end = 0;
};

/// Reads back what WordWriter wrote, in one or more pieces of a file one after the other.
class WordReader {
public:
    /// @param file  outlives this
    WordReader(const SpillFile& file, std::vector<Extent> pieces)
        : file_(&file), pieces_(std::move(pieces)) {}

    /// The words that come next: at least `count` of them, or all that are left.
    /// @throws Error  bad_input where a block is damaged; io
    std::span<const std::uint32_t> peek(std::size_t count) {
        if (words_.size() - head_ < count) fetch(count);
        return std::span(words_).subspan(head_);
    }
    void skip(std::size_t count) { head_ += count; }

    /// Fills exactly this; false where fewer words are left.
    [[nodiscard]] bool take(std::span<std::uint32_t> words);

private:
    void fetch(std::size_t count);

    const SpillFile* file_;
    std::vector<Extent> pieces_;
    std::size_t piece_ = 0;
    std::vector<std::uint32_t> words_;
    std::size_t head_ = 0;
};

/// Words in a full block.
inline constexpr std::size_t kSpillBlockWords = std::size_t{1} << 14;

/// Appends the words of the block at this byte. @return the byte after it
/// @throws Error  bad_input where it is damaged; io
std::uint64_t read_block(const SpillFile& file, std::uint64_t offset,
                         std::vector<std::uint32_t>& words);

/// Is there a row of whole blocks from one byte to the other? Reads it all.
[[nodiscard]] bool blocks_are_whole(const SpillFile& file, Extent extent);

}  // namespace octavo
