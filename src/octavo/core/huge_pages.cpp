// SPDX-License-Identifier: MIT
#include "octavo/core/huge_pages.h"

#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace octavo {

void* allocate_huge_pages(std::size_t bytes) {
    constexpr std::size_t kPage = std::size_t{2} << 20;
    constexpr std::size_t kLine = 64;
    void* memory = nullptr;
    if (bytes < kPage) {
        memory = std::aligned_alloc(kLine, (bytes + kLine - 1) / kLine * kLine);
    } else {
        memory = std::aligned_alloc(kPage, (bytes + kPage - 1) / kPage * kPage);
        // Advice: without it pages are small, and nothing else changes.
        if (memory != nullptr) (void)madvise(memory, bytes / kPage * kPage, MADV_HUGEPAGE);
    }
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

void free_huge_pages(void* memory) noexcept {
    std::free(memory);
}

}  // namespace octavo
