// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "octavo/mesh/file_window.h"

namespace octavo {

/// A text's lines, through a window: only the longest line has to have room in memory.
class LineReader {
public:
    /// Begins with the first byte ahead of the window.
    explicit LineReader(FileWindow& input) : input_(input), begin_(input.begin()) {}

    [[nodiscard]] const std::filesystem::path& file() const { return input_.file(); }

    /// The next line without its end, both of which the window has then passed. Lines are valid
    /// until the next one is asked for.
    /// @return false where there is none
    bool next(std::string_view& line) {
        begin_ = input_.ahead().data();
        return find_end(line);
    }

    /// The same line together with the next one, as they stand in the file.
    /// @return false where there is none, and the line is as it was
    bool extend(std::string_view& line);

    /// A bad_input Error about this byte of the current line.
    [[nodiscard]] Error error_at(const char* where, const std::string& message) const {
        return input_.error_at(where, message);
    }

private:
    bool find_end(std::string_view& line);
    bool read_on();

    FileWindow& input_;
    const char* begin_;  // of the current line
};

}  // namespace octavo
