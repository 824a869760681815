// SPDX-License-Identifier: MIT
#include "octavo/light/light_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "light/voxel_rooms.h"
#include "octavo/core/error.h"
#include "support/lamps.h"

namespace octavo {
namespace {

using test::grey;
using test::unit_grid;

LitScene floor_scene(int depth, int level) {
    const Dag dag = test::dag_of_voxels(depth, [](const dvec3& p) { return p.y < 4.0; });
    LitScene scene;
    scene.objects.push_back(
        {.dag = dag, .grid = unit_grid(depth), .attributes = grey(dag, level, 200)});
    return scene;
}

TEST(LightCells, AFloorUnderASunHasTheCosineOfItsHeight) {
    for (const int level : {5, 4}) {
        LitScene scene = floor_scene(5, level);
        scene.lights.push_back(sun_at(0.4, 0.8));
        scene.lights[0].intensity = vec3(3.0f);
        scene.lights[0].size = 0.0;
        light_cells(scene, {});
        const CellLight& light = scene.objects[0].light;
        const CellIndex& cells = scene.objects[0].attributes.cells();
        const std::uint32_t middle = 1u << (level - 1);
        const auto top = cells.find({middle, (4u >> (5 - level)) - 1u, middle});
        ASSERT_TRUE(top);
        EXPECT_NEAR(light.get(*top, 3).g, 3.0 * std::sin(0.8) / 3.14159265, 0.01) << level;
    }
}

TEST(LightCells, WhatCannotBeSeenIsHidden) {
    LitScene scene = floor_scene(5, 5);
    light_cells(scene, {});
    const CellLight& light = scene.objects[0].light;
    const CellIndex& cells = scene.objects[0].attributes.cells();
    const auto inside = cells.find({16, 1, 16});
    const auto top = cells.find({16, 3, 16});
    for (int direction = 0; direction < 6; ++direction) {
        EXPECT_TRUE(light.hidden(*inside, direction));
        EXPECT_EQ(light.hidden(*top, direction), direction != 3);
    }
}

// [J]: six values for each cell, and none for empty space.
TEST(LightCells, HasSixWordsForEachOccupiedCell) {
    LitScene scene = floor_scene(5, 4);
    light_cells(scene, {});
    EXPECT_EQ(scene.objects[0].light.words().size(),
              6 * scene.objects[0].attributes.cells().count());
}

class TwoRooms : public testing::Test {
protected:
    TwoRooms() {
        const Dag dag = test::dag_of_voxels(6, [](const dvec3& p) {
            const bool box =
                std::max({std::abs(p.x - 32.0), std::abs(p.z - 32.0), std::abs(p.y - 32.0)}) > 29.5;
            return box || (p.x > 32.0 && p.x < 33.0);
        });
        scene.objects.push_back(
            {.dag = dag, .grid = unit_grid(6), .attributes = grey(dag, 6, 200)});
        scene.lights = {test::lamp_at({15, 40, 30}, 300.0f), test::lamp_at({50, 40, 30}, 300.0f)};
    }
    LitScene scene;
};

TEST_F(TwoRooms, AChangedLightGivesWhatLightingAnewDoes) {
    CellLighter lighter(scene, {.around_rays = 16});
    lighter.light_all();
    const Light moved = test::lamp_at({18, 30, 20}, 200.0f);
    lighter.change_light(0, moved);
    const CellLight changed = scene.objects[0].light;
    LitScene again = scene;
    light_cells(again, {.around_rays = 16});
    const CellLight& expected = again.objects[0].light;
    ASSERT_EQ(changed.words().size(), expected.words().size());
    float worst = 0.0f;
    for (std::uint64_t cell = 0; cell < changed.count(); ++cell)
        for (int d = 0; d < 6; ++d) {
            ASSERT_EQ(changed.hidden(cell, d), expected.hidden(cell, d));
            worst = std::max(worst, std::abs(changed.get(cell, d).g - expected.get(cell, d).g));
        }
    EXPECT_LT(worst, 0.01f);
}

TEST_F(TwoRooms, ALightThatIsAddedIsLitToo) {
    CellLighter lighter(scene, {.around_rays = 16});
    lighter.light_all();
    lighter.change_light(2, test::lamp_at({45, 10, 45}, 50.0f));
    EXPECT_EQ(scene.lights.size(), 3u);
    LitScene again = scene;
    light_cells(again, {.around_rays = 16});
    float worst = 0.0f;
    for (std::uint64_t cell = 0; cell < again.objects[0].light.count(); ++cell)
        for (int d = 0; d < 6; ++d)
            worst = std::max(worst, std::abs(scene.objects[0].light.get(cell, d).g -
                                             again.objects[0].light.get(cell, d).g));
    EXPECT_LT(worst, 0.01f);
    EXPECT_THROW(lighter.change_light(9, test::lamp_at({45, 10, 45}, 50.0f)), Error);
}

// docs/adr/0024: what rays met is kept, or found again for each bounce and each change.
TEST_F(TwoRooms, LightIsTheSameWhereNothingOfWhatRaysMetIsKept) {
    scene.sky = Sky::clear(dvec3(0, 1, 0));
    LitScene other = scene;
    const LightOptions kept{.bounces = 3, .around_rays = 16};
    LightOptions traced = kept;
    traced.kept_bytes = 0;
    CellLighter with(scene, kept), without(other, traced);
    const auto expect_same = [&] {
        EXPECT_TRUE(
            std::ranges::equal(scene.objects[0].light.words(), other.objects[0].light.words()));
    };
    const LightReport all = with.light_all(), all_traced = without.light_all();
    expect_same();
    EXPECT_GT(all_traced.rays, 2 * all.rays) << "the bounces sent rays of their own";
    EXPECT_GT(with.size_bytes(), without.size_bytes());
    const Light moved = test::lamp_at({18, 30, 20}, 200.0f);
    with.change_light(0, moved);
    without.change_light(0, moved);
    expect_same();
}

TEST(ChangeLight, OfAWeakLampLeavesFarCellsAlone) {
    LitScene scene = floor_scene(7, 7);
    scene.lights = {sun_at(0.4, 0.8), test::lamp_at({10, 8, 10}, 0.05f)};
    CellLighter lighter(scene, {.around_rays = 16});
    const LightReport all = lighter.light_all();
    const LightReport some = lighter.change_light(1, test::lamp_at({12, 8, 10}, 0.05f));
    EXPECT_LT(some.sides_done, all.sides_done / 10);
    EXPECT_GT(some.sides_done, 0u);
}

TEST(LightCells, RefusesOptionsOutOfRange) {
    LitScene scene = floor_scene(4, 4);
    EXPECT_THROW(light_cells(scene, {.bounces = 9}), Error);
    EXPECT_THROW(light_cells(scene, {.bounces = -1}), Error);
    EXPECT_THROW(light_cells(scene, {.around_rays = 0}), Error);
    EXPECT_THROW(light_cells(scene, {.tolerance = -1.0}), Error);
    LitScene none;
    EXPECT_THROW(light_cells(none, {}), Error);
}

TEST(LightCells, StopsWhenAskedTo) {
    LitScene scene = floor_scene(6, 6);
    LightOptions options;
    options.progress = [](const Progress& p) { return p.done < p.total / 2; };
    try {
        light_cells(scene, options);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Errc::cancelled);
    }
}

}  // namespace
}  // namespace octavo
