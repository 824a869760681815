// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

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
/// @throws Error io  where it is missing, unreadable, or no regular file
[[nodiscard]] std::shared_ptr<const Mapping> map_file(const std::filesystem::path& path);

/// Reads a file into memory of its own, which nobody else can change afterwards.
/// @throws Error io  as map_file does
[[nodiscard]] std::shared_ptr<const Mapping> copy_file_to_memory(const std::filesystem::path& path);

/// Zeroed memory that takes up room only where it is written, so that a size which a file merely
/// claims costs nothing until the bytes exist. @throws Error limit where the system refuses
[[nodiscard]] std::shared_ptr<Mapping> allocate_mapping(std::uint64_t size_bytes);

}  // namespace octavo
