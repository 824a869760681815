// SPDX-License-Identifier: MIT
#include "octavo/construct/word_array.h"

#include <sys/mman.h>

#include <cstdlib>
#include <new>

#include "octavo/core/huge_pages.h"
#include "octavo/core/memory.h"

namespace octavo {
namespace {

constexpr std::uint64_t kWord = sizeof(std::uint32_t);
constexpr std::uint64_t kHugePage = std::uint64_t{2} << 20;

// Blocks of this many words or more are maps of their own.
constexpr std::uint64_t kLeastMapped = 2 * kHugePage / kWord;

/// A map that begins at a huge page, with the pages of an old one, or of none, at its start. Pages
/// move as they are, small or huge, since both maps begin at a huge page.
std::uint32_t* remap(std::uint32_t* old, std::uint64_t old_bytes, std::uint64_t bytes) {
    char* const block = static_cast<char*>(map_huge_pages(bytes));
    if (old != nullptr &&
        mremap(old, old_bytes, bytes, MREMAP_MAYMOVE | MREMAP_FIXED, block) == MAP_FAILED) {
        munmap(block, bytes);
        throw std::bad_alloc();
    }
    // What was moved there brought the old map's advice along.
    (void)madvise(block, bytes, MADV_HUGEPAGE);
    return reinterpret_cast<std::uint32_t*>(block);
}

}  // namespace

void WordArray::Free::operator()(std::uint32_t* block) const {
    if (capacity < kLeastMapped)
        std::free(block);
    else
        munmap(block, capacity * kWord);
}

void WordArray::grow() {
    std::uint64_t capacity = capacity_ < kLeast ? kLeast : capacity_ + capacity_ / 2;
    if (capacity >= kLeastMapped)
        capacity = (capacity * kWord + kHugePage - 1) / kHugePage * kHugePage / kWord;
    std::uint32_t* grown = nullptr;
    if (capacity < kLeastMapped) {
        grown = static_cast<std::uint32_t*>(std::realloc(words_.get(), capacity * kWord));
        if (grown == nullptr) throw std::bad_alloc();
        (void)words_.release();
    } else if (capacity_ < kLeastMapped) {
        grown = remap(nullptr, 0, capacity * kWord);
        if (capacity_ != 0) std::memcpy(grown, words_.get(), capacity_ * kWord);
        words_.reset();
    } else {
        grown = remap(words_.get(), capacity_ * kWord, capacity * kWord);
        (void)words_.release();
    }
    words_.get_deleter().capacity = capacity;
    words_.reset(grown);
    capacity_ = capacity;
}

void WordArray::discard_before(std::uint64_t index) {
    discard_pages(words_.get(), index * kWord);
}

}  // namespace octavo
