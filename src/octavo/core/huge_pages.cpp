// SPDX-License-Identifier: MIT
#include "octavo/core/huge_pages.h"

#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

namespace octavo {

namespace {

constexpr std::size_t kPage = std::size_t{2} << 20;

std::size_t whole_pages(std::size_t bytes) {
    return (bytes + kPage - 1) / kPage * kPage;
}

}  // namespace

void* map_huge_pages(std::size_t bytes) {
    void* const room = mmap(nullptr, bytes + kPage, PROT_READ | PROT_WRITE,
                            MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (room == MAP_FAILED) throw std::bad_alloc();
    char* const begin = static_cast<char*>(room);
    const std::size_t before = -reinterpret_cast<std::uintptr_t>(begin) % kPage;
    char* const block = begin + before;
    if (before != 0) munmap(begin, before);
    munmap(block + bytes, kPage - before);
    // Advice: without it pages are small, and nothing else changes.
    (void)madvise(block, bytes, MADV_HUGEPAGE);
    return block;
}

void* allocate_huge_pages(std::size_t bytes) {
    if (bytes >= kPage) return map_huge_pages(whole_pages(bytes));
    constexpr std::size_t kLine = 64;
    const std::size_t whole_lines = (bytes + kLine - 1) / kLine * kLine;
    void* const memory = std::aligned_alloc(kLine, whole_lines);
    if (memory == nullptr) throw std::bad_alloc();
    std::memset(memory, 0, bytes);
    return memory;
}

void free_huge_pages(void* memory, std::size_t bytes) noexcept {
    if (bytes >= kPage)
        munmap(memory, whole_pages(bytes));
    else
        std::free(memory);
}

}  // namespace octavo
