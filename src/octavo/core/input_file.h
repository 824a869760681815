// SPDX-License-Identifier: MIT
#pragma once

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

    [[nodiscard]] int descriptor() const { return descriptor_; }
    /// In bytes, when it was opened.
    [[nodiscard]] std::uint64_t size() const { return size_; }

private:
    int descriptor_;
    std::uint64_t size_ = 0;
};

}  // namespace octavo
