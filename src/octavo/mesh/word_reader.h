// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/mesh/file_window.h"
#include "octavo/mesh/text_cursor.h"

namespace octavo {

/// A text's words and numbers, whatever lines they stand in, through a window. None is ever cut:
/// `text` ends behind a white space, or where the file does.
class WordReader {
public:
    /// Begins with the first byte ahead of the window.
    explicit WordReader(FileWindow& input) : text(input.ahead().substr(0, 0)), input_(input) {}

    /// Goes to the next word, of which all is then in `text`.
    /// @return false where there is none: `text` is done
    bool find() {
        text.skip_space();
        return !text.done() || find_further_on();
    }

    /// Goes behind the end of this line.
    void skip_line();

    TextCursor text;

private:
    bool find_further_on();
    bool read_on();

    FileWindow& input_;
};

}  // namespace octavo
