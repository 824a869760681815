// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "octavo/construct/build.h"
#include "octavo/construct/merge_parts.h"
#include "octavo/construct/scratch.h"
#include "octavo/mesh/samples.h"
#include "octavo/voxelize/spilled_triangles.h"
#include "octavo/voxelize/triangle_source.h"
#include "support/random_scene.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

using test::TemporaryFolder;

bool same_words(const Dag& a, const Dag& b) {
    return a.depth() == b.depth() && std::ranges::equal(a.words(), b.words()) &&
           std::ranges::equal(a.level_begins(), b.level_begins());
}

BuildOptions at_depth(int depth) {
    BuildOptions options;
    options.depth = depth;
    return options;
}

void expect_equal(const Statistics& a, const Statistics& b) {
    EXPECT_EQ(a.voxels, b.voxels);
    EXPECT_EQ(a.svo_nodes, b.svo_nodes);
    EXPECT_EQ(a.dag_nodes, b.dag_nodes);
    EXPECT_EQ(a.dag_bytes, b.dag_bytes);
    ASSERT_EQ(a.levels.size(), b.levels.size());
    for (std::size_t l = 0; l < a.levels.size(); ++l) {
        EXPECT_EQ(a.levels[l].level, b.levels[l].level);
        EXPECT_EQ(a.levels[l].svo_nodes, b.levels[l].svo_nodes) << l;
        EXPECT_EQ(a.levels[l].dag_nodes, b.levels[l].dag_nodes) << l;
        EXPECT_EQ(a.levels[l].bytes, b.levels[l].bytes) << l;
    }
}

TEST(Spill, GivesTheSameWordsHoweverLittleIsHeldInMemory) {
    for (const auto& [name, size, depth] :
         {std::tuple("courtyard", 0.2, 10), std::tuple("hairball", 0.01, 9),
          std::tuple("scan", 0.01, 10), std::tuple("city", 0.1, 10)}) {
        const Scene scene = make_sample(name, size);
        const BuildResult expected = build(scene, at_depth(depth));
        expect_equal(expected.statistics, compute_statistics(expected.dag));
        for (const std::uint64_t node_bytes : {20'000u, 300'000u, 4'000'000u}) {
            const TemporaryFolder folder;
            BuildOptions options = at_depth(depth);
            options.tile = 64;
            options.scratch = folder / "s";
            options.spill = {.node_bytes = node_bytes, .triangle_bytes = node_bytes};
            const BuildResult spilled = build(scene, options);
            EXPECT_TRUE(same_words(spilled.dag, expected.dag)) << name << ", " << node_bytes;
            expect_equal(spilled.statistics, expected.statistics);
            EXPECT_EQ(spilled.degenerate_triangles, expected.degenerate_triangles);
            EXPECT_EQ(folder.entries(), 0u) << "the scratch is still there";
        }
    }
}

