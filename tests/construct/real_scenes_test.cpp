// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "octavo/construct/build.h"
#include "octavo/dag/statistics.h"
#include "octavo/mesh/load.h"
#include "support/shared_scenes.h"

namespace octavo {
namespace {

Statistics built_statistics(const char* file, int depth) {
    BuildOptions options;
    options.depth = depth;
    return compute_statistics(build(load_scene(test::shared_scenes() / file), options).dag);
}

TEST(RealScenes, BunnyAt1024EqualsAnotherBuilder) {
    OCTAVO_REQUIRE_SCENE("bunny/bun_zipper.ply");
    // SymVox's builder: 3 592 024 voxels, 1.198 M octree nodes, 110 k nodes with 4x4x4 leaves
    // counted once; its cube is padded a little differently.
    const Statistics s = built_statistics("bunny/bun_zipper.ply", 10);
    EXPECT_NEAR(static_cast<double>(s.voxels), 3592024, 3592);
    EXPECT_NEAR(static_cast<double>(s.svo_nodes), 1.198e6, 1.2e3);
    EXPECT_NEAR(static_cast<double>(s.dag_nodes), 110e3, 0.5e3);
}

TEST(RealScenesSlow, SponzaReproducesTheCrySponzaRowOfTable2) {
    OCTAVO_REQUIRE_SCENE("sponza/Sponza.gltf");
    // [K13] table 2, for a slightly fuller Sponza: 12, 51, 205 M octree nodes and 4, 11, 27 MB.
    const struct {
        int depth;
        double svo_nodes, dag_megabytes;
    } rows[] = {{11, 12e6, 4}, {12, 51e6, 11}, {13, 205e6, 27}};
    for (const auto& row : rows) {
        const Statistics s = built_statistics("sponza/Sponza.gltf", row.depth);
        EXPECT_NEAR(static_cast<double>(s.svo_nodes) / row.svo_nodes, 1.0, 0.07);
        EXPECT_LT(static_cast<double>(s.dag_bytes) / 1e6, row.dag_megabytes);
        EXPECT_GT(static_cast<double>(s.dag_bytes) / 1e6, 0.7 * row.dag_megabytes);
    }
}

}  // namespace
}  // namespace octavo
