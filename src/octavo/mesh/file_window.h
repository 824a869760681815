// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "octavo/core/error.h"
#include "octavo/core/file_bytes.h"
#include "octavo/mesh/inflated_file.h"

namespace octavo {

/// A file, also gzipped, through a window that moves from its beginning to its end: only the bytes
/// that a reader wants side by side are in memory. Offsets count inflated bytes.
class FileWindow {
public:
    /// Opens the file and reads what it begins with: 256 kB, where it has as many.
    /// @throws Error  as InflatedFile, here and in all that reads
    FileWindow(const std::filesystem::path& file, std::uint64_t max_bytes);

    [[nodiscard]] const std::filesystem::path& file() const { return input_.path(); }

    /// The oldest byte that is still here.
    [[nodiscard]] const char* begin() const { return buffer_.get(); }
    /// What has been read and not yet passed.
    [[nodiscard]] std::string_view ahead() const {
        return {at_, static_cast<std::size_t>(end_ - at_)};
    }

    /// Goes on to a byte of ahead(), or to its end. What is passed stays here until more() is
    /// called.
    void pass(const char* to) { at_ = to; }

    /// Reads on. Bytes before `keep` go; it is at begin() afterwards, and what follows it behind.
    /// The window grows where all of it is kept.
    /// @return false where the file has no more
    bool more(const char* keep);

    /// The next bytes, in one piece and passed; null where the file ends before their end, and then
    /// all that is left is ahead. Valid until the next bytes are asked for.
    [[nodiscard]] const char* take(std::size_t size) {
        if (static_cast<std::size_t>(end_ - at_) < size && !gather(size)) return nullptr;
        at_ += size;
        return at_ - size;
    }

    /// Passes this many bytes, without holding them. @return false where the file ends before
    bool skip(std::uint64_t size);

    /// All that is ahead, up to the end of the file.
    [[nodiscard]] FileBytes take_all();

    /// Reads gzip data to its end, because damage there shows only then. What is ahead goes.
    void finish();

    /// No more bytes than this are ahead; exactly as many, but in long gzip data.
    [[nodiscard]] std::uint64_t most_ahead() const;
    /// A guess at them: room for as many may be made without risk.
    [[nodiscard]] std::uint64_t expected_ahead() const;

    [[nodiscard]] std::uint64_t offset_of(const char* where) const {
        return offset_ + static_cast<std::uint64_t>(where - buffer_.get());
    }
    /// A bad_input Error about a byte of the file that is here, or was.
    [[nodiscard]] Error error_at(const char* where, const std::string& message) const {
        return error_at(offset_of(where), message);
    }
    [[nodiscard]] Error error_at(std::uint64_t offset, const std::string& message) const {
        return {Errc::bad_input, file(), message, offset};
    }

private:
    bool gather(std::size_t size);
    void fill();
    [[nodiscard]] std::uint64_t ahead_of(std::uint64_t file_bytes) const;

    InflatedFile input_;
    std::size_t capacity_ = std::size_t{256} << 10;
    std::unique_ptr<char[]> buffer_;
    std::uint64_t offset_ = 0;   // in the file, of the buffer's first byte
    const char* at_ = nullptr;   // in the buffer: the first byte not yet passed
    const char* end_ = nullptr;  // of what has been read
    bool ended_ = false;         // there is nothing behind the end of the buffer
};

}  // namespace octavo
