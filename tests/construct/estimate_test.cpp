// SPDX-License-Identifier: MIT
#include "octavo/construct/estimate.h"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "octavo/core/error.h"
#include "octavo/mesh/samples.h"
#include "support/random_scene.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

TEST(Estimate, IsWithinAQuarterForTheBuiltInScenes) {
    for (const auto& [name, size, depth] :
         {std::tuple("courtyard", 1.0, 12), std::tuple("hairball", 0.05, 11),
          std::tuple("scan", 0.01, 11)}) {
        const Scene scene = make_sample(name, size);
        BuildOptions options;
        options.depth = depth;
        const Estimate estimate = estimate_build(scene, options);
        const BuildResult built = build(scene, options);
        const auto truth = static_cast<double>(built.dag.size_bytes());
        const double ratio = static_cast<double>(estimate.dag_bytes.likely) / truth;
        EXPECT_GT(ratio, 0.8) << name;
        EXPECT_LT(ratio, 1.25) << name;
        // Tables begin as large as these say: within a factor of two where it matters.
        for (std::size_t l = 0; l < estimate.level_nodes.size(); ++l) {
            const auto nodes = static_cast<double>(built.statistics.levels[l].dag_nodes);
            if (nodes < 10'000) continue;
            EXPECT_GT(static_cast<double>(estimate.level_nodes[l]), 0.5 * nodes) << name << l;
            EXPECT_LT(static_cast<double>(estimate.level_nodes[l]), 2.0 * nodes) << name << l;
        }
    }
}

/// A slightly bent floor of few triangles, and in one corner a ball of many small ones.
Scene detail_in_a_corner() {
    Scene scene = make_sample("hairball", 0.01);
    for (dvec3& position : scene.positions) position = dvec3(0.95) + 0.02 * position;
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(),
                           {{0, 0, 0}, {1, 0.1, 0}, {1, 0.2, 1}, {0, 0, 0.9}});
    scene.triangles.push_back(uvec3(first, first + 1, first + 2));
    scene.triangles.push_back(uvec3(first, first + 2, first + 3));
    return scene;
}

Scene one_triangle() {
    Scene scene;
    scene.positions = {{0, 0, 0}, {1, 0.3, 0.2}, {0.4, 1, 0.7}};
    scene.triangles = {{0, 1, 2}};
    return scene;
}

TEST(Estimate, RangesHoldWhatIsBuilt) {
    const std::pair<const char*, Scene> scenes[] = {
        {"courtyard", make_sample("courtyard", 0.3)},
        {"city", make_sample("city", 0.05)},
        {"scan below its voxels", make_sample("scan", 0.02)},
        {"soup", test::random_scene(5, 300)},
        {"one triangle", one_triangle()},
        {"a corner", detail_in_a_corner()}};
    for (const auto& [name, scene] : scenes)
        for (const int depth : {8, 10, 12}) {
            BuildOptions options;
            options.depth = depth;
            const Estimate estimate = estimate_build(scene, options);
            const BuildResult built = build(scene, options);
            const auto holds = [](const Between& range, std::uint64_t truth) {
                return range.least <= truth && truth <= range.most;
            };
            const auto text = [](const Between& range) {
                return std::to_string(range.least) + ", " + std::to_string(range.likely) + ", " +
                       std::to_string(range.most);
            };
            const Statistics& truth = built.statistics;
            EXPECT_TRUE(holds(estimate.voxels, truth.voxels))
                << name << depth << ": " << text(estimate.voxels) << "; " << truth.voxels;
            EXPECT_TRUE(holds(estimate.dag_nodes, truth.dag_nodes))
                << name << depth << ": " << text(estimate.dag_nodes) << "; " << truth.dag_nodes;
            EXPECT_TRUE(holds(estimate.dag_bytes, truth.dag_bytes))
                << name << depth << ": " << text(estimate.dag_bytes) << "; " << truth.dag_bytes;
            if (truth.dag_bytes < 1'000'000) continue;  // of little use, and from few tiles
            const double ratio = static_cast<double>(estimate.dag_bytes.likely) /
                                 static_cast<double>(truth.dag_bytes);
            EXPECT_GT(ratio, 0.75) << name << depth;
            EXPECT_LT(ratio, 1.33) << name << depth;
        }
}

