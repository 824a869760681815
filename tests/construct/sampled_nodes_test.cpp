// SPDX-License-Identifier: MIT
#include "octavo/construct/sampled_nodes.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <map>
#include <random>

namespace octavo {
namespace {

TEST(SampledNodes, CurveIsTheAverageOverAllWaysOfChoosingPieces) {
    std::mt19937_64 random(11);
    SampledNodes nodes(0);
    std::map<std::uint64_t, unsigned> pieces_of;  // each leaf's, as bits
    for (int tile = 0; tile < 60; ++tile) {
        const auto piece = static_cast<unsigned>(random() % SampledNodes::kPieces);
        NodeStore store(0);
        for (int leaf = 0; leaf < 3; ++leaf) {
            const std::uint64_t voxels = 1 + random() % (leaf == 0 ? 3 : 40);
            store.level(0).add_leaf(voxels);
            pieces_of[voxels] |= 1u << piece;
        }
        (void)nodes.merge(store, piece);
    }
    ASSERT_EQ(nodes.store().level(0).count(), pieces_of.size());

    std::array<double, SampledNodes::kPieces> sums{}, ways{};
    for (unsigned chosen = 1; chosen < 1u << SampledNodes::kPieces; ++chosen) {
        const auto k = static_cast<unsigned>(std::popcount(chosen)) - 1;
        ways[k] += 1.0;
        for (const auto& [voxels, pieces] : pieces_of) sums[k] += (pieces & chosen) != 0 ? 1 : 0;
    }
    const auto curve = nodes.growth_curve(0);
    for (unsigned k = 0; k < SampledNodes::kPieces; ++k)
        EXPECT_NEAR(curve[k], sums[k] / ways[k], 1e-9) << k + 1;
}

TEST(NodeStore, SaysOfEachNodeThatItMergesWhereItIs) {
    NodeStore whole(1), part(1);
    const std::uint32_t other = whole.level(0).add_leaf(5);
    const std::uint32_t a = part.level(0).add_leaf(7), b = part.level(0).add_leaf(5);
    const std::uint32_t children[8] = {a, b};
    (void)part.level(1).add_interior(0b11, children);
    std::vector<std::pair<int, std::uint32_t>> met;
    const std::uint32_t root =
        whole.merge_root(part, [&](int height, std::uint32_t id) { met.emplace_back(height, id); });
    ASSERT_EQ(met.size(), 3u);
    EXPECT_EQ(met[0], std::pair(0, 2u));
    EXPECT_EQ(met[1], std::pair(0, other));
    EXPECT_EQ(met[2], std::pair(1, root));
}

}  // namespace
}  // namespace octavo
