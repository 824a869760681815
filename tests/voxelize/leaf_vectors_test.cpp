// SPDX-License-Identifier: MIT
#include "octavo/voxelize/leaf_vectors.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "octavo/core/huge_pages.h"
#include "octavo/dag/node.h"
#include "octavo/voxelize/tile_rasterizer.h"

namespace octavo {
namespace {

class LeafVectors : public testing::TestWithParam<const char*> {
protected:
    LeafVectors() { force_simd_target(GetParam()); }
    ~LeafVectors() override { force_simd_target(nullptr); }

    std::mt19937_64 random{7};
};

TEST_P(LeafVectors, CountWhatEachLeafHolds) {
    for (std::size_t size = 0; size < 40; ++size) {
        std::vector<std::uint64_t> leaves(size);
        LeafCounts expected;
        for (std::uint64_t& leaf : leaves) {
            leaf = random() & random() & random();
            expected.voxels += static_cast<unsigned>(std::popcount(leaf));
            expected.children += static_cast<unsigned>(std::popcount(leaf_child_mask(leaf)));
        }
        const LeafCounts counts = count_leaves(leaves);
        EXPECT_EQ(counts.voxels, expected.voxels) << size << " leaves";
        EXPECT_EQ(counts.children, expected.children) << size << " leaves";
    }
}

TEST_P(LeafVectors, AreTakenInOrderAndLeaveZeros) {
    constexpr std::size_t kWindows = 6;
    HugeVector<std::uint64_t> leaves(64 * kWindows);
    std::vector<std::uint64_t> set(kWindows), expected, out;
    std::vector<std::uint32_t> windows;
    const std::uint64_t sets[kWindows] = {1,        ~std::uint64_t{0},   0,
                                          random(), random() & random(), std::uint64_t{1} << 63};
    for (std::uint32_t w = 0; w < kWindows; ++w) {
        set[w] = sets[w];
        if (set[w] != 0) windows.push_back(w);
        for (unsigned i = 0; i < 64; ++i)
            if (set[w] >> i & 1u) expected.push_back(leaves[64 * w + i] = random() | 1);
    }
    out.resize(expected.size() + kTakeSlack);
    take_leaves(windows, leaves.data(), set.data(), out.data());
    out.resize(expected.size());
    EXPECT_EQ(out, expected);
    EXPECT_EQ(set, std::vector<std::uint64_t>(kWindows));
    for (const std::uint64_t leaf : leaves) EXPECT_EQ(leaf, 0u);
}

INSTANTIATE_TEST_SUITE_P(AllTargets, LeafVectors, testing::ValuesIn(simd_targets()),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace octavo
