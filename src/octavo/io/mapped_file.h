// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "octavo/core/input_file.h"

namespace octavo {

/// A page-aligned range of memory that unmaps itself.
class Mapping {
public:
    Mapping(void* address, std::size_t size) : address_(address), size_(size) {}
    ~Mapping();
    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;

    [[nodiscard]] std::span<const std::byte> bytes() const {
        return {static_cast<const std::byte*>(address_), size_};
    }
    [[nodiscard]] std::span<std::byte> writable_bytes() {
        return {static_cast<std::byte*>(address_), size_};
    }

private:
    void* address_;
    std::size_t size_;
};

/// Maps a file for reading, without a copy. A file that shrinks while it is mapped ends the process
/// with SIGBUS where the lost part is touched; AtomicFile never shrinks one, as it replaces the
/// whole.
/// @throws Error  as InputFile; io where it cannot be mapped
[[nodiscard]] std::shared_ptr<const Mapping> map_file(const std::filesystem::path& path);

/// Memory as long as a file, for a copy of it that nobody else can change or cut off. It is zero,
/// and takes up no room, but for the parts that have been fetched.
class FileCopy {
public:
    /// @throws Error  as InputFile
    explicit FileCopy(const std::filesystem::path& path);

    /// Reads a part of the file, and no more than there is; on all threads where it is large.
    /// @throws Error io  where the file has become shorter meanwhile, or cannot be read
    void fetch(std::uint64_t offset, std::uint64_t size);

    [[nodiscard]] std::span<const std::byte> bytes() const { return memory_->bytes(); }
    /// Keeps the memory alive.
    [[nodiscard]] std::shared_ptr<const Mapping> memory() const { return memory_; }

private:
    std::filesystem::path path_;
    InputFile file_;
    std::shared_ptr<Mapping> memory_;
};

/// Zeroed memory that takes up room only where it is written, so that a size which a file merely
/// claims costs nothing until the bytes exist. @throws Error limit where the system refuses
[[nodiscard]] std::shared_ptr<Mapping> allocate_mapping(std::uint64_t size_bytes);

}  // namespace octavo
