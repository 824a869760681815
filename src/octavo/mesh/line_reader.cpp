// SPDX-License-Identifier: MIT
#include "octavo/mesh/line_reader.h"

#include <cstring>

namespace octavo {

bool LineReader::extend(std::string_view& line) {
    if (input_.ahead().empty() && !read_on()) {
        line = {begin_, line.size()};
        return false;
    }
    return find_end(line);
}

bool LineReader::find_end(std::string_view& line) {
    std::size_t searched = 0;
    const void* found = nullptr;
    for (;;) {
        const std::string_view ahead = input_.ahead();
        found = std::memchr(ahead.data() + searched, '\n', ahead.size() - searched);
        if (found != nullptr) break;
        searched = ahead.size();
        if (!read_on()) break;
    }
    const std::string_view ahead = input_.ahead();
    const char* last =
        found != nullptr ? static_cast<const char*>(found) : ahead.data() + ahead.size();
    line = {begin_, static_cast<std::size_t>(last - begin_)};
    input_.pass(found != nullptr ? last + 1 : last);
    return found != nullptr || !line.empty();
}

/// Reads on behind the current line.
bool LineReader::read_on() {
    const bool more = input_.more(begin_);
    begin_ = input_.begin();
    return more;
}

}  // namespace octavo
