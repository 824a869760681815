// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "octavo/core/error.h"

namespace octavo {

/// A file read whole. Readers keep views into it, and say where in it something is wrong.
class FileBytes {
public:
    FileBytes(std::filesystem::path file, std::unique_ptr<char[]> data, std::size_t size)
        : file_(std::move(file)), data_(std::move(data)), size_(size) {}

    [[nodiscard]] const std::filesystem::path& file() const { return file_; }
    [[nodiscard]] std::string_view view() const { return {data_.get(), size_}; }

    /// A bad_input Error about this byte of the file.
    [[nodiscard]] Error error_at(const char* where, const std::string& message) const {
        return {Errc::bad_input, file_, message, static_cast<std::uint64_t>(where - data_.get())};
    }
    /// A bad_input Error about the file.
    [[nodiscard]] Error error(const std::string& message) const {
        return {Errc::bad_input, file_, message};
    }

private:
    std::filesystem::path file_;
    std::unique_ptr<char[]> data_;
    std::size_t size_;
};

/// Reads a file.
/// @param max_bytes  of a longer file nothing is read
/// @throws Error     as InputFile; io; limit
[[nodiscard]] FileBytes read_file(const std::filesystem::path& file, std::uint64_t max_bytes);

}  // namespace octavo
