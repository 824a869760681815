// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "octavo/core/error.h"
#include "octavo/mesh/inflated_file.h"

namespace octavo {

/// A text file line by line, also gzipped. It is never in memory whole: only a buffer that is
/// larger than its longest line.
class LineReader {
public:
    /// @throws Error  as InflatedFile, here and in all that reads
    LineReader(const std::filesystem::path& file, std::uint64_t max_bytes);

    [[nodiscard]] const std::filesystem::path& file() const { return input_.path(); }

    /// What the text begins with, as far as the first lines are short: to be asked before the first
    /// line.
    [[nodiscard]] std::string_view start();

    /// The next line without its end. Lines are valid until the next one is asked for.
    /// @return false where there is none
    bool next(std::string_view& line) {
        begin_ = at_;
        return find_end(line);
    }

    /// The same line together with the next one, as they stand in the file.
    /// @return false where there is none, and the line is as it was
    bool extend(std::string_view& line);

    /// A bad_input Error about this byte of the current line.
    [[nodiscard]] Error error_at(const char* where, const std::string& message) const;

private:
    bool find_end(std::string_view& line);
    bool refill();

    InflatedFile input_;
    std::size_t capacity_ = std::size_t{256} << 10;
    std::unique_ptr<char[]> buffer_;
    std::uint64_t offset_ = 0;  // in the text, of the buffer's first byte
    std::size_t begin_ = 0;     // of the current line
    std::size_t at_ = 0;        // of what follows it
    std::size_t end_ = 0;       // of what has been read
};

}  // namespace octavo
