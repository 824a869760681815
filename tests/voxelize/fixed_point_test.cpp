// SPDX-License-Identifier: MIT
#include "octavo/voxelize/fixed_point.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_scene.h"

namespace octavo {
namespace {

TEST(FixedMesh, HasAtLeast24BitsAcrossTheSceneAnd6BelowAVoxel) {
    const Scene scene = test::random_scene(1, 20);
    for (int depth = kMinDepth; depth <= kMaxDepth; ++depth) {
        for (const double zoom : {1.0, 0.3, 7.0, 1000.0, 1e-3}) {
            Grid grid = smallest_cube(scene.bounds(), depth);
            grid.voxel_size *= zoom;
            const FixedMesh mesh(scene, grid);
            const double voxels_across = std::min(1.0 / grid.voxel_size, 3.0 * grid.resolution());
            EXPECT_GE(mesh.fraction_bits(), 6);
            if (voxels_across < 1) continue;  // a scene inside one voxel
            EXPECT_GE(voxels_across * std::ldexp(1.0, mesh.fraction_bits()) * (1 + 1e-5), 0x1p24)
                << "depth " << depth << ", zoom " << zoom;
        }
    }
}

TEST(FixedMesh, KeepsTheDetailOfASceneFarFromTheOrigin) {
    Scene scene = test::random_scene(2, 50);
    const FixedMesh here(scene, smallest_cube(scene.bounds(), 12));
    for (dvec3& p : scene.positions) p += dvec3(5.7e6, -5.7e6, 4.1e6);
    const FixedMesh there(scene, smallest_cube(scene.bounds(), 12));
    std::array<FixedPoint, 3> a, b;
    for (std::size_t i = 0; i < here.size(); ++i) {
        ASSERT_TRUE(here.corners(i, a) && there.corners(i, b));
        for (int k = 0; k < 3; ++k) {  // 5.7e6 in double resolves 1e-9; a unit is 6e-8
            EXPECT_NEAR(a[k].x, b[k].x, 1);
            EXPECT_NEAR(a[k].y, b[k].y, 1);
            EXPECT_NEAR(a[k].z, b[k].z, 1);
        }
    }
}

TEST(FixedMesh, CountsTrianglesWithoutAreaAsDegenerate) {
    Scene scene;
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {1, 1, 1}};
    scene.triangles = {{0, 1, 2}, {0, 1, 3}, {4, 4, 4}, {1, 1, 4}};
    EXPECT_EQ(FixedMesh(scene, smallest_cube(scene.bounds(), 10)).degenerate_triangles(), 3u);
}

}  // namespace
}  // namespace octavo
