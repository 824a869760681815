// SPDX-License-Identifier: MIT
#include "octavo/dag/statistics.h"

#include <gtest/gtest.h>

#include "support/small_dags.h"

namespace octavo {
namespace {

TEST(Statistics, CountsPathsByVisitingNodes) {
    // 2^51 voxels behind 137 words: anything that walked paths would not come back.
    const Statistics s = compute_statistics(test::full_grid(17));
    EXPECT_EQ(s.voxels, std::uint64_t{1} << 51);
    EXPECT_EQ(s.dag_nodes, 16u);
    EXPECT_EQ(s.levels[16].svo_nodes, std::uint64_t{1} << 48);
    EXPECT_EQ(s.dag_bytes, (15u * 9 + 2) * 4);
}

TEST(Statistics, ASingleLeafIsAGridOfDepthTwo) {
    const Dag dag(2, {0, 2}, {0x00000101u, 0x80000000u});
    const Statistics s = compute_statistics(dag);
    EXPECT_EQ(s.voxels, 3u);
    EXPECT_EQ(s.levels[0].svo_nodes, 1u);
    EXPECT_EQ(s.levels[1].svo_nodes, 3u);
    EXPECT_TRUE(dag.voxel({0, 0, 0}));
    EXPECT_TRUE(dag.voxel({3, 3, 3}));
    EXPECT_FALSE(dag.voxel({1, 0, 0}));
    EXPECT_FALSE(dag.voxel({4, 0, 0}));
}

TEST(Statistics, AnEmptyDagHoldsNothing) {
    const Statistics s = compute_statistics(Dag());
    EXPECT_EQ(s.voxels, 0u);
    EXPECT_EQ(s.svo_nodes, 0u);
    EXPECT_EQ(s.bits_per_voxel(), 0.0);
}

}  // namespace
}  // namespace octavo
