// SPDX-License-Identifier: MIT
#include "octavo/dag/node.h"

#include <gtest/gtest.h>

namespace octavo {
namespace {

TEST(Node, LeafChildMaskSaysWhichBytesAreNotZero) {
    for (std::uint32_t mask = 0; mask < 256; ++mask)
        for (const std::uint64_t byte : {0x01u, 0x80u, 0xffu, 0x10u}) {
            std::uint64_t leaf = 0;
            for (int i = 0; i < 8; ++i)
                if (mask >> i & 1u) leaf |= byte << 8 * i;
            ASSERT_EQ(leaf_child_mask(leaf), mask);
        }
}

TEST(Node, ChildrenAreStoredWithoutGaps) {
    for (std::uint32_t mask = 1; mask < 256; ++mask) {
        int next = 1;
        for (int i = 0; i < 8; ++i)
            if (mask >> i & 1u) {
                EXPECT_EQ(child_offset(mask, i), next++);
            }
        EXPECT_EQ(node_words(mask), next);
    }
}

}  // namespace
}  // namespace octavo
