// SPDX-License-Identifier: MIT
#include "octavo/voxelize/triangle_source.h"

#include <gtest/gtest.h>

#include "octavo/core/error.h"
#include "octavo/core/memory.h"
#include "support/random_scene.h"
#include "support/sanitized.h"
#include "voxelize/brute_force.h"
#include "voxelize/voxel_set.h"

namespace octavo {
namespace {

using test::brute_force_voxels;
using test::random_scene;
using test::VoxelSet;

VoxelSet voxels_of(const Scene& scene, const Grid& grid, VoxelRule rule, int tile_depth) {
    return test::voxels_of(TriangleSource(scene, grid, rule, tile_depth));
}

Grid cube(const Scene& scene, int depth) {
    return smallest_cube(scene.bounds(), depth);
}

Scene one_triangle(const dvec3& a, const dvec3& b, const dvec3& c) {
    Scene scene;
    scene.positions = {a, b, c};
    scene.triangles = {{0, 1, 2}};
    return scene;
}

class TriangleSourceByRule : public testing::TestWithParam<VoxelRule> {};
INSTANTIATE_TEST_SUITE_P(Rules, TriangleSourceByRule,
                         testing::Values(VoxelRule::conservative, VoxelRule::thin),
                         [](const auto& rule) { return std::string(name(rule.param)); });

TEST_P(TriangleSourceByRule, EqualsBruteForceOnRandomScenes) {
    for (std::uint64_t seed = 1; seed <= (test::kSanitized ? 2 : 12); ++seed) {
        const Scene scene = random_scene(seed, 40);
        for (const int depth : {2, 3, 5, 6}) {
            if (test::kSanitized && depth == 6) continue;
            const Grid grid = cube(scene, depth);
            EXPECT_EQ(voxels_of(scene, grid, GetParam(), depth),
                      brute_force_voxels(scene, grid, GetParam()))
                << "seed " << seed << ", depth " << depth;
        }
    }
}

TEST_P(TriangleSourceByRule, EqualsBruteForceForEachTriangleAlone) {
    // Whole scenes hide a voxel that one triangle loses and another finds.
    const Scene all = random_scene(99, test::kSanitized ? 40 : 400);
    const Grid grid = cube(all, test::kSanitized ? 5 : 6);
    for (std::size_t i = 0; i < all.triangles.size(); ++i) {
        const auto [a, b, c] = all.corners(i);
        const Scene scene = one_triangle(a, b, c);
        ASSERT_EQ(voxels_of(scene, grid, GetParam(), grid.depth),
                  brute_force_voxels(scene, grid, GetParam()))
            << "triangle " << i;
    }
}

TEST_P(TriangleSourceByRule, EqualsBruteForceAtTheGreatestDepth) {
    // Small triangles far from the origin of a 131072^3 grid, where products need all their bits.
    const Scene patch = random_scene(7, 60);
    Scene scene;
    scene.triangles = patch.triangles;
    for (const dvec3& p : patch.positions) scene.positions.push_back(p * 24.0 + 100000.0);
    scene.positions.insert(scene.positions.end(), {{0, 0, 0}, {131072, 131072, 131072}, {0, 0, 0}});
    const Grid grid{dvec3(0.0), 1.0, 17};
    // Not a triangle, so the bounds are the patch's and the fraction is finer than at full extent.
    EXPECT_EQ(voxels_of(scene, grid, GetParam(), 8), brute_force_voxels(scene, grid, GetParam()));
}

TEST_P(TriangleSourceByRule, DoesNotDependOnTheTileSize) {
    const Scene scene = random_scene(3, 60);
    const Grid grid = cube(scene, 6);
    const VoxelSet whole = voxels_of(scene, grid, GetParam(), 6);
    for (const int tile_depth : {2, 3, 4, 5})
        EXPECT_EQ(voxels_of(scene, grid, GetParam(), tile_depth), whole) << "tile " << tile_depth;
}

TEST_P(TriangleSourceByRule, IsTheSameOnEverySimdTarget) {
    const Scene scene = random_scene(5, 200);
    const Grid grid = cube(scene, 7);
    std::vector<VoxelSet> results;
    for (const char* target : simd_targets()) {
        force_simd_target(target);
        results.push_back(voxels_of(scene, grid, GetParam(), 5));
        EXPECT_EQ(results.back(), results.front()) << target;
    }
    force_simd_target(nullptr);
    EXPECT_GE(results.size(), 2u) << "this machine has only one target: nothing was compared";
}

TEST_P(TriangleSourceByRule, ASceneLargerThanTheGridIsCutAtTheGrid) {
    const Scene scene = random_scene(11, 40);
    const Grid grid{dvec3(0.30), 0.4 / 32, 5};
    EXPECT_EQ(voxels_of(scene, grid, GetParam(), 3), brute_force_voxels(scene, grid, GetParam()));
}

TEST_P(TriangleSourceByRule, AGiantTriangleMarksTheGridThatItCrosses) {
    // z = 8 exactly, reaching 10^9 voxels away on all sides: far beyond what 32 bits could hold.
    const Scene scene = one_triangle({-1e9, -1e9, 8}, {2e9, -1e9, 8}, {0, 2e9, 8});
    const Grid grid{dvec3(0.0), 1.0, 4};
    const VoxelSet voxels = voxels_of(scene, grid, GetParam(), 4);
    EXPECT_EQ(voxels.size(), 2u * 16 * 16) << "two layers: the plane lies between them";
}

TEST(TriangleSource, ThinIsWithinConservative) {
    const Scene scene = random_scene(21, 150);
    const Grid grid = cube(scene, 6);
    const VoxelSet thin = voxels_of(scene, grid, VoxelRule::thin, 6);
    const VoxelSet conservative = voxels_of(scene, grid, VoxelRule::conservative, 6);
    EXPECT_LT(thin.size(), conservative.size());
    EXPECT_TRUE(std::includes(conservative.begin(), conservative.end(), thin.begin(), thin.end()));
}

TEST(TriangleSource, ThinLetsNoAxisParallelLineThrough) {
    // 6-separating: a line of voxels along an axis cannot cross the triangle without meeting it.
    const Scene scene = one_triangle({-100, -90, 3.3}, {100, -80, 29.1}, {3, 110, 12.7});
    const Grid grid{dvec3(0.0), 1.0, 5};
    const VoxelSet voxels = voxels_of(scene, grid, VoxelRule::thin, 5);
    std::set<std::pair<std::uint32_t, std::uint32_t>> columns;
    for (const auto& [x, y, z] : voxels) columns.emplace(x, y);
    EXPECT_EQ(columns.size(), 32u * 32);
}

TEST(TriangleSource, ADegenerateTriangleMarksWhatItMeets) {
    const Grid grid{dvec3(0.0), 1.0, 4};
    for (const VoxelRule rule : {VoxelRule::conservative, VoxelRule::thin}) {
        const Scene point = one_triangle(dvec3(2.5), dvec3(2.5), dvec3(2.5));
        EXPECT_EQ(voxels_of(point, grid, rule, 4), (VoxelSet{{2, 2, 2}}));
        const Scene corner = one_triangle(dvec3(4), dvec3(4), dvec3(4));
        EXPECT_EQ(voxels_of(corner, grid, rule, 4).size(), 8u) << "eight voxels share that corner";
        const Scene segment = one_triangle({0.5, 3.5, 3.5}, {9.5, 3.5, 3.5}, {4.0, 3.5, 3.5});
        EXPECT_EQ(voxels_of(segment, grid, rule, 4).size(), 10u);
    }
}

TEST(TriangleSource, ALongSegmentAlongAnAxisIsOneVoxelThick) {
    // Its shadow along the axis is a point, which once passed for a shadow that everything is
    // inside.
    const Grid grid{dvec3(0.0), 1.0, 8};
    for (int axis = 0; axis < 3; ++axis)
        for (const VoxelRule rule : {VoxelRule::conservative, VoxelRule::thin}) {
            dvec3 end(3.5);
            end[axis] = 200.5;
            const Scene segment = one_triangle(dvec3(3.5), end, end);
            EXPECT_EQ(voxels_of(segment, grid, rule, 8).size(), 198u) << "axis " << axis;
        }
}

TEST(TriangleSource, NonFiniteTrianglesAreCountedAndNotVoxelized) {
    Scene scene = random_scene(1, 10);
    const VoxelSet before = voxels_of(scene, cube(scene, 5), VoxelRule::conservative, 5);
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(),
                           {{0.5, 0.5, std::nan("")}, {0.1, 0.2, 0.3}, {INFINITY, 0, 0}});
    scene.triangles.emplace_back(0, 1, first);
    scene.triangles.emplace_back(first + 1, first + 2, 0);
    const Grid grid = cube(scene, 5);
    EXPECT_EQ(voxels_of(scene, grid, VoxelRule::conservative, 5), before);
    EXPECT_EQ(FixedMesh(scene, grid).non_finite_triangles(), 2u);
}

TEST(TriangleSource, GivesBackWhatItKeepsForTilesThatItMayForget) {
    const Scene scene = random_scene(5, 200'000);
    TriangleSource source(scene, cube(scene, 7), VoxelRule::conservative, 4);
    const std::size_t middle = source.tiles().size() / 2;
    TileOctree before, after;
    source.voxelize(middle, before);
    std::uint64_t kept = 0;
    for (std::size_t i = 0; i < middle; ++i) kept += source.triangles(i).size_bytes();
    ASSERT_GT(kept, 4u << 20);

    const std::uint64_t resident = resident_bytes();
    for (std::size_t i = 0; i <= middle; ++i) source.forget_before(i);
    EXPECT_LT(resident_bytes() + kept / 2, resident);
    source.voxelize(middle, after);
    EXPECT_EQ(after.leaves, before.leaves);
}

TEST(TriangleSource, RefusesATileThatDoesNotSuitTheGrid) {
    const Scene scene = random_scene(1, 4);
    EXPECT_THROW(TriangleSource(scene, cube(scene, 5), VoxelRule::thin, 6), Error);
    EXPECT_THROW(TriangleSource(scene, cube(scene, 17), VoxelRule::thin, 6), Error);
    EXPECT_THROW(TriangleSource(scene, cube(scene, 17), VoxelRule::thin, 11), Error);
}

}  // namespace
}  // namespace octavo
