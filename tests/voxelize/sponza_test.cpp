// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "octavo/mesh/load.h"
#include "octavo/voxelize/triangle_source.h"
#include "support/shared_scenes.h"
#include "voxelize/brute_force.h"
#include "voxelize/voxel_set.h"

namespace octavo {
namespace {

TEST(SponzaAt256, EqualsBruteForceVoxelByVoxel) {
    OCTAVO_REQUIRE_SCENE("sponza/Sponza.gltf");
    const Scene scene = load_scene(test::shared_scenes() / "sponza/Sponza.gltf");
    const Grid grid = smallest_cube(scene.bounds(), 8);
    for (const VoxelRule rule : {VoxelRule::conservative, VoxelRule::thin}) {
        const test::VoxelSet expected = test::brute_force_voxels(scene, grid, rule);
        const test::VoxelSet found = test::voxels_of(TriangleSource(scene, grid, rule, 6));
        EXPECT_EQ(found.size(), expected.size()) << name(rule);
        EXPECT_TRUE(found == expected) << name(rule);
    }
}

}  // namespace
}  // namespace octavo
