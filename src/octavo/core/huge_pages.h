// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

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

/// Leaves elements that are made without a value as the memory has them.
template <class T>
struct RawHugePageAllocator : HugePageAllocator<T> {
    template <class U>
    struct rebind {
        using other = RawHugePageAllocator<U>;
    };

    RawHugePageAllocator() = default;
    template <class U>
    RawHugePageAllocator(const RawHugePageAllocator<U>&) {}

    template <class U>
    void construct(U* place) noexcept {
        ::new (static_cast<void*>(place)) U;
    }
    template <class U, class... Arguments>
    void construct(U* place, Arguments&&... arguments) {
        ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
    }
};

/// A map of its own of so many whole pages of 2 MiB, zeros, which begins at one; to be given back
/// by munmap(). @throws std::bad_alloc
[[nodiscard]] void* map_huge_pages(std::size_t bytes);

/// The same as allocate_huge_pages(), all zeros. Pages of a large block are zeroed when they are
/// first touched, and once.
/// @param bytes  of the block that is given back
[[nodiscard]] void* allocate_zeroed_huge_pages(std::size_t bytes);
void free_zeroed_huge_pages(void* memory, std::size_t bytes) noexcept;

/// For a vector of plain values that is made in its full size at once: resize() does not write to
/// it.
template <class T>
struct ZeroedHugePageAllocator {
    using value_type = T;

    ZeroedHugePageAllocator() = default;
    template <class U>
    ZeroedHugePageAllocator(const ZeroedHugePageAllocator<U>&) {}

    [[nodiscard]] T* allocate(std::size_t count) {
        return static_cast<T*>(allocate_zeroed_huge_pages(count * sizeof(T)));
    }
    void deallocate(T* memory, std::size_t count) noexcept {
        free_zeroed_huge_pages(memory, count * sizeof(T));
    }
    template <class U>
    void construct(U*) noexcept {}
    template <class U, class... Arguments>
    void construct(U* place, Arguments&&... arguments) {
        ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
    }

    friend bool operator==(const ZeroedHugePageAllocator&, const ZeroedHugePageAllocator&) {
        return true;
    }
};

/// A large array of plain numbers; resize() does not write to it, so that the threads that fill it
/// are the ones that get its pages.
template <class T>
using HugeVector = std::vector<T, RawHugePageAllocator<T>>;

}  // namespace octavo
