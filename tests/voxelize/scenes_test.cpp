// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "octavo/mesh/load.h"
#include "octavo/mesh/samples.h"
#include "octavo/voxelize/triangle_source.h"
#include "support/sanitized.h"
#include "support/shared_scenes.h"
#include "voxelize/brute_force.h"
#include "voxelize/voxel_set.h"

namespace octavo {
namespace {

// Under a sanitizer brute force would take minutes.
constexpr int kDepth = test::kSanitized ? 6 : 8;

/// One tile as large as the grid: windows of every size are used.
void expect_brute_force_voxels(const Scene& scene, int depth, int tile_depth) {
    const Grid grid = smallest_cube(scene.bounds(), depth);
    for (const VoxelRule rule : {VoxelRule::conservative, VoxelRule::thin}) {
        const test::VoxelSet expected = test::brute_force_voxels(scene, grid, rule);
        const test::VoxelSet found = test::voxels_of(TriangleSource(scene, grid, rule, tile_depth));
        EXPECT_EQ(found.size(), expected.size()) << name(rule);
        EXPECT_TRUE(found == expected) << name(rule);
    }
}

TEST(ScenesAt256, BuiltInOnesEqualBruteForceVoxelByVoxel) {
    for (const auto& [name, size] :
         {std::pair("courtyard", 0.02), std::pair("hairball", 0.0005), std::pair("city", 0.005)})
        expect_brute_force_voxels(make_sample(name, size), kDepth, kDepth);
}

TEST(ScenesAt256, SponzaEqualsBruteForceVoxelByVoxel) {
    OCTAVO_REQUIRE_SCENE("sponza/Sponza.gltf");
    expect_brute_force_voxels(load_scene(test::shared_scenes() / "sponza/Sponza.gltf"), kDepth,
                              kDepth);
}

}  // namespace
}  // namespace octavo