TEST(Spill, AGridThatNoTriangleMeetsAndASingleTileAreNoSpecialCases) {
    const TemporaryFolder folder;
    const Scene scene = test::random_scene(3, 60);
    BuildOptions options = at_depth(6);
    options.scratch = folder / "s";
    options.spill = {.node_bytes = 1, .triangle_bytes = 1};
    EXPECT_TRUE(same_words(build(scene, options).dag, build(scene, at_depth(6)).dag));
    options.grid = Grid{dvec3(50.0), 0.1, 6};
    EXPECT_TRUE(build(scene, options).dag.empty());
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(Spill, TheSceneIsGivenBackOnceItsTrianglesAreOnDisk) {
    const TemporaryFolder folder;
    Scene scene = make_sample("courtyard", 0.05);
    const std::size_t cameras = scene.cameras.size();
    const std::size_t triangles = scene.triangles.size();
    const Dag expected = build(scene, at_depth(8)).dag;
    BuildOptions options = at_depth(8);
    options.scratch = folder / "s";
    options.spill.triangle_bytes = 100'000;
    const BuildResult built = build_and_release(scene, options);
    EXPECT_TRUE(same_words(built.dag, expected));
    EXPECT_EQ(built.triangles, triangles);
    EXPECT_TRUE(scene.triangles.empty());
    EXPECT_TRUE(scene.positions.empty());
    EXPECT_EQ(scene.cameras.size(), cameras);
}

TEST(Build, GivesASceneWithoutHolesBackAndStillBuildsTheSame) {
    Scene scene = make_sample("courtyard", 0.05);
    const std::size_t cameras = scene.cameras.size();
    const Dag expected = build(scene, at_depth(8)).dag;
    EXPECT_TRUE(same_words(build_and_release(scene, at_depth(8)).dag, expected));
    EXPECT_TRUE(scene.triangles.empty());
    EXPECT_TRUE(scene.positions.empty());
    EXPECT_EQ(scene.cameras.size(), cameras);
}

TEST(SpilledTriangles, GiveTheLeavesOfTrianglesInMemory) {
    const TemporaryFolder folder;
    Scene scene = test::random_scene(21, 400);
    scene.positions.push_back(dvec3(std::numeric_limits<double>::quiet_NaN()));
    scene.positions.push_back(dvec3(1e9, 0.3, 0.2));  // is clipped
    const auto count = static_cast<std::uint32_t>(scene.positions.size());
    scene.triangles.push_back({0, 1, count - 2});
    scene.triangles.push_back({0, 1, count - 1});
    const Grid grid{dvec3(-0.1), 1.2 / 256, 8};
    for (const VoxelRule rule : {VoxelRule::conservative, VoxelRule::thin}) {
        const TriangleSource expected(scene, grid, rule, 5);
        const SpilledTriangles spilled(scene, grid, rule, 5, {folder / "triangles", 1});
        EXPECT_GT(spilled.runs(), 1u);
        EXPECT_EQ(spilled.non_finite_triangles(), expected.mesh().non_finite_triangles());
        EXPECT_EQ(spilled.degenerate_triangles(), expected.mesh().degenerate_triangles());
        ASSERT_EQ(spilled.tiles(), expected.tiles());
        TileOctree a, b;
        for (std::size_t i = 0; i < spilled.tiles().size(); ++i) {
            // In any order, as threads ask.
            const std::size_t tile = i * 7919 % spilled.tiles().size();
            spilled.voxelize(tile, a);
            expected.voxelize(tile, b);
            ASSERT_EQ(a.leaves, b.leaves);
            ASSERT_EQ(a.masks, b.masks);
        }
    }
    EXPECT_EQ(folder.entries(), 0u);
}

/// A store with these leaves, each the only child of a node above it.
PartState fill(NodeStore& store, std::vector<CellNode>& roots, std::uint64_t first,
               std::span<const std::uint64_t> leaves) {
    for (const std::uint64_t voxels : leaves) {
        const std::uint32_t leaf = store.level(0).add_leaf(voxels);
        const std::uint32_t words[kMaxNodeWords] = {1u << voxels % 8, leaf};
        const auto code = static_cast<std::uint32_t>(first + roots.size());
        roots.push_back({code, store.level(1).add(words)});
    }
    return {first, first + leaves.size(), {}};
}

TEST(MergeParts, IsWhatOneStoreWouldHoldWhateverTheMemory) {
    constexpr std::uint64_t kKey = 5;
    std::mt19937_64 random(1);
    std::vector<std::uint64_t> leaves(200'000);
    for (std::uint64_t& leaf : leaves) leaf = 1 + random() % 90'000;

    NodeStore whole(1);
    std::vector<CellNode> whole_roots;
    (void)fill(whole, whole_roots, 0, leaves);

    for (const std::uint64_t max_bytes : {0u, 1u, 1'500'000u}) {
        const TemporaryFolder folder;
        std::vector<std::unique_ptr<PartFile>> parts;
        constexpr std::size_t kTilesPerPart = 23'000;
        for (std::size_t first = 0; first < leaves.size(); first += kTilesPerPart) {
            NodeStore store(1);
            std::vector<CellNode> roots;
            const auto piece =
                std::span(leaves).subspan(first, std::min(kTilesPerPart, leaves.size() - first));
            const PartState state = fill(store, roots, first, piece);
            parts.push_back(PartFile::create(folder / std::to_string(first), kKey, 1));
            parts.back()->append(store, state, roots, true);
        }
        const auto merged = PartFile::create(folder / "merged", kKey, 1);
        merge_parts(parts, *merged,
                    {.max_bytes = max_bytes, .scratch = folder.path(), .progress = {}});

        NodeStore restored(1);
        merged->restore(restored);
        EXPECT_TRUE(std::ranges::equal(restored.level(0).words(), whole.level(0).words()));
        EXPECT_TRUE(std::ranges::equal(restored.level(1).words(), whole.level(1).words()));
        EXPECT_TRUE(std::ranges::equal(merged->roots(), whole_roots, [](auto a, auto b) {
            return a.code == b.code && a.node == b.node;
        }));
        EXPECT_EQ(merged->state().end_tile, leaves.size());
        EXPECT_TRUE(merged->closed());
    }
}

TEST(SpillFile, ADamagedBlockIsFoundWhenItIsRead) {
    const TemporaryFolder folder;
    SpillFile file(folder / "words", SpillFile::Kind::lasting);
    WordWriter writer(file, 0);
    for (std::uint32_t i = 0; i < 40'000; ++i) writer.put(i / 7);
    const std::uint64_t end = writer.finish();
    EXPECT_LT(end, 40'000 * sizeof(std::uint32_t)) << "not compressed";

    WordReader reader(file, {{0, end}});
    std::vector<std::uint32_t> words(40'000);
    ASSERT_TRUE(reader.take(words));
    for (std::uint32_t i = 0; i < words.size(); ++i) ASSERT_EQ(words[i], i / 7);
    EXPECT_TRUE(reader.peek(1).empty());
    EXPECT_TRUE(blocks_are_whole(file, {0, end}));

    for (std::uint64_t at = 0; at < end; at += 97) {
        char byte = 0;
        ASSERT_TRUE(file.read(at, &byte, 1));
        const char wrong = static_cast<char>(byte ^ 4);
        file.write(at, &wrong, 1);
        EXPECT_FALSE(blocks_are_whole(file, {0, end})) << at;
        WordReader again(file, {{0, end}});
        EXPECT_THROW((void)again.take(words), Error) << at;
        file.write(at, &byte, 1);
    }
}

}  // namespace
}  // namespace octavo
