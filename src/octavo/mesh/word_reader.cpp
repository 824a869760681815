// SPDX-License-Identifier: MIT
#include "octavo/mesh/word_reader.h"

#include <algorithm>
#include <iterator>

namespace octavo {

bool WordReader::find_further_on() {
    while (text.done()) {
        if (!read_on()) return false;
        text.skip_space();
    }
    return true;
}

void WordReader::skip_line() {
    do {
        const std::string_view rest(text.at, static_cast<std::size_t>(text.end - text.at));
        const std::size_t end = rest.find('\n');
        if (end != std::string_view::npos) {
            text.at += end + 1;
            return;
        }
        text.at = text.end;
    } while (read_on());
}

/// Lets `text` be what follows it. @return false where nothing does
bool WordReader::read_on() {
    std::string_view ahead;
    bool more = true;
    // What is ahead of the window at first has not been looked at; later, there is a part of a
    // word in it, or nothing.
    input_.pass(text.at);
    for (ahead = input_.ahead();; ahead = input_.ahead()) {
        const auto last = std::find_if(ahead.rbegin(), ahead.rend(), TextCursor::is_space);
        if (last != ahead.rend()) {
            ahead = ahead.substr(0, static_cast<std::size_t>(std::distance(last, ahead.rend())));
            break;
        }
        if (!more) break;
        more = input_.more(ahead.data());
    }
    text = TextCursor(ahead);
    return !ahead.empty();
}

}  // namespace octavo
