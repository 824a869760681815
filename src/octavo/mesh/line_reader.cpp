// SPDX-License-Identifier: MIT
#include "octavo/mesh/line_reader.h"

#include <cstring>

namespace octavo {

LineReader::LineReader(const std::filesystem::path& file, std::uint64_t max_bytes)
    : input_(file, max_bytes), buffer_(std::make_unique_for_overwrite<char[]>(capacity_)) {}

std::string_view LineReader::start() {
    if (end_ == 0) refill();
    return {buffer_.get(), end_};
}

bool LineReader::extend(std::string_view& line) {
    if (at_ == end_ && !refill()) {
        line = {buffer_.get() + begin_, line.size()};
        return false;
    }
    return find_end(line);
}

Error LineReader::error_at(const char* where, const std::string& message) const {
    return {Errc::bad_input, file(), message,
            offset_ + static_cast<std::uint64_t>(where - buffer_.get())};
}

bool LineReader::find_end(std::string_view& line) {
    std::size_t searched = at_;
    for (;;) {
        const char* data = buffer_.get();
        const void* found =
            searched == end_ ? nullptr : std::memchr(data + searched, '\n', end_ - searched);
        if (found != nullptr) {
            const auto last = static_cast<std::size_t>(static_cast<const char*>(found) - data);
            line = {data + begin_, last - begin_};
            at_ = last + 1;
            return true;
        }
        const std::size_t rest = end_ - begin_;
        if (!refill()) break;
        searched = begin_ + rest;
    }
    at_ = end_;
    line = {buffer_.get() + begin_, end_ - begin_};
    return !line.empty();
}

/// Reads on behind the current line, which moves to the front.
bool LineReader::refill() {
    const std::size_t rest = end_ - begin_;
    if (rest == capacity_) {
        auto larger = std::make_unique_for_overwrite<char[]>(2 * capacity_);
        std::memcpy(larger.get(), buffer_.get() + begin_, rest);
        buffer_ = std::move(larger);
        capacity_ *= 2;
    } else {
        std::memmove(buffer_.get(), buffer_.get() + begin_, rest);
    }
    offset_ += begin_;
    at_ -= begin_;
    begin_ = 0;
    const std::size_t read = input_.read(buffer_.get() + rest, capacity_ - rest);
    end_ = rest + read;
    return read != 0;
}

}  // namespace octavo
