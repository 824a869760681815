// SPDX-License-Identifier: MIT
#include "octavo/core/radix_sort.h"

#include <gtest/gtest.h>

#include <random>

#include "octavo/core/parallel.h"

namespace octavo {
namespace {

struct Item {
    std::uint32_t key;
    std::uint32_t place;
    friend bool operator==(const Item&, const Item&) = default;
};

TEST(RadixSort, IsAStableSortForEveryKeyLengthAndThreadCount) {
    std::mt19937 bits(5);
    for (const int key_bits : {0, 1, 8, 9, 24, 30})
        for (const std::size_t count : {0u, 1u, 1000u, 200000u})
            for (const int threads : {1, 3}) {
                std::vector<Item> items(count);
                const auto mask = static_cast<std::uint32_t>((std::uint64_t{1} << key_bits) - 1);
                for (std::size_t i = 0; i < count; ++i)
                    items[i] = {static_cast<std::uint32_t>(bits()) & mask,
                                static_cast<std::uint32_t>(i)};
                std::vector<Item> expected = items;
                std::ranges::stable_sort(expected, {}, &Item::key);
                std::vector<Item> scratch;
                with_threads(threads, [&] {
                    radix_sort(
                        items, key_bits, [](const Item& item) { return item.key; }, scratch);
                });
                ASSERT_EQ(items, expected) << key_bits << " bits, " << count << " items";
            }
}

TEST(RadixSort, OfPartsIsThatOfOneAfterTheOther) {
    std::mt19937 bits(6);
    for (const int key_bits : {0, 1, 15, 16, 17, 30})
        for (const std::size_t count : {0u, 1u, 50000u}) {
            const auto mask = static_cast<std::uint32_t>((std::uint64_t{1} << key_bits) - 1);
            std::vector<std::vector<Item>> parts(3);
            std::vector<Item> expected;
            for (std::size_t i = 0; i < count; ++i) {
                const Item item = {static_cast<std::uint32_t>(bits()) & mask,
                                   static_cast<std::uint32_t>(i)};
                parts[i < count / 2 ? 0 : 2].push_back(item);
                expected.push_back(item);
            }
            std::ranges::stable_sort(expected, {}, &Item::key);
            const std::vector<Item> sorted =
                radix_sort_parts(parts, key_bits, [](const Item& item) { return item.key; });
            ASSERT_EQ(sorted, expected) << key_bits << " bits, " << count << " items";
        }
}

}  // namespace
}  // namespace octavo
