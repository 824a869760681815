// SPDX-License-Identifier: MIT
#include "octavo/construct/construct.h"

#include <gtest/gtest.h>

#include <bit>
#include <set>

#include "octavo/construct/build.h"
#include "octavo/construct/node_store.h"
#include "octavo/core/morton.h"
#include "octavo/dag/statistics.h"
#include "octavo/mesh/samples.h"
#include "octavo/voxelize/triangle_source.h"
#include "support/random_scene.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

using test::random_scene;

BuildOptions at_depth(int depth) {
    BuildOptions options;
    options.depth = depth;
    return options;
}

bool same_dag(const Dag& a, const Dag& b) {
    return a.depth() == b.depth() && std::ranges::equal(a.level_begins(), b.level_begins()) &&
           std::ranges::equal(a.words(), b.words());
}

/// Everything that a builder could get wrong, counted from the voxels and not from the DAG.
struct Octree {
    std::vector<std::uint64_t> nodes;  // for each level
    std::uint64_t voxels = 0;

    Octree(const Scene& scene, const Grid& grid) : nodes(static_cast<unsigned>(grid.depth)) {
        const TriangleSource source(scene, grid, VoxelRule::conservative, grid.depth);
        TileOctree octree;
        for (std::size_t i = 0; i < source.tiles().size(); ++i) {
            source.voxelize(i, octree);
            std::vector<std::set<std::uint64_t>> cells(nodes.size());
            for (const LeafBlock& leaf : blocks_of(octree, grid.depth - 2)) {
                voxels += static_cast<unsigned>(std::popcount(leaf.voxels));
                for (std::uint64_t b = 0; b < 64; ++b)
                    if (leaf.voxels >> b & 1u)
                        for (std::size_t l = 0; l < cells.size(); ++l)
                            cells[l].insert((leaf.code * 64 + b) >> 3 * (cells.size() - l));
            }
            for (std::size_t l = 0; l < cells.size(); ++l) nodes[l] += cells[l].size();
        }
    }
};

TEST(Build, HoldsExactlyTheVoxelsOfItsSource) {
    for (const int depth : {2, 3, 4, 6}) {
        const Scene scene = random_scene(4, 30);
        const BuildResult built = build(scene, at_depth(depth));
        const TriangleSource source(scene, built.grid, VoxelRule::conservative, depth);
        TileOctree octree;
        source.voxelize(0, octree);
        std::vector<std::uint64_t> dense(std::size_t{1} << 3 * (depth - 2));
        for (const LeafBlock& leaf : blocks_of(octree, depth - 2)) dense[leaf.code] = leaf.voxels;
        for (std::uint64_t code = 0; code < std::uint64_t{1} << 3 * depth; ++code)
            ASSERT_EQ(built.dag.voxel(morton_decode(code)),
                      (dense[code >> 6] >> (code & 63u) & 1u) != 0)
                << "depth " << depth << ", voxel " << code;
    }
}

TEST(Build, StatisticsEqualThoseOfTheOctree) {
    const Scene scene = random_scene(6, 30);
    const BuildResult built = build(scene, at_depth(6));
    const Statistics statistics = compute_statistics(built.dag);
    const Octree octree(scene, built.grid);
    EXPECT_EQ(statistics.voxels, octree.voxels);
    for (std::size_t l = 0; l < octree.nodes.size(); ++l)
        EXPECT_EQ(statistics.levels[l].svo_nodes, octree.nodes[l]) << "level " << l;
    EXPECT_EQ(statistics.dag_bytes, built.dag.size_bytes());
}

TEST(Build, NoTwoNodesOfALevelAreEqual) {
    const Dag dag = build(random_scene(8, 80), at_depth(8)).dag;
    for (int l = 0; l <= dag.leaf_level(); ++l) {
        std::set<std::vector<std::uint32_t>> seen;
        for (std::uint64_t i = dag.level_begin(l); i < dag.level_begin(l + 1);) {
            const auto size = static_cast<unsigned>(
                l == dag.leaf_level() ? kLeafWords : node_words(dag.words()[i]));
            const auto node = dag.words().subspan(i, size);
            EXPECT_TRUE(seen.emplace(node.begin(), node.end()).second) << "level " << l;
            i += size;
        }
    }
}

TEST(Build, NodesStandInTheOrderInWhichTheTreeFirstMeetsThem) {
    const Dag dag = build(random_scene(9, 80), at_depth(8)).dag;
    for (int l = 0; l < dag.leaf_level(); ++l) {
        std::uint64_t newest = 0;
        bool any = false;
        for (std::uint64_t i = dag.level_begin(l); i < dag.level_begin(l + 1);) {
            const auto size = static_cast<unsigned>(node_words(dag.words()[i]));
            for (unsigned k = 1; k < size; ++k) {
                const std::uint64_t child = dag.words()[i + k];
                if (any && child <= newest) continue;
                const std::uint64_t expected =
                    !any ? dag.level_begin(l + 1)
                         : newest + static_cast<unsigned>(l + 1 == dag.leaf_level()
                                                              ? kLeafWords
                                                              : node_words(dag.words()[newest]));
                ASSERT_EQ(child, expected) << "level " << l;
                newest = child;
                any = true;
            }
            i += size;
        }
    }
}

TEST(Build, GivesTheSameWordsForEveryTileAndThreadCount) {
    const Scene scene = random_scene(10, 300);
    const BuildResult expected = build(scene, at_depth(8));
    for (const std::uint32_t tile : {4u, 16u, 32u, 128u, 256u})
        for (const int threads : {1, 2, 7}) {
            BuildOptions options = at_depth(8);
            options.tile = tile;
            options.threads = threads;
            EXPECT_TRUE(same_dag(build(scene, options).dag, expected.dag))
                << "tile " << tile << ", threads " << threads;
        }
}

