// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace octavo {

/// Memory for large arrays that are read at random: in pages of 2 MiB where the system has them, so
/// that a read misses the cache but not the table of pages as well. Begins at a cache line.
/// @throws std::bad_alloc
[[nodiscard]] void* allocate_huge_pages(std::size_t bytes);
void free_huge_pages(void* memory) noexcept;

template <class T>
struct HugePageAllocator {
    using value_type = T;

    HugePageAllocator() = default;
    template <class U>
    HugePageAllocator(const HugePageAllocator<U>&) {}

    [[nodiscard]] T* allocate(std::size_t count) {
        return static_cast<T*>(allocate_huge_pages(count * sizeof(T)));
    }
    void deallocate(T* memory, std::size_t) noexcept { free_huge_pages(memory); }

    friend bool operator==(const HugePageAllocator&, const HugePageAllocator&) { return true; }
};

}  // namespace octavo