TEST(Estimate, GrowsWithTheResolution) {
    const Scene scene = make_sample("courtyard", 0.1);
    BuildOptions options;
    options.depth = 6;
    Estimate coarser = estimate_build(scene, options);
    for (options.depth = 7; options.depth <= 14; ++options.depth) {
        const Estimate estimate = estimate_build(scene, options);
        EXPECT_GT(estimate.voxels.likely, coarser.voxels.likely) << options.depth;
        EXPECT_GT(estimate.dag_nodes.likely, coarser.dag_nodes.likely) << options.depth;
        EXPECT_GT(estimate.dag_bytes.likely, coarser.dag_bytes.likely) << options.depth;
        EXPECT_GT(estimate.scratch_bytes, coarser.scratch_bytes) << options.depth;
        EXPECT_GE(estimate.peak_bytes, coarser.peak_bytes) << options.depth;
        coarser = estimate;
    }
}

TEST(Estimate, OfNoTrianglesIsNothing) {
    BuildOptions options;
    options.grid = Grid{dvec3(0.0), 0.1, 12};
    const Estimate estimate = estimate_build(Scene{}, options);
    EXPECT_EQ(estimate.voxels.most, 0u);
    EXPECT_EQ(estimate.dag_bytes.most, 0u);
}

TEST(Estimate, LeavesNoFileBehind) {
    const test::TemporaryFolder folder;
    BuildOptions options;
    options.depth = 11;
    options.scratch = folder / "s";
    for (const std::uint64_t cap : {0, 1'000'000, 400'000'000}) {
        options.max_memory_bytes = cap;
        EXPECT_GT(estimate_build(make_sample("city", 0.02), options).voxels.likely, 0u);
        EXPECT_EQ(folder.entries(), 0u) << cap;
    }
}

TEST(RequireWords, RefusesADagThatNoPointersReachAndNamesAResolution) {
    Estimate estimate;
    estimate.depth = 16;
    estimate.growth = 4.0;
    constexpr std::uint64_t kGiB = 1 << 30;
    estimate.dag_bytes = {15 * kGiB, 20 * kGiB, 30 * kGiB};
    EXPECT_NO_THROW(require_words(estimate));  // it may still do
    estimate.dag_bytes = {17 * kGiB, 20 * kGiB, 30 * kGiB};
    try {
        require_words(estimate);
        FAIL() << "it was let through";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Errc::limit);
        EXPECT_NE(std::string(e.what()).find("resolution of 32768"), std::string::npos) << e.what();
    }
}

TEST(Estimate, OfASmallGridIsTheBuildItself) {
    const Scene scene = test::random_scene(3, 50);
    BuildOptions options;
    options.depth = 5;
    const Estimate estimate = estimate_build(scene, options);
    const BuildResult built = build(scene, options);
    EXPECT_EQ(estimate.dag_bytes.likely, built.dag.size_bytes());
    EXPECT_EQ(estimate.level_nodes.back(), built.statistics.levels[3].dag_nodes);
}

TEST(Estimate, AnEmptyGridTakesNothingMuch) {
    BuildOptions options;
    options.grid = Grid{dvec3(100.0), 0.1, 9};
    EXPECT_LT(estimate_build(test::random_scene(3, 50), options).dag_bytes.most, 1000u);
}

TEST(RequireMemory, RefusalNamesTheCapAndTheResolutionThatWouldDo) {
    Estimate estimate;
    estimate.depth = 16;
    estimate.dag_bytes.most = std::uint64_t{8000} << 20;
    estimate.peak_bytes = std::uint64_t{13000} << 20;
    estimate.least_bytes = std::uint64_t{900} << 20;
    estimate.growth = 4.0;
    EXPECT_NO_THROW(require_memory(estimate, 0));
    EXPECT_NO_THROW(require_memory(estimate, std::uint64_t{900} << 20));
    try {
        require_memory(estimate, std::uint64_t{400} << 20);
        FAIL() << "it was let through";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Errc::limit);
        // A sixteenth more than the least, which is another by a little under another cap.
        EXPECT_NE(std::string(e.what()).find("--max-memory 957M"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("resolution of 32768"), std::string::npos) << e.what();
    }
}

TEST(EstimateDeathTest, WhatAKilledForecastLeavesGoesWithTheNextBuildWithoutACapToo) {
    const test::TemporaryFolder folder;
    const Scene scene = test::random_scene(3, 50);
    BuildOptions options;
    options.depth = 11;
    options.threads = 1;
    options.scratch = folder / "s";
    options.max_memory_bytes = 400'000;  // the forecast spills
    options.progress = [&](const Progress&) {
        if (std::filesystem::exists(folder / "s" / "estimate-triangles")) (void)raise(SIGKILL);
        return true;
    };
    EXPECT_EXIT((void)estimate_build(scene, options), testing::KilledBySignal(SIGKILL), "");
    ASSERT_TRUE(std::filesystem::exists(folder / "s" / "estimate-triangles"));

    options.progress = {};
    options.max_memory_bytes = 0;
    (void)build(scene, options);
    EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace
}  // namespace octavo
