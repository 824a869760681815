// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace octavo {

/// A map of its own of so many whole pages of 2 MiB, zeros, which begins at one; to be given back
/// by munmap(). @throws std::bad_alloc
[[nodiscard]] void* map_huge_pages(std::size_t bytes);

/// Zeroed memory for large arrays that are read at random: in pages of 2 MiB where the system has
/// them, so that a read misses the cache but not the table of pages as well. Begins at a cache
/// line. Pages of a large block are zeroed when they are first touched, and once.
/// @throws std::bad_alloc
[[nodiscard]] void* allocate_huge_pages(std::size_t bytes);
/// @param bytes  of the block that is given back
void free_huge_pages(void* memory, std::size_t bytes) noexcept;

/// For vectors, see HugeVector.
template <class T>
struct HugePageAllocator {
    using value_type = T;

    HugePageAllocator() = default;
    template <class U>
    HugePageAllocator(const HugePageAllocator<U>&) {}

    [[nodiscard]] T* allocate(std::size_t count) {
        return static_cast<T*>(allocate_huge_pages(count * sizeof(T)));
    }
    void deallocate(T* memory, std::size_t count) noexcept {
        free_huge_pages(memory, count * sizeof(T));
    }
    template <class U>
    void construct(U*) noexcept {}
    template <class U, class... Arguments>
    void construct(U* place, Arguments&&... arguments) {
        ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
    }

    friend bool operator==(const HugePageAllocator&, const HugePageAllocator&) { return true; }
};

/// A large array of plain values, made in its full size at once: they are zeros, and resize() does
/// not write them, so that the threads that fill the array are the ones that get its pages.
template <class T>
using HugeVector = std::vector<T, HugePageAllocator<T>>;

}  // namespace octavo
