// SPDX-License-Identifier: MIT
#include "octavo/core/morton.h"

#include <gtest/gtest.h>

namespace octavo {
namespace {

TEST(Morton, LowestBitsAreTheChildIndex) {
    for (std::uint32_t i = 0; i < 8; ++i)
        EXPECT_EQ(morton_encode({i & 1u, i >> 1 & 1u, i >> 2}), i);
}

TEST(Morton, DecodeIsTheInverseOfEncode) {
    std::uint64_t state = 1;
    for (int i = 0; i < 10000; ++i) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        const uvec3 cell(state >> 43, state >> 22 & 0x1fffff, state >> 3 & 0x1fffff);
        ASSERT_EQ(morton_decode(morton_encode(cell)), cell);
    }
    const uvec3 last(0x1fffff);
    EXPECT_EQ(morton_decode(morton_encode(last)), last);
}

}  // namespace
}  // namespace octavo
