// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "cli/run_command.h"

namespace octavo::test {
namespace {

using Json = nlohmann::json;

void expect_info_keys(const Json& json) {
    for (const char* key :
         {"resolution", "depth", "rule", "voxels", "svo_nodes", "dag_nodes", "dag_bytes",
          "bits_per_voxel", "file_bytes", "world_bounds", "voxel_size", "triangles",
          "degenerate_triangles", "non_finite_triangles", "levels"})
        EXPECT_TRUE(json.contains(key)) << key;
    for (const Json& level : json.at("levels"))
        for (const char* key : {"level", "svo_nodes", "dag_nodes", "bytes"})
            EXPECT_TRUE(level.contains(key)) << key;
}

TEST(Build, JsonIsThatOfInfoAndHowItWent) {
    const TemporaryFolder folder;
    const Outcome built =
        run_shell(folder.path(), "octavo build sample:courtyard -o a.octv -r 128 --json");
    ASSERT_EQ(built.code, 0) << built.err;
    Json build = Json::parse(built.out);
    Json info = Json::parse(run_shell(folder.path(), "octavo info a.octv --json").out);
    expect_info_keys(info);
    for (const char* key : {"import_seconds", "construct_seconds", "write_seconds", "total_seconds",
                            "threads", "peak_rss_bytes"})
        EXPECT_TRUE(build.at("build").contains(key)) << key;
    build.erase("build");
    EXPECT_EQ(build, info);
    EXPECT_EQ(info.at("resolution"), 128);
    EXPECT_EQ(info.at("depth"), 7);
    EXPECT_EQ(info.at("levels").size(), 7u);
    EXPECT_EQ(info.at("file_bytes"), std::filesystem::file_size(folder / "a.octv"));
}

TEST(Build, SameInputGivesTheSameFileHoweverItIsBuilt) {
    const TemporaryFolder folder;
    const std::string build = "octavo build sample:courtyard -r 256 --quiet ";
    ASSERT_EQ(run_shell(folder.path(), build + "-o a.octv --threads 1").code, 0);
    ASSERT_EQ(run_shell(folder.path(), build + "-o b.octv --threads 3 --tile 64").code, 0);
    ASSERT_EQ(run_shell(folder.path(), build + "-o c.octv --max-memory 2G").code, 0);
    // Not EXPECT_EQ: nobody wants to read the files.
    EXPECT_TRUE(file_content(folder / "a.octv") == file_content(folder / "b.octv"));
    EXPECT_TRUE(file_content(folder / "a.octv") == file_content(folder / "c.octv"));
}

TEST(Build, TakesAGridFromTheCommandLine) {
    const TemporaryFolder folder;
    const Outcome built = run_shell(folder.path(),
                                    "octavo build sample:courtyard -o a.octv -r 64 --rule thin "
                                    "--origin -3.5,0,1e3 --voxel-size 0.125 --json");
    ASSERT_EQ(built.code, 0) << built.err;
    const Json json = Json::parse(built.out);
    EXPECT_EQ(json.at("rule"), "thin");
    EXPECT_EQ(json.at("voxel_size"), 0.125);
    EXPECT_EQ(json.at("world_bounds").at("low"), Json({-3.5, 0.0, 1000.0}));
    EXPECT_EQ(json.at("world_bounds").at("high"), Json({4.5, 8.0, 1008.0}));
}

TEST(Build, CompressedFileHoldsTheSame) {
    const TemporaryFolder folder;
    ASSERT_EQ(run_shell(folder.path(),
                        "octavo build sample:courtyard -o a.octv -r 256 -q && "
                        "octavo build sample:courtyard -o b.octv -r 256 -q --compress")
                  .code,
              0);
    EXPECT_LT(std::filesystem::file_size(folder / "b.octv"),
              std::filesystem::file_size(folder / "a.octv"));
    const std::string ray = " --ray 0,100,0,0,-1,0 --json";
    EXPECT_EQ(run_shell(folder.path(), "octavo query a.octv" + ray).out,
              run_shell(folder.path(), "octavo query b.octv" + ray).out);
}

TEST(Build, RemembersTheNameOfTheSceneAndNotItsFolder) {
    const TemporaryFolder folder;
    ASSERT_EQ(
        run_shell(folder.path(),
                  "mkdir -p deep/er && octavo sample courtyard --size 0.01 -o deep/er/yard.ply && "
                  "octavo build deep/er/yard.ply -o a.octv -r 64 -q")
            .code,
        0);
    const std::string content = file_content(folder / "a.octv");
    EXPECT_NE(content.find("yard.ply"), std::string::npos);
    EXPECT_EQ(content.find("deep"), std::string::npos);
}

/// Peak resident memory of a command that ends well, in bytes.
std::uint64_t peak_of(const std::filesystem::path& folder, const std::string& line) {
    const Outcome outcome = run_shell(folder, line);
    EXPECT_EQ(outcome.code, 0) << line << ": " << outcome.err;
    return outcome.peak_bytes;
}

TEST(BuildSlow, KeepsAMemoryCapThatItWouldPassAndGivesTheSameFile) {
    const TemporaryFolder folder;
    const std::string build = "octavo build sample:hairball -r 2K --threads 2 -q ";
    for (const char* cap : {"160", "256"}) {
        const std::uint64_t peak =
            peak_of(folder.path(), build + "-o " + cap + ".octv --max-memory " + cap + "M");
        EXPECT_LE(peak, std::stoull(cap) << 20) << cap;
    }
    EXPECT_EQ(folder.entries(), 2u) << "the scratch is still there";
    EXPECT_GT(peak_of(folder.path(), build + "-o free.octv"), std::uint64_t{288} << 20);
    EXPECT_EQ(run_shell(folder.path(), "cmp free.octv 160.octv && cmp free.octv 256.octv").code, 0);
}

TEST(BuildSlow, KeepsAMemoryCapThatAttributesWouldPassAndGivesTheSameFile) {
    const TemporaryFolder folder;
    const std::string build =
        "octavo build sample:courtyard -r 2K --attributes color,emission,normal "
        "--attribute-resolution 2K --threads 2 -q ";
    const std::uint64_t peak = peak_of(folder.path(), build + "-o capped.octv --max-memory 70M");
    EXPECT_LE(peak, std::uint64_t{70} << 20);
    EXPECT_EQ(folder.entries(), 1u) << "the scratch is still there";
    EXPECT_GT(peak_of(folder.path(), build + "-o free.octv"), std::uint64_t{85} << 20);
    EXPECT_EQ(run_shell(folder.path(), "cmp free.octv capped.octv").code, 0);
}

/// What is known of each triangle is mapped from disk: a million of them in a few tiles may not all
/// be in memory until the next tile begins.
TEST(BuildSlow, KeepsAMemoryCapWhereOneTileLooksAtNearlyAllTriangles) {
    const TemporaryFolder folder;
    ASSERT_EQ(run_shell(folder.path(), "octavo sample hairball --size 0.6 -o threads.ply").code, 0);
    const std::string build =
        "octavo build threads.ply -r 256 --attributes color,emission,normal --threads 2 -q ";
    const std::uint64_t peak = peak_of(folder.path(), build + "-o capped.octv --max-memory 104M");
    EXPECT_LE(peak, std::uint64_t{104} << 20);
    (void)peak_of(folder.path(), build + "-o free.octv");
    EXPECT_EQ(run_shell(folder.path(), "cmp free.octv capped.octv").code, 0);
}

TEST(BuildSlow, TheCapThatARefusalAdvisesIsEnough) {
    const TemporaryFolder folder;
    const std::string build =
        "octavo build sample:courtyard -o a.octv -r 1K -q --attributes "
        "color,emission,normal --max-memory ";
    const Outcome refused = run_shell(folder.path(), build + "20M");
    ASSERT_EQ(refused.code, 4);
    const std::string words = "--max-memory ";
    const std::size_t at = refused.err.find(words);
    ASSERT_NE(at, std::string::npos) << refused.err;
    const std::size_t end = refused.err.find('M', at + words.size());
    const std::string cap = refused.err.substr(at + words.size(), end + 1 - at - words.size());
    const Outcome built = run_shell(folder.path(), build + cap);
    EXPECT_EQ(built.code, 0) << cap << " " << built.err;
}

TEST(Build, ACapThatCannotBeKeptIsRefusedBeforehandWithWhatWouldDo) {
    const TemporaryFolder folder;
    const Outcome outcome =
        run_shell(folder.path(), "octavo build sample:courtyard -o a.octv -r 1K --max-memory 10M");
    EXPECT_EQ(outcome.code, 4);
    EXPECT_NE(outcome.err.find("--max-memory "), std::string::npos) << outcome.err;
    EXPECT_EQ(run_shell(folder.path(),
                        "octavo build sample:courtyard -o a.octv -r 1K "
                        "--attributes color --max-memory 10M")
                  .code,
              4);
    // Where reading the scene has passed it already, nothing is tried out.
    const Outcome at_once =
        run_shell(folder.path(), "octavo build sample:courtyard -o a.octv -r 128K --max-memory 1M");
    EXPECT_EQ(at_once.code, 4);
    EXPECT_NE(at_once.err.find("--max-memory "), std::string::npos) << at_once.err;
    EXPECT_EQ(at_once.err.find("estimate"), std::string::npos) << at_once.err;
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(Build, ADiskThatIsFullIsAnErrorThatSaysWhatIsNeededAndLeavesTheOldFile) {
    const TemporaryFolder folder;
    const std::string build = "octavo build sample:courtyard -f -q -o a.octv ";
    ASSERT_EQ(run_shell(folder.path(), build + "-r 64").code, 0);
    const std::string old = file_content(folder / "a.octv");
    // A limit on file sizes, in kB, fails a write half-way as a full disk does.
    for (const std::string options :
         {"-r 512", "-r 512 --compress", "-r 512 --journal-seconds 0"}) {
        const Outcome outcome = run_shell(folder.path(), "ulimit -f 60; " + build + options);
        EXPECT_EQ(outcome.code, 1) << options;
        EXPECT_NE(outcome.err.find("a.octv"), std::string::npos) << outcome.err;
        EXPECT_NE(outcome.err.find(" bytes"), std::string::npos) << outcome.err;
        EXPECT_TRUE(file_content(folder / "a.octv") == old) << options;
        (void)run_shell(folder.path(), "rm -rf a.octv.scratch");
        EXPECT_EQ(folder.entries(), 1u) << options;
    }
}

TEST(Build, ProgressForProgramsIsAnObjectOfJsonInEachLine) {
    const TemporaryFolder folder;
    const Outcome built = run_shell(
        folder.path(), "octavo build sample:courtyard -o a.octv -r 512 --json --max-memory 1G");
    ASSERT_EQ(built.code, 0) << built.err;
    std::istringstream lines(built.err);
    std::vector<std::string> phases;
    for (std::string line; std::getline(lines, line);) {
        const Json json = Json::parse(line);
        phases.push_back(json.at("phase"));
        if (phases.back() == "voxelize" && json.at("done") == json.at("total")) {
            EXPECT_GT(json.at("voxels"), 100'000);
        }
    }
    for (const char* phase : {"import", "estimate", "estimated", "voxelize", "write"})
        EXPECT_NE(std::ranges::find(phases, phase), phases.end()) << phase;
    EXPECT_EQ(
        run_shell(folder.path(), "octavo build sample:courtyard -f -o a.octv -r 64 --json -q").err,
        "");
}

TEST(Build, EstimateHasARowForEachResolutionAndLeavesNoFile) {
    const TemporaryFolder folder;
    const Outcome table =
        run_shell(folder.path(), "octavo build sample:courtyard -r 4K --estimate");
    EXPECT_EQ(table.code, 0) << table.err;
    for (const char* row : {"\n    4096 ", "\n    2048 ", "\n    1024 "})
        EXPECT_NE(table.out.find(row), std::string::npos) << table.out;

    const Outcome json =
        run_shell(folder.path(),
                  "octavo build sample:courtyard -r 2K --estimate --json --attributes color "
                  "--max-memory 1G -o unused.octv");
    ASSERT_EQ(json.code, 0) << json.err;
    const auto estimates = nlohmann::json::parse(json.out).at("estimates");
    ASSERT_EQ(estimates.size(), 2u);
    EXPECT_EQ(estimates[0].at("resolution"), 2048);
    EXPECT_GT(estimates[0].at("attribute_bytes"), 0);
    EXPECT_GT(estimates[0].at("dag_bytes"), estimates[1].at("dag_bytes"));
    EXPECT_EQ(folder.entries(), 0u);

    EXPECT_EQ(run_shell(folder.path(), "octavo build sample:courtyard -r 64").code, 2);
}

TEST(Build, TheEstimatedPeakIsNotPassedAndIsEnoughAsACap) {
    const TemporaryFolder folder;
    for (const std::string scene : {"sample:courtyard -r 2K ", "sample:city -r 1K "}) {
        const std::string build = "octavo build --json --threads 2 " + scene;
        const Outcome estimated = run_shell(folder.path(), build + "--estimate");
        ASSERT_EQ(estimated.code, 0) << estimated.err;
        const auto estimate = nlohmann::json::parse(estimated.out).at("estimates").at(0);
        const auto peak = estimate.at("peak_bytes").get<std::uint64_t>();
        for (const std::string& cap : {std::string(), " --max-memory " + std::to_string(peak)}) {
            const Outcome built = run_shell(folder.path(), build + "-f -o a.octv" + cap);
            ASSERT_EQ(built.code, 0) << built.err;
            const auto truth = nlohmann::json::parse(built.out);
            EXPECT_LE(truth.at("build").at("peak_rss_bytes"), peak) << scene << cap;
        }
    }
}

}  // namespace
}  // namespace octavo::test
