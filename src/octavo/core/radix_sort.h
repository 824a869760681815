// SPDX-License-Identifier: MIT
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace octavo {

/// Sorts by an unsigned key, keeping the order of equal keys. Parallel; a pass over the items for
/// every 8 bits of the key, so for short keys several times faster than a sort by comparison.
///
/// @param key       item → unsigned integer below 2^key_bits
/// @param scratch   room for the items; its content afterwards is unspecified
template <class Item, class Key>
void radix_sort(std::vector<Item>& items, int key_bits, const Key& key,
                std::vector<Item>& scratch) {
    constexpr int kDigitBits = 8;
    constexpr std::size_t kDigits = 1u << kDigitBits;
    constexpr std::size_t kLeastPerPart = 1 << 14;

    const std::size_t count = items.size();
    const auto workers = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    const std::size_t parts = std::clamp(count / kLeastPerPart, std::size_t{1}, workers);
    const auto begin_of = [&](std::size_t part) { return count * part / parts; };
    scratch.resize(count);

    std::vector<std::size_t> offsets(parts * kDigits);  // [part][digit]
    for (int shift = 0; shift < key_bits; shift += kDigitBits) {
        const auto digit = [&](const Item& item) {
            return static_cast<std::size_t>(key(item) >> shift) & (kDigits - 1);
        };
        tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
            std::size_t* counts = &offsets[part * kDigits];
            std::fill_n(counts, kDigits, 0);
            for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i)
                ++counts[digit(items[i])];
        });
        std::size_t next = 0;
        for (std::size_t d = 0; d < kDigits; ++d)
            for (std::size_t part = 0; part < parts; ++part) {
                const std::size_t size = offsets[part * kDigits + d];
                offsets[part * kDigits + d] = next;
                next += size;
            }
        tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
            std::size_t* ends = &offsets[part * kDigits];
            for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i)
                scratch[ends[digit(items[i])]++] = items[i];
        });
        items.swap(scratch);
    }
}

}  // namespace octavo
