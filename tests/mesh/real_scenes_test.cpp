// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>

#include "mesh/mesh_files.h"
#include "support/shared_scenes.h"

namespace octavo {
namespace {

TEST(RealScenes, SponzaHasItsTrianglesMaterialsAndTextures) {
    OCTAVO_REQUIRE_SCENE("sponza/Sponza.gltf");
    const Scene scene = load_scene(test::shared_scenes() / "sponza/Sponza.gltf");
    EXPECT_EQ(scene.triangles.size(), 262267u);
    EXPECT_EQ(scene.materials.size(), 25u);
    EXPECT_EQ(scene.texture_coordinates.size(), scene.positions.size());
    EXPECT_EQ(std::count_if(scene.materials.begin(), scene.materials.end(),
                            [](const Material& m) { return m.alpha_cutoff.has_value(); }),
              3);
    const dvec3 size = scene.bounds().size();
    EXPECT_NEAR(size.x, 29.8, 0.05);
    EXPECT_NEAR(size.y, 12.4, 0.05);
    EXPECT_NEAR(size.z, 18.3, 0.05);
}

TEST(RealScenes, BathroomHasOneLamp) {
    OCTAVO_REQUIRE_SCENE("bathroom2/bathroom2.gltf");
    const Scene scene = load_scene(test::shared_scenes() / "bathroom2/bathroom2.gltf");
    EXPECT_EQ(scene.triangles.size(), 1016615u);
    EXPECT_EQ(std::count_if(scene.materials.begin(), scene.materials.end(),
                            [](const Material& m) { return m.emission != vec3(0.0f); }),
              1);
}

TEST(RealScenes, BunnyAndDragonHaveTheirTriangles) {
    OCTAVO_REQUIRE_SCENE("bunny/bun_zipper.ply");
    OCTAVO_REQUIRE_SCENE("dragon/dragon_vrip.ply.gz");
    const auto folder = test::shared_scenes();
    EXPECT_EQ(load_scene(folder / "bunny/bun_zipper.ply").triangles.size(), 69451u);
    EXPECT_EQ(load_scene(folder / "dragon/dragon_vrip.ply.gz").triangles.size(), 871414u);
}

TEST(RealScenes, TerrainKeepsTheNamesOfItsLandCover) {
    OCTAVO_REQUIRE_SCENE("terrain/2598528.obj");
    const Scene scene = load_scene(test::shared_scenes() / "terrain/2598528.obj");
    EXPECT_EQ(scene.triangles.size(), 297818u);
    EXPECT_EQ(scene.materials.size(), 17u);
}

}  // namespace
}  // namespace octavo
