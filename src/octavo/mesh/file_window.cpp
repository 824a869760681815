// SPDX-License-Identifier: MIT
#include "octavo/mesh/file_window.h"

#include <algorithm>
#include <cstring>

namespace octavo {

FileWindow::FileWindow(const std::filesystem::path& file, std::uint64_t max_bytes)
    : input_(file, max_bytes),
      buffer_(std::make_unique_for_overwrite<char[]>(capacity_)),
      at_(buffer_.get()),
      end_(buffer_.get()) {
    fill();
}

/// Reads as many bytes as the buffer has room for.
void FileWindow::fill() {
    char* to = buffer_.get() + (end_ - buffer_.get());
    const std::size_t room = capacity_ - static_cast<std::size_t>(end_ - buffer_.get());
    const std::size_t read = input_.read(to, room);
    ended_ = read < room;
    end_ += read;
}

bool FileWindow::more(const char* keep) {
    const auto passed = static_cast<std::size_t>(keep - buffer_.get());
    const auto rest = static_cast<std::size_t>(end_ - keep);
    const auto at = static_cast<std::size_t>(at_ - keep);
    if (rest == capacity_ && !ended_) {
        auto larger = std::make_unique_for_overwrite<char[]>(2 * capacity_);
        std::memcpy(larger.get(), keep, rest);
        buffer_ = std::move(larger);
        capacity_ *= 2;
    } else if (passed != 0) {
        std::memmove(buffer_.get(), keep, rest);
    }
    offset_ += passed;
    at_ = buffer_.get() + at;
    end_ = buffer_.get() + rest;
    if (ended_) return false;
    fill();
    return end_ != buffer_.get() + rest;
}

bool FileWindow::gather(std::size_t size) {
    while (ahead().size() < size)
        if (!more(at_)) return false;
    return true;
}

bool FileWindow::skip(std::uint64_t size) {
    while (ahead().size() < size) {
        size -= ahead().size();
        at_ = end_;
        if (!more(at_)) return false;
    }
    at_ += size;
    return true;
}

FileBytes FileWindow::take_all() {
    // One byte more than is expected: the end shows as less than was asked for.
    std::size_t capacity = std::max<std::uint64_t>(expected_ahead(), ahead().size()) + 1;
    auto data = std::make_unique_for_overwrite<char[]>(capacity);
    std::size_t size = ahead().copy(data.get(), ahead().size());
    at_ = end_;
    while (!ended_) {
        const std::size_t read = input_.read(data.get() + size, capacity - size);
        size += read;
        offset_ += read;
        ended_ = size < capacity;
        if (ended_) break;
        auto larger = std::make_unique_for_overwrite<char[]>(2 * capacity);
        std::memcpy(larger.get(), data.get(), size);
        data = std::move(larger);
        capacity *= 2;
    }
    return {file(), std::move(data), size};
}

void FileWindow::finish() {
    if (!input_.inflates()) return;
    do {
        at_ = end_;
    } while (more(at_));
}

std::uint64_t FileWindow::most_ahead() const {
    return ahead_of(input_.most_size());
}

std::uint64_t FileWindow::expected_ahead() const {
    return ahead_of(input_.expected_size());
}

/// In a file of so many bytes; files may have changed since their size was asked for.
std::uint64_t FileWindow::ahead_of(std::uint64_t file_bytes) const {
    const std::uint64_t here = ahead().size();
    const std::uint64_t before = offset_of(at_);
    if (ended_ || file_bytes < before) return here;
    return std::max(here, file_bytes - before);
}

}  // namespace octavo
