// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_command.h"
#include "octavo/mesh/save.h"
#include "support/holed_square.h"

namespace octavo::test {
namespace {

using Json = nlohmann::json;

constexpr const char* kKinds[] = {"primary", "hard shadow", "soft shadow", "ambient"};
constexpr const char* kPath = R"({"frames": 3, "cameras": [
    {"eye": [-14.1, 1.7, 1.8], "at": [0, 2.4, 0], "fov": 60}, {"eye": [-8, 1.7, 3], "at": [4, 3, -2]}]})";

/// `octavo bench trace` of the small sample with these options, as JSON.
Json bench(const TemporaryFolder& folder, const std::string& options) {
    const Outcome outcome =
        run_shell(folder.path(), "octavo bench trace " + small_octv().string() +
                                     " --size 32 --threads 2 --json " + options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.code == 0 ? Json::parse(outcome.out) : Json();
}

TEST(BenchTrace, GivesEveryFrameOfTheFlightForEveryKindOfRay) {
    const TemporaryFolder folder;
    write_file(folder / "fly.json", kPath);
    const Json figures = bench(folder, "--path fly.json --plot rays.svg");
    for (const char* key : {"commit", "processor", "threads", "simd", "time"})
        EXPECT_TRUE(figures.contains(key)) << key;
    EXPECT_EQ(figures.at("frames"), 3);
    EXPECT_EQ(figures.at("resolution"), 64);
    for (const char* kind : kKinds) {
        const Json& row = figures.at("mrays_per_second").at(kind);
        EXPECT_EQ(row.at("frames").at("voxels").size(), 3u) << kind;
        EXPECT_GT(row.at("median").at("voxels"), 0.0) << kind;
        EXPECT_GT(row.at("hits"), 0) << kind;
        EXPECT_LE(row.at("hits"), row.at("rays")) << kind;
    }
    EXPECT_EQ(figures.at("mrays_per_second").at("primary").at("rays"), 3 * 32 * 32);
    const std::string plot = file_content(folder / "rays.svg");
    EXPECT_TRUE(plot.starts_with("<svg"));
    EXPECT_NE(plot.find("hard shadow"), std::string::npos);
    EXPECT_EQ(bench(folder, "--path fly.json --frames 2").at("frames"), 2);
}

TEST(BenchTrace, HitsTheSameWithoutLanes) {
    const TemporaryFolder folder;
    const Json wide = bench(folder, "--frames 2");
    const Json narrow = bench(folder, "--frames 2 --no-wide");
    EXPECT_EQ(narrow.at("wide"), false);
    for (const char* kind : kKinds)
        EXPECT_EQ(wide.at("mrays_per_second").at(kind).at("hits"),
                  narrow.at("mrays_per_second").at(kind).at("hits"));
}

TEST(BenchTrace, AgreesWithEmbreeAboutMostRays) {
    const TemporaryFolder folder;
    const Outcome asked =
        run_shell(folder.path(), "octavo bench trace " + small_octv().string() +
                                     " --size 8 --frames 1 --mesh sample:courtyard");
    if (asked.err.find("built without Embree") != std::string::npos)
        GTEST_SKIP() << "no Embree (libembree-dev)";
    const Json figures = bench(folder, "--frames 1 --mesh sample:courtyard --differences");
    const Json& why = figures.at("primary_differences");
    EXPECT_EQ(why.at("rays"), 32 * 32);
    EXPECT_EQ(why.at("agree"), figures.at("mrays_per_second").at("primary").at("agreed"));
    EXPECT_EQ(why.at("later"), 0);  // a conservative voxel holds its triangle
    for (const char* kind : kKinds) {
        const Json& row = figures.at("mrays_per_second").at(kind);
        EXPECT_GT(row.at("agreed").get<double>(), 0.5 * row.at("rays").get<double>()) << kind;
        EXPECT_GT(row.at("median").at("embree16"), 0.0);
    }
}

TEST(BenchTrace, EmbreeSeesTheHolesThatTheVoxelsHave) {
    const TemporaryFolder folder;
    save_scene(holed_square(), folder / "holes.glb");
    write_file(folder / "front.json", R"({"frames": 1, "cameras": [
        {"eye": [8, 8, 20], "at": [8.01, 8, 3], "fov": 45}, {"eye": [8, 8, 20], "at": [8, 8, 3]}]})");
    ASSERT_EQ(run_shell(folder.path(), "octavo build holes.glb -o holes.octv -r 512 -q").code, 0);
    const Outcome outcome = run_shell(folder.path(),
                                      "octavo bench trace holes.octv --mesh holes.glb "
                                      "--path front.json --size 64 --threads 2 --json");
    if (outcome.err.find("built without Embree") != std::string::npos)
        GTEST_SKIP() << "no Embree (libembree-dev)";
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Json row = Json::parse(outcome.out).at("mrays_per_second").at("primary");
    const double rays = row.at("rays");
    EXPECT_LT(row.at("hits").get<double>(), 0.75 * rays);
    EXPECT_GT(row.at("hits").get<double>(), 0.4 * rays);
    EXPECT_GT(row.at("agreed").get<double>(), 0.9 * rays);
}