TEST(Build, GivesTheSameWordsWhateverIsExpected) {
    const Scene scene = random_scene(9, 300);
    BuildOptions options = at_depth(7);
    const Dag expected = build(scene, options).dag;
    const std::uint64_t many = 3'000'000;
    const std::vector<std::uint64_t> right = {1, 8, 60, 400, 3000, 9000};
    for (const auto& nodes : {right,
                              {many},
                              {many, many, many, many, many, many, many, many, many},
                              std::vector<std::uint64_t>(6, 0)}) {
        options.expected_nodes = nodes;
        EXPECT_TRUE(same_dag(build(scene, options).dag, expected));
    }
}

TEST(Build, DoesNotDependOnTheOrderOfTriangles) {
    Scene scene = random_scene(12, 200);
    const BuildResult expected = build(scene, at_depth(8));
    std::reverse(scene.triangles.begin(), scene.triangles.end());
    EXPECT_TRUE(same_dag(build(scene, at_depth(8)).dag, expected.dag));
}

TEST(Build, ABoxThatNoTriangleMeetsGivesAnEmptyDag) {
    BuildOptions options;
    options.grid = Grid{dvec3(50.0), 0.1, 6};
    const BuildResult built = build(random_scene(1, 10), options);
    EXPECT_TRUE(built.dag.empty());
    EXPECT_EQ(built.dag.depth(), 6);
    EXPECT_EQ(compute_statistics(built.dag).voxels, 0u);
}

TEST(Build, RefusesASceneWithoutBounds) {
    EXPECT_THROW((void)build(Scene(), at_depth(5)), Error);
}

TEST(Build, StopsWhenProgressSaysSo) {
    BuildOptions options = at_depth(9);
    options.tile = 16;
    options.progress = [](const Progress& p) { return p.done < 5; };
    try {
        (void)build(random_scene(2, 100), options);
        FAIL() << "it went on";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Errc::cancelled);
    }
}

TEST(Build, StopsAtTheMemoryCapAndSaysSo) {
    BuildOptions options = at_depth(8);
    options.max_memory_bytes = 1 << 20;  // less than any process holds
    try {
        (void)build(random_scene(2, 100), options);
        FAIL() << "it went on";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Errc::limit);
    }
}

TEST(LevelBegins, MoreThan2To32WordsAreRefusedAndNotWrapped) {
    constexpr std::uint64_t kHalf = std::uint64_t{1} << 31;
    const std::vector<std::uint64_t> fits = {9, kHalf - 9, kHalf};
    EXPECT_EQ(level_begins(fits), (std::vector<std::uint64_t>{0, 9, kHalf, 2 * kHalf}));
    try {
        (void)level_begins(std::vector<std::uint64_t>{9, kHalf, kHalf});
        FAIL() << "it was let through";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Errc::limit);
        EXPECT_NE(std::string(e.what()).find("4294967305 words"), std::string::npos) << e.what();
    }
}

/// What construct() ends in when there are fewer words than the DAG takes; "" where it ends well.
std::string refusal(const Scene& scene, const WordLimits& words, std::uint64_t max_store_bytes,
                    std::uint64_t max_memory_bytes) {
    constexpr int kDepth = 10, kTileDepth = 6;
    const Grid grid = smallest_cube(scene.bounds(), kDepth);
    TriangleSource source(scene, grid, VoxelRule::conservative, kTileDepth);
    const test::TemporaryFolder folder;
    Scratch scratch(folder / "s", 1, kTileDepth - 2);
    ConstructOptions options;
    options.max_store_bytes = max_store_bytes;
    options.max_memory_bytes = max_memory_bytes;
    options.words = words;
    try {
        const Constructed built = construct(source, kDepth, options, scratch);
        scratch.remove();
        return "";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Errc::limit);
        return error.what();
    }
}

TEST(WordLimits, ALevelOrADagWithMoreWordsThanCanBeNamedIsRefusedHoweverItIsBuilt) {
    const Scene scene = make_sample("hairball", 0.05);
    const BuildResult built = build(scene, at_depth(10));
    std::uint64_t largest = 0;
    for (const auto& level : built.statistics.levels) largest = std::max(largest, level.bytes / 4);
    const std::uint64_t all = built.dag.words().size();
    ASSERT_GT(largest, 200'000u) << "too few words for a merge in pieces";

    // In memory; spilled, and then merged in memory, or level by level in pieces.
    const std::uint64_t roomy = std::uint64_t{1} << 40;
    for (const auto& [store_bytes, cap] :
         {std::pair<std::uint64_t, std::uint64_t>{0, 0}, {300'000, roomy}, {300'000, 0}}) {
        EXPECT_EQ(refusal(scene, {largest, all}, store_bytes, cap), "");
        const std::string level = refusal(scene, {largest - 1, all}, store_bytes, cap);
        EXPECT_NE(level.find("a level of the DAG needs"), std::string::npos) << level;
        EXPECT_NE(level.find("at most " + std::to_string(largest - 1)), std::string::npos) << level;
        const std::string dag = refusal(scene, {largest, all - 1}, store_bytes, cap);
        EXPECT_NE(dag.find("the DAG needs at least " + std::to_string(all) + " words"),
                  std::string::npos)
            << dag;
    }
}

}  // namespace
}  // namespace octavo
