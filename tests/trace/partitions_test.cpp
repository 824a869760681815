// SPDX-License-Identifier: MIT
#include "octavo/trace/partitions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <vector>

#include "octavo/dag/node.h"
#include "support/small_dags.h"

namespace octavo {
namespace {

constexpr int kBlocks = Partitions::kBlocks;

/// The empty parts of a cube of voxels by a flood, voxel by voxel: the number of each, 0 where
/// full.
std::vector<int> flood(const Dag& dag, const uvec3& corner, int side) {
    const auto place = [&](const ivec3& v) {
        return static_cast<std::size_t>(v.x + side * (v.y + side * v.z));
    };
    std::vector<int> part(static_cast<std::size_t>(side) * side * side, -1);
    int parts = 0;
    for (int i = 0; i < side * side * side; ++i) {
        const ivec3 seed(i % side, i / side % side, i / side / side);
        if (part[place(seed)] >= 0) continue;
        std::vector<ivec3> waiting{seed};
        const bool full = dag.voxel(corner + uvec3(seed));
        part[place(seed)] = full ? 0 : ++parts;
        if (full) continue;
        while (!waiting.empty()) {
            const ivec3 at = waiting.back();
            waiting.pop_back();
            for (int k = 0; k < 27; ++k) {
                const ivec3 next = at + ivec3(k % 3, k / 3 % 3, k / 9) - 1;
                if (std::min({next.x, next.y, next.z}) < 0 ||
                    std::max({next.x, next.y, next.z}) >= side || part[place(next)] >= 0)
                    continue;
                const bool filled = dag.voxel(corner + uvec3(next));
                part[place(next)] = filled ? 0 : parts;
                if (!filled) waiting.push_back(next);
            }
        }
    }
    return part;
}

/// Which parts of the empty space have voxels on a face in each block.
std::array<std::set<int>, Partitions::kTableBytes> parts_at_faces(const Dag& dag,
                                                                  const uvec3& corner, int side) {
    const std::vector<int> part = flood(dag, corner, side);
    std::array<std::set<int>, Partitions::kTableBytes> at;
    for (int z = 0; z < side; ++z)
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const int number = part[static_cast<std::size_t>(x + side * (y + side * z))];
                const auto at_end = [&](int i) { return i == 0 || i == side - 1; };
                if (number == 0 || !(at_end(x) || at_end(y) || at_end(z))) continue;
                const auto block = [&](int i) { return i * kBlocks / side; };
                at[static_cast<std::size_t>(block(x) + kBlocks * (block(y) + kBlocks * block(z)))]
                    .insert(number);
            }
    return at;
}

/// Each node of the height, and a cell where it stands.
void for_each_node(const Dag& dag, int height, const auto& visit) {
    std::set<std::uint32_t> seen;
    const auto walk = [&](const auto& self, std::uint32_t node, int at, const uvec3& corner) {
        if (at == height) {
            if (seen.insert(node).second) visit(node, corner);
            return;
        }
        const std::uint32_t children = dag.words()[node];
        for (int i = 0; i < 8; ++i)
            if ((children >> i & 1) != 0)
                self(self,
                     dag.words()[node + static_cast<std::uint32_t>(child_offset(children, i))],
                     at - 1, corner + (uvec3(i & 1, i >> 1 & 1, i >> 2) << (at - 1u)));
    };
    walk(walk, 0, dag.depth(), uvec3(0));
}

TEST(Partitions, SayWhatAFloodOfTheVoxelsSays) {
    int apart = 0, connected = 0;
    for (const int height : {3, 4, 5, 6})
        for (const Dag& dag :
             {test::dust(7, 0.5, 3), test::dust(7, 0.85, 4), test::slanted_wall(7, {3, -5, 7}, 250),
              test::slanted_wall(7, {0, 0, 1}, 50), test::slanted_wall(7, {1, 1, 1}, 130),
              test::full_grid(7)}) {
            Partitions partitions(dag, height);
            partitions.make_all();
            for_each_node(dag, height, [&](std::uint32_t node, const uvec3& corner) {
                const std::uint8_t* table = partitions.find(node, 0);
                ASSERT_NE(table, nullptr);
                const auto parts = parts_at_faces(dag, corner, 1 << height);
                std::set<int> all;
                for (const auto& some : parts) all.insert(some.begin(), some.end());
                for (std::size_t i = 0; i < parts.size(); ++i)
                    for (std::size_t k = i; k < parts.size(); k += 7) {
                        std::vector<int> common;
                        std::ranges::set_intersection(parts[i], parts[k],
                                                      std::back_inserter(common));
                        // From the eighth part on they share a bit.
                        const bool meet = (table[i] & table[k]) != 0;
                        if (!common.empty()) {
                            ASSERT_TRUE(meet) << height << " " << i << " " << k;
                        } else if (all.size() <= 8) {
                            ASSERT_FALSE(meet) << height << " " << i << " " << k;
                        }
                        ++(meet ? connected : apart);
                    }
            });
        }
    EXPECT_GT(apart, 10000);
    EXPECT_GT(connected, 10000);
}

TEST(Partitions, OtherHeightsHaveNone) {
    const Dag dag = test::dust(9, 0.6, 1);
    for (const int height : {-1, 0, 2, 9, 10}) {
        Partitions partitions(dag, height);
        partitions.make_all();
        EXPECT_EQ(partitions.height(), 0);
        EXPECT_EQ(partitions.count(), 0u);
    }
    EXPECT_EQ(Partitions(test::SmallDagBuilder(9).freeze(0)).height(), 0);
}

std::uint64_t may_take(const Dag& dag) {
    return std::max<std::uint64_t>(dag.size_bytes() / 2, 128 << 10);
}

TEST(Partitions, TakeNoMoreThanTheyMay) {
    for (int depth = 4; depth <= 9; ++depth) {
        const Dag dag = test::dust(depth, 0.6, 2);
        for (int height = 3; height < depth; ++height) {
            Partitions partitions(dag, height);
            partitions.make_all();
            EXPECT_LE(partitions.size_bytes(), may_take(dag)) << depth << " " << height;
        }
    }
}

/// A full tree over 8^4 nodes of height 3, all of them different.
Dag many_nodes() {
    constexpr int kDepth = 7;
    std::mt19937 random(5);
    test::SmallDagBuilder builder(kDepth);
    std::vector<std::uint32_t> leaves(48);
    for (std::uint32_t& leaf : leaves) leaf = builder.leaf(random() | std::uint64_t{1} << 63);
    const auto tree = [&](const auto& self, int level) -> std::uint32_t {
        std::array<std::uint32_t, 8> children{};
        for (std::uint32_t& child : children)
            child = level == kDepth - 3 ? leaves[random() % leaves.size()] : self(self, level + 1);
        return builder.node(level, children);
    };
    return builder.freeze(tree(tree, 0));
}

TEST(Partitions, LeaveNodesWithoutTablesWhereTheyWouldTakeMore) {
    const Dag dag = many_nodes();
    std::size_t nodes = 0;
    for_each_node(dag, 3, [&](std::uint32_t, const uvec3&) { ++nodes; });
    ASSERT_GT(nodes * Partitions::kTableBytes, 10 * may_take(dag));
    Partitions partitions(dag, 3);
    partitions.make_all();
    EXPECT_LE(partitions.size_bytes(), may_take(dag));
    EXPECT_GT(partitions.size_bytes() + 2 * Partitions::kTableBytes, may_take(dag));
}

}  // namespace
}  // namespace octavo
