// SPDX-License-Identifier: MIT
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
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

/// Sorts the items of all parts by an unsigned key into one array, keeping the order of equal keys
/// within a part, and of parts. Parallel over parts. For keys of up to 16 bits that is a single
/// pass over the items: much of it waits for memory unless neighbours often have keys that came
/// lately.
///
/// @param parts  left empty
template <class Item, class Key>
[[nodiscard]] std::vector<Item> radix_sort_parts(std::vector<std::vector<Item>>& parts,
                                                 int key_bits, const Key& key) {
    constexpr int kMostBits = 16;
    const int digit_bits = std::min(key_bits, kMostBits);
    const int shift = key_bits - digit_bits;
    const std::size_t digits = std::size_t{1} << digit_bits;

    std::vector<std::vector<std::size_t>> offsets(parts.size());  // [part][digit]
    const auto digit = [&](const Item& item) {
        return static_cast<std::size_t>(key(item) >> shift);
    };
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
        offsets[part].resize(digits);
        for (const Item& item : parts[part]) ++offsets[part][digit(item)];
    });
    std::vector<std::size_t> begins;  // of digits
    std::size_t next = 0;
    for (std::size_t d = 0; d < digits; ++d) {
        begins.push_back(next);
        for (std::vector<std::size_t>& of_part : offsets) next += std::exchange(of_part[d], next);
    }
    begins.push_back(next);

    std::vector<Item> sorted(next);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
        std::size_t* ends = offsets[part].data();
        for (const Item& item : parts[part]) sorted[ends[digit(item)]++] = item;
        parts[part] = {};
    });
    if (shift > 0)  // what has one digit is little, and hardly ever out of order
        tbb::parallel_for(std::size_t{0}, digits, [&](std::size_t d) {
            std::stable_sort(sorted.data() + begins[d], sorted.data() + begins[d + 1],
                             [&](const Item& a, const Item& b) { return key(a) < key(b); });
        });
    return sorted;
}

}  // namespace octavo
