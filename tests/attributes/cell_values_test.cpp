// SPDX-License-Identifier: MIT
#include "octavo/attributes/cell_values_writer.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "octavo/trace/shared_text.h"

namespace octavo::shared {

struct ValueView {
    const uint* words = nullptr;
};
uint value_load(ValueView values, uint word) {
    return values.words[word];
}

}  // namespace octavo::shared

#include "octavo/attributes/cell_value.h"

namespace octavo {
namespace {

/// Values of which some blocks have none, some few and some many different ones.
std::vector<std::uint32_t> mixed_values(std::size_t count, int bits, std::uint32_t seed) {
    std::mt19937 random(seed);
    const std::uint32_t all = bits == 32 ? 0xffffffffu : (1u << bits) - 1;
    std::vector<std::uint32_t> values;
    while (values.size() < count) {
        const std::uint32_t kinds[] = {1, 2, 3, 17, 100, 200, 100000};
        const std::uint32_t different = kinds[random() % 7];
        const bool empty = random() % 5 == 0;
        const auto base = static_cast<std::uint32_t>(random());
        const std::size_t run = 1 + random() % 600;
        for (std::size_t i = 0; i < run && values.size() < count; ++i)
            values.push_back(
                empty ? 0
                      : (base + static_cast<std::uint32_t>(random() % different) * 0x01010101u) &
                            all);
    }
    return values;
}

CellValues packed(const std::vector<std::uint32_t>& values, int bits, int tolerance) {
    CellValuesWriter writer(bits, tolerance);
    writer.append(values);
    return std::move(writer).finish();
}

TEST(CellValues, GiveBackWhatWasPutIn) {
    for (const int bits : {1, 7, 8, 24, 31, 32})
        for (const std::size_t count : {1u, 255u, 256u, 257u, 10000u}) {
            const auto values = mixed_values(count, bits, static_cast<unsigned>(bits));
            const CellValues stored = packed(values, bits, 0);
            ASSERT_EQ(stored.count(), count);
            for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(stored.get(i), values[i]) << i;
            ASSERT_FALSE(CellValues::find_fault(stored.words(), count, bits));
        }
}

TEST(CellValues, TheSharedTextReadsTheSame) {
    for (const int bits : {1, 24, 32}) {
        const auto values = mixed_values(5000, bits, 3);
        const CellValues stored = packed(values, bits, 0);
        for (std::uint32_t i = 0; i < values.size(); ++i)
            ASSERT_EQ(shared::cell_value({stored.words().data()}, i), values[i]);
    }
}

TEST(CellValues, LossyValuesStayWithinTheStatedError) {
    for (const int tolerance : {1, 4, 20}) {
        const auto values = mixed_values(20000, 32, 9);
        const CellValues stored = packed(values, 32, tolerance);
        for (std::size_t i = 0; i < values.size(); ++i) {
            const std::uint32_t got = stored.get(i);
            ASSERT_EQ(got >> 24, values[i] >> 24);
            for (int c = 0; c < 24; c += 8)
                ASSERT_LE(std::abs(static_cast<int>(got >> c & 255u) -
                                   static_cast<int>(values[i] >> c & 255u)),
                          tolerance);
        }
    }
}

TEST(CellValues, EmptyBlocksTakeAWord) {
    std::vector<std::uint32_t> values(1 << 20, 0);
    values[123456] = 77;
    const CellValues stored = packed(values, 32, 0);
    EXPECT_LT(stored.words().size(), (values.size() / 256) + 100);
    EXPECT_EQ(stored.get(123456), 77u);
    EXPECT_EQ(stored.get(123457), 0u);
}

TEST(CellValues, BlocksPackedElsewhereFitBetweenLooseValues) {
    const auto values = mixed_values(256 * 20 + 77, 24, 11);
    const std::span<const std::uint32_t> all(values);
    CellValuesWriter writer(24, 0);
    writer.append(all.first(100));
    writer.append(all.subspan(100, 156));
    BlockPacker packer(24, 0);
    PackedBlocks blocks;
    for (std::size_t b = 1; b < 20; ++b) packer.pack(all.subspan(b * 256, 256), blocks);
    writer.append(blocks);
    writer.append(all.subspan(256 * 20));
    const CellValues stored = std::move(writer).finish();
    const CellValues whole = packed(values, 24, 0);
    EXPECT_TRUE(std::ranges::equal(stored.words(), whole.words()));
}

TEST(CellValues, DamagedWordsAreFoundOrHarmless) {
    const auto values = mixed_values(3000, 24, 5);
    const CellValues stored = packed(values, 24, 0);
    std::mt19937 random(3);
    int found = 0;
    for (int i = 0; i < 20000; ++i) {
        std::vector<std::uint32_t> words(stored.words().begin(), stored.words().end());
        const std::size_t at = i % 2 == 0 ? random() % 40 : random() % words.size();
        words[at] ^= 1u << random() % 32;
        if (i % 7 == 0) words.resize(random() % words.size());
        if (CellValues::find_fault(words, values.size(), 24)) {
            ++found;
            continue;
        }
        // Every access is inside the words: the address sanitizer watches.
        const CellValues damaged(words, values.size(), nullptr);
        for (std::size_t c = 0; c < values.size(); c += 3) (void)damaged.get(c);
    }
    EXPECT_GT(found, 1000);
}

}  // namespace
}  // namespace octavo
