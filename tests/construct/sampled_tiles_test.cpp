// SPDX-License-Identifier: MIT
#include "octavo/construct/sampled_tiles.h"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "octavo/core/morton.h"
#include "octavo/voxelize/triangle_source.h"
#include "support/random_scene.h"

namespace octavo {
namespace {

TEST(TileSample, HasItsShareAndItsPiecesAreRarerSamples) {
    const TileSample sample{2, 5};
    std::size_t count = 0;
    std::array<std::size_t, 16> of_piece{};
    for (std::uint32_t code = 0; code < 32 * 32 * 32; ++code) {
        const uvec3 tile = morton_decode(code);
        ASSERT_TRUE(TileSample{}.has(tile));
        for (unsigned i = 0; i < 16; ++i) {
            const bool has = TileSample{4, 16 * sample.part + i}.has(tile);
            ASSERT_EQ(has, sample.has(tile) && sample.piece_of(tile) == i) << code;
            count += has;
            of_piece[i] += has;
        }
    }
    EXPECT_NEAR(static_cast<double>(count), 2048, 200);
    for (const std::size_t piece : of_piece) EXPECT_NEAR(static_cast<double>(piece), 128, 50);
}

TEST(TileSample, TrianglesThatMeetItsTilesAreAmongItsOwn) {
    const Scene scene = test::random_scene(8, 300);
    const Grid grid = smallest_cube(scene.bounds(), 8);
    constexpr int kTileDepth = 4;
    const TileSample sample{1, 2};

    using Corners = std::array<double, 9>;
    const auto corners_of = [](const Scene& of, std::size_t i) {
        const auto [a, b, c] = of.corners(i);
        return Corners{a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z};
    };
    const Scene found = bare_scene(scene, triangles_in_sample(scene, grid, kTileDepth, sample));
    std::set<Corners> own;
    for (std::size_t i = 0; i < found.triangles.size(); ++i) own.insert(corners_of(found, i));
    EXPECT_LE(own.size(), scene.triangles.size());

    const TriangleSource whole(scene, grid, VoxelRule::conservative, kTileDepth);
    const SampledTiles tiles(whole, sample);
    ASSERT_GT(tiles.tiles().size(), 50u);
    for (std::size_t i = 0; i < whole.tiles().size(); ++i) {
        if (!sample.has(morton_decode(whole.tiles()[i]))) continue;
        for (const TileTriangle& t : whole.triangles(i))
            EXPECT_TRUE(own.contains(corners_of(scene, whole.mesh().scene_triangle(t.triangle))))
                << "tile " << whole.tiles()[i];
    }
}

}  // namespace
}  // namespace octavo