TEST(BenchTrace, AgreesWithNanovdbAboutNearlyAllRays) {
    const TemporaryFolder folder;
    const Outcome asked = run_shell(folder.path(), "octavo bench trace " + small_octv().string() +
                                                       " --size 8 --frames 1 --nanovdb");
    if (asked.err.find("built without NanoVDB") != std::string::npos)
        GTEST_SKIP() << "no NanoVDB (libnanovdb-dev)";
    const Json figures = bench(folder, "--frames 1 --nanovdb");
    EXPECT_GT(figures.at("nanovdb_bytes"), figures.at("dag_bytes"));
    // Its steps go a whole voxel at a time, past some corners.
    const Json& row = figures.at("mrays_per_second").at("primary");
    EXPECT_GT(row.at("nanovdb_agreed").get<double>(), 0.95 * row.at("rays").get<double>());
}

TEST(BenchTrace, TimesTheSameRaysOnADevice) {
    const TemporaryFolder folder;
    const Json figures = bench(folder, "--frames 2 --device cpu");
    EXPECT_TRUE(figures.at("device").get<std::string>().starts_with("cpu, "));
    for (const char* kind : kKinds) {
        const Json& row = figures.at("mrays_per_second").at(kind);
        EXPECT_EQ(row.at("frames").at("device").size(), row.at("frames").at("voxels").size())
            << kind;
        EXPECT_GT(row.at("median").at("device"), 0.0) << kind;
    }
    EXPECT_FALSE(bench(folder, "--frames 1").contains("device"));
}

TEST(BenchTrace, RefusesPathsThatAreNone) {
    const TemporaryFolder folder;
    for (const char* text :
         {"", "{}", "[1]", R"({"cameras": []})", R"({"cameras": [{"eye": [1, 2]}]})",
          R"({"cameras": [{"eye": [1, 2, 3], "at": [1, 2, 3]}]})",
          R"({"frames": 0, "cameras": [{"eye": [1, 2, 3], "at": [1, 2, 4]}]})",
          R"({"cameras": [{"eye": [1, 2, 3], "at": [1, 2, 4], "fov": "x"}]})"}) {
        write_file(folder / "fly.json", text);
        const Outcome outcome = run_shell(
            folder.path(), "octavo bench trace " + small_octv().string() + " --path fly.json");
        EXPECT_EQ(outcome.code, 3) << text << outcome.err;
    }
    EXPECT_EQ(run_shell(folder.path(), "octavo bench trace x.octv --size 12").code, 2);
}

TEST(BenchTrace, FliesEveryPathOfTheProject) {
    const TemporaryFolder folder;
    for (const char* name : {"city", "courtyard", "hairball", "scan", "sponza"})
        EXPECT_EQ(
            bench(folder, "--path " OCTAVO_SOURCE_DIR "/bench/paths/" + std::string(name) + ".json")
                .at("frames"),
            32)
            << name;
}

}  // namespace
}  // namespace octavo::test
