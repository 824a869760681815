// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "octavo/core/input_file.h"

namespace octavo {

/// A file read from its beginning on, and inflated where it begins as gzip does: all members of it.
class InflatedFile {
public:
    /// @param max_bytes  of a longer file nothing is read
    /// @throws Error     as InputFile; limit
    InflatedFile(const std::filesystem::path& file, std::uint64_t max_bytes);
    ~InflatedFile();
    InflatedFile(const InflatedFile&) = delete;
    InflatedFile& operator=(const InflatedFile&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return file_.path(); }

    /// The next bytes; fewer than asked for only at the end.
    /// @throws Error  io; bad_input where the gzip data is damaged or cut short; limit once there
    ///                are more than max_bytes
    [[nodiscard]] std::size_t read(char* out, std::size_t size);

    /// Whether the bytes are not those of the file.
    [[nodiscard]] bool inflates() const { return inflater_ != nullptr; }

    /// How many bytes there are; of gzip data a guess, and a number that it cannot pass.
    [[nodiscard]] std::uint64_t expected_size() const;
    [[nodiscard]] std::uint64_t most_size() const;

private:
    struct Inflater;

    [[nodiscard]] std::size_t inflate_next(char* out, std::size_t size);

    InputFile file_;
    std::uint64_t max_bytes_;
    std::unique_ptr<Inflater> inflater_;  // none: the bytes are as they are
};

}  // namespace octavo
