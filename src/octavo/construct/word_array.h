// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>

namespace octavo {

/// A growing array of 32-bit words. Unlike std::vector it moves a large block by remapping its
/// pages: growth neither copies nor holds the old and the new array at once, and the room ahead of
/// the end takes no memory until it is written. Large blocks lie in pages of 2 MiB where the system
/// has them (docs/adr/0045-nodes-in-huge-pages.md).
///
/// Once it has words, kSlack words after the last one can be read and written, so that short runs
/// can be copied and compared by a fixed number of words.
class WordArray {
public:
    static constexpr int kSlack = 16;

    [[nodiscard]] std::uint64_t size() const { return size_; }
    [[nodiscard]] const std::uint32_t* data() const { return words_.get(); }
    [[nodiscard]] std::uint32_t* data() { return words_.get(); }
    [[nodiscard]] std::span<const std::uint32_t> words() const { return {words_.get(), size_}; }

    /// At most kLeast words.
    void append(const std::uint32_t* words, int count) {
        std::memcpy(room(count), words, static_cast<unsigned>(count) * sizeof(std::uint32_t));
        commit(count);
    }

    /// The end, where `count` words, at most kLeast, and the slack can be written.
    [[nodiscard]] std::uint32_t* room(int count) {
        if (size_ + static_cast<unsigned>(count + kSlack) > capacity_) grow();
        return words_.get() + size_;
    }
    /// Of the words written there, this many stay.
    void commit(int count) { size_ += static_cast<unsigned>(count); }

    /// Gives the memory of the words before this index back, as far as whole pages go. They read as
    /// anything afterwards.
    void discard_before(std::uint64_t index);

    /// Forgets the words, keeps the room.
    void clear() { size_ = 0; }

    /// Gives the memory back.
    void reset() { *this = WordArray(); }

private:
    struct Free {
        std::uint64_t capacity;  // of the block

        Free() : capacity(0) {}
        void operator()(std::uint32_t* block) const;
    };

    void grow();

    static constexpr std::uint64_t kLeast = 1024;

    std::unique_ptr<std::uint32_t, Free> words_;
    std::uint64_t size_ = 0;
    std::uint64_t capacity_ = 0;
};

}  // namespace octavo
