// SPDX-License-Identifier: MIT
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string_view>

#include "octavo/core/atomic_file.h"

namespace octavo {

/// An AtomicFile that is written from front to back, through a buffer.
class OutputFile {
public:
    /// @throws Error io where it cannot be created
    explicit OutputFile(const std::filesystem::path& file);

    /// @throws Error io, here and below
    void write(const void* data, std::size_t size) {
        if (size > kCapacity - used_) return write_large(data, size);
        std::memcpy(buffer_.get() + used_, data, size);
        used_ += size;
    }
    void write(std::string_view text) { write(text.data(), text.size()); }

    template <class T>
    void write_raw(const T& value) {
        write(&value, sizeof value);
    }

    /// The shortest text that reads back as the same number.
    template <class T>
    void write_number(T value) {
        char text[32];
        const auto end = std::to_chars(text, text + sizeof text, value).ptr;
        write(text, static_cast<std::size_t>(end - text));
    }

    /// Puts the file in its place; without this, nothing is left of it.
    void commit();

private:
    static constexpr std::size_t kCapacity = 1 << 20;

    void write_large(const void* data, std::size_t size);
    void flush();

    AtomicFile file_;
    std::uint64_t size_bytes_ = 0;  // of the file so far, without the buffer
    std::unique_ptr<char[]> buffer_;
    std::size_t used_ = 0;
};

}  // namespace octavo
