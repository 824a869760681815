// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "light/voxel_rooms.h"
#include "octavo/core/error.h"
#include "octavo/io/octv.h"
#include "octavo/light/light_cells.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

Model lit_model() {
    LitScene scene;
    const Dag dag = test::sealed_box(4, 5.3, 0.0, 1.0);
    scene.objects.push_back(
        {.dag = dag, .grid = test::unit_grid(4), .attributes = test::grey(dag, 4, 200)});
    scene.lights.push_back(sun_at(0.3, 0.8));
    light_cells(scene, {.bounces = 1, .around_rays = 4});
    BuildResult built;
    built.dag = dag;
    built.grid = test::unit_grid(4);
    Model model = make_model("room", {}, VoxelRule::conservative, std::move(built));
    model.attributes = scene.objects[0].attributes;
    model.light = scene.objects[0].light;
    model.metadata.light = LightSummary{1, scene.lights, "none"};
    return model;
}

TEST(LightInAFile, ComesBackAsItWas) {
    const test::TemporaryFolder folder;
    const Model model = lit_model();
    for (const bool compress : {false, true}) {
        write_octv(folder / "lit.octv", model, {.compress = compress});
        const Model read = read_octv(folder / "lit.octv");
        EXPECT_TRUE(std::ranges::equal(read.light.words(), model.light.words()));
        EXPECT_EQ(read.light.level(), 4);
        EXPECT_EQ(read.light.bounces(), 1);
        ASSERT_TRUE(read.metadata.light);
        EXPECT_EQ(read.metadata.light->sky, "none");
        ASSERT_EQ(read.metadata.light->lights.size(), 1u);
        EXPECT_EQ(read.metadata.light->lights[0].direction,
                  model.metadata.light->lights[0].direction);
        EXPECT_EQ(read_octv_summary(folder / "lit.octv").light_bytes,
                  model.light.words().size_bytes());
    }
}

TEST(LightInAFile, OfOtherCellsIsRefused) {
    const test::TemporaryFolder folder;
    Model model = lit_model();
    model.light = CellLight(4, 1, std::vector<std::uint32_t>(6));
    EXPECT_THROW(write_octv(folder / "lit.octv", model), Error);
}

TEST(LightInAFile, DamageAnywhereIsSeen) {
    const test::TemporaryFolder folder;
    const Model model = lit_model();
    write_octv(folder / "lit.octv", model);
    std::ifstream in(folder / "lit.octv", std::ios::binary);
    const std::string good((std::istreambuf_iterator<char>(in)), {});
    // Of the light, which comes last: every 97th byte.
    for (std::size_t at = good.size() - model.light.words().size_bytes(); at < good.size();
         at += 97) {
        std::string bad = good;
        bad[at] = static_cast<char>(bad[at] ^ 1);
        std::ofstream(folder / "bad.octv", std::ios::binary) << bad;
        EXPECT_THROW((void)read_octv(folder / "bad.octv"), Error) << at;
    }
}

}  // namespace
}  // namespace octavo
