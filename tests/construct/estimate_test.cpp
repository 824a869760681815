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
        const double ratio = static_cast<double>(estimate.dag_bytes) / truth;
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

TEST(Estimate, OfASmallGridIsTheBuildItself) {
    const Scene scene = test::random_scene(3, 50);
    BuildOptions options;
    options.depth = 5;
    const Estimate estimate = estimate_build(scene, options);
    const BuildResult built = build(scene, options);
    EXPECT_EQ(estimate.dag_bytes, built.dag.size_bytes());
    EXPECT_EQ(estimate.level_nodes.back(), built.statistics.levels[3].dag_nodes);
}

TEST(Estimate, AnEmptyGridTakesNothingMuch) {
    BuildOptions options;
    options.grid = Grid{dvec3(100.0), 0.1, 9};
    EXPECT_LT(estimate_build(test::random_scene(3, 50), options).dag_bytes, 1000u);
}

TEST(RequireMemory, RefusalNamesTheCapAndTheResolutionThatWouldDo) {
    const Estimate estimate{.depth = 16,
                            .seconds = 10,
                            .dag_bytes = std::uint64_t{8000} << 20,
                            .level_nodes = {},
                            .peak_bytes = std::uint64_t{13000} << 20,
                            .least_bytes = std::uint64_t{900} << 20,
                            .growth = 4.0};
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
        if (std::filesystem::exists(folder / "s" / "estimate-whole")) (void)raise(SIGKILL);
        return true;
    };
    EXPECT_EXIT((void)estimate_build(scene, options), testing::KilledBySignal(SIGKILL), "");
    ASSERT_TRUE(std::filesystem::exists(folder / "s" / "estimate-whole"));

    options.progress = {};
    options.max_memory_bytes = 0;
    (void)build(scene, options);
    EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace
}  // namespace octavo
