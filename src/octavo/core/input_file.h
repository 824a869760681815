// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace octavo {

/// A file that is open for reading. Every file that comes from outside is opened here: only regular
/// files are, since pipes and devices have no size, may keep who opens them waiting, and may never
/// end.
class InputFile {
public:
    /// @throws Error  io where it is missing or may not be read; bad_input where it is a folder, a
    ///                pipe or a device; bad_argument where the name is empty
    explicit InputFile(const std::filesystem::path& path);
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    /// The next bytes; fewer than asked for only at the end. @throws Error io
    [[nodiscard]] std::size_t read(char* out, std::size_t size);

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] int descriptor() const { return descriptor_; }
    /// In bytes, when it was opened.
    [[nodiscard]] std::uint64_t size() const { return size_; }

private:
    std::filesystem::path path_;
    int descriptor_;
    std::uint64_t size_ = 0;
};

}  // namespace octavo
