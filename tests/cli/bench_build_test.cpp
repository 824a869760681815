// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_command.h"
#include "octavo/mesh/save.h"
#include "support/holed_square.h"

namespace octavo::test {
namespace {

using Json = nlohmann::json;

TEST(BenchBuild, CountsWhatInfoCountsAndGivesEveryRun) {
    const TemporaryFolder folder;
    write_file(folder / "t.obj", "v 1 1 1\nv 5 1 1\nv 1 5 1\nf 1 2 3\n");
    const Outcome bench =
        run_shell(folder.path(), "octavo bench build t.obj --resolutions 16,64 --repeat 4 --json");
    ASSERT_EQ(bench.code, 0) << bench.err;
    const Json figures = Json::parse(bench.out);
    for (const char* key : {"commit", "processor", "threads", "time"})
        EXPECT_TRUE(figures.contains(key)) << key;
    const Json& scene = figures.at("scenes").at(0);
    EXPECT_EQ(scene.at("name"), "t.obj");
    EXPECT_EQ(scene.at("triangles"), 1);
    ASSERT_EQ(scene.at("rows").size(), 2u);

    const Outcome built = run_shell(
        folder.path(), "octavo build t.obj -o t.octv -r 64 -q && octavo info t.octv --json");
    ASSERT_EQ(built.code, 0) << built.err;
    const Json info = Json::parse(built.out);
    const Json& row = scene.at("rows").at(1);
    for (const char* key : {"resolution", "voxels", "svo_nodes", "dag_nodes", "dag_bytes",
                            "bits_per_voxel", "levels"})
        EXPECT_EQ(row.at(key), info.at(key)) << key;

    const Json& seconds = row.at("construct_seconds");
    const auto runs = seconds.at("runs").get<std::vector<double>>();
    ASSERT_EQ(runs.size(), 4u);
    EXPECT_EQ(seconds.at("least"), runs.front());
    EXPECT_EQ(seconds.at("most"), runs.back());
    EXPECT_DOUBLE_EQ(seconds.at("median").get<double>(), (runs[1] + runs[2]) / 2);
}

TEST(BenchBuild, MeasuresTheVoxelsThatABuildMakesOfHoles) {
    const TemporaryFolder folder;
    save_scene(holed_square(), folder / "a.glb");
    const Outcome bench =
        run_shell(folder.path(), "octavo bench build a.glb --resolutions 128 --repeat 1 --json");
    ASSERT_EQ(bench.code, 0) << bench.err;
    const Outcome built = run_shell(
        folder.path(), "octavo build a.glb -o a.octv -r 128 -q && octavo info a.octv --json");
    ASSERT_EQ(built.code, 0) << built.err;
    EXPECT_EQ(Json::parse(bench.out).at("scenes").at(0).at("rows").at(0).at("voxels"),
              Json::parse(built.out).at("voxels"));
}

TEST(BenchBuild, NamesASceneByItsGeometry) {
    const TemporaryFolder folder;
    write_file(folder / "a.obj", "v 1 1 1\nv 5 1 1\nv 1 5 1\nf 1 2 3\n");
    write_file(folder / "b.obj", "# the same\nv 1 1 1\nv 5 1 1\nv 1 5 1\nf 1 2 3\n");
    write_file(folder / "c.obj", "v 1 1 1\nv 5 1 1\nv 1 6 1\nf 1 2 3\n");
    const Outcome bench = run_shell(
        folder.path(), "octavo bench build a.obj b.obj c.obj --resolutions 8 --repeat 1 --json");
    ASSERT_EQ(bench.code, 0) << bench.err;
    const Json scenes = Json::parse(bench.out).at("scenes");
    EXPECT_EQ(scenes.at(0).at("hash"), scenes.at(1).at("hash"));
    EXPECT_NE(scenes.at(0).at("hash"), scenes.at(2).at("hash"));
}

TEST(BenchBuild, RefusesAResolutionBeforeItBuilds) {
    const TemporaryFolder folder;
    const Outcome bench =
        run_shell(folder.path(), "octavo bench build sample:courtyard --resolutions 16,17 --json");
    EXPECT_EQ(bench.code, 2);
    EXPECT_EQ(bench.out, "");
}

}  // namespace
}  // namespace octavo::test
